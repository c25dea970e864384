//! Shapes a move of 30 degrees for a joint of 8.12 Hz, and prints what the controller would send.

use quell::shapers::{Mode, Setpoint, Shaper, ShapingFilter, Zvd};
use quell::trajectories::{AxisState, Limits, Planner};

const PERIOD: f64 = 0.004;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let limits = [Limits {
        velocity: 2.6,
        acceleration: 10.0,
        jerk: 80.0,
    }];
    let target = [AxisState::at_rest(30f64.to_radians())];
    let plan = Planner::new(1)?
        .plan(&[AxisState::at_rest(0.0)], &target, &limits)?
        .sample(PERIOD)?;
    let train = Zvd.on_grid(Mode::from_hertz(8.12, 0.084)?, PERIOD)?;
    let mut filter = ShapingFilter::new(PERIOD, train.duration_in_ticks());
    filter.install(&train)?;
    for tick in 0..plan.samples() + train.duration_in_ticks() {
        let planned = plan.state(0, tick).ok_or("one axis")?;
        let sent = filter.step(Setpoint {
            position: planned.position,
            velocity: planned.velocity,
            acceleration: planned.acceleration,
        });
        println!("{:.3} s, {:.5} rad", tick as f64 * PERIOD, sent.position);
    }
    Ok(())
}
