//! Moves that may be proposed, within the limits of the recordings; each sort brings out other effects.
//!
//! Fast moves and their settling show modes, damping, stiffness and lags. Half and small moves show
//! nonlinearity. Slow moves show friction, ripple and gravity. Reversals without rest show backlash and lost
//! motion. Long pauses show creep, drift and clocks.

use super::seen::Seen;
use crate::document::ProposedMove;
use quell_trajectories::{AxisState, Limits, PlanError, Planner, Trajectory};

/// Lengths of pauses, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pauses {
    /// Nothing settles in it.
    pub short: f64,
    /// Vibration dies away in it.
    pub settled: f64,
    /// Slow effects show in it.
    pub long: f64,
}

/// Shares of the greatest speed and acceleration.
const PACES: &[(f64, f64)] = &[(1.0, 1.0), (1.0, 0.3), (0.3, 1.0), (0.1, 1.0), (0.03, 1.0)];
/// Shares of the way to the farther end of the range.
const DISTANCES: &[f64] = &[1.0, 0.5, 0.125];
/// Share of the range that must lie on either side for a move from end to end.
const BOTH_SIDES: f64 = 0.1;

/// Parts of a programme, each from the start of the recordings and back to it, for an axis whose moves are in
/// `unit`.
pub fn parts(seen: &Seen, pauses: Pauses, unit: &str) -> Vec<Vec<ProposedMove>> {
    let (down, up) = (seen.range.0 - seen.start, seen.range.1 - seen.start);
    let (far, near) = if up >= -down { (up, down) } else { (down, up) };
    let mut found: Vec<Vec<ProposedMove>> = Vec::new();
    let mut add = |distances: &[f64], pace: (f64, f64), pause: f64| {
        let moves = distances
            .iter()
            .map(|d| proposed(*d, &at(seen, pace), pause, unit));
        // A move that cannot be planned is not proposed.
        if let Ok(moves) = moves.collect::<Result<Vec<_>, _>>()
            && !found.contains(&moves)
        {
            found.push(moves);
        }
    };
    for &pace in PACES {
        for d in DISTANCES.iter().map(|share| share * far) {
            add(&[d, -d], pace, pauses.settled);
        }
    }
    let (fast, slow) = (PACES[0], PACES[3]);
    let small = DISTANCES[2] * far;
    add(&[far, -far], fast, pauses.long);
    add(&[far, -far, far, -far], fast, pauses.short);
    add(&[small, -small, small, -small], fast, pauses.short);
    add(&[small, -small, small, -small], slow, pauses.short);
    let step = far / 2.0;
    add(&[step, step, -step, -step], fast, pauses.settled);
    if near.abs() > BOTH_SIDES * (up - down) {
        for pace in [PACES[0], PACES[2]] {
            add(&[far, -far, near, -near], pace, pauses.short);
        }
    }
    found
}

fn at(seen: &Seen, (speed, acceleration): (f64, f64)) -> Limits {
    Limits {
        velocity: speed * seen.limits.velocity,
        acceleration: acceleration * seen.limits.acceleration,
        jerk: seen.limits.jerk,
    }
}

/// A move with short numbers: its greatest speed, acceleration and jerk, no more than the limits.
fn proposed(d: f64, limits: &Limits, pause: f64, unit: &str) -> Result<ProposedMove, PlanError> {
    let distance = shortened(d);
    let reached = plan(0.0, distance, limits)?;
    // Speed and acceleration are greatest where the jerk changes.
    let phases = reached.axes().iter().flat_map(|axis| axis.phases());
    let (speed, acceleration) = phases.fold((0.0f64, 0.0f64), |(speed, acceleration), phase| {
        let AxisState {
            velocity: v,
            acceleration: a,
            ..
        } = phase.state;
        (speed.max(v.abs()), acceleration.max(a.abs()))
    });
    Ok(ProposedMove {
        distance,
        speed: shortened(speed.min(limits.velocity)),
        acceleration: shortened(acceleration.min(limits.acceleration)),
        jerk: shortened(limits.jerk),
        pause_s: (100.0 * pause).ceil() / 100.0,
        unit: unit.to_string(),
    })
}

fn plan(from: f64, to: f64, limits: &Limits) -> Result<Trajectory, PlanError> {
    let ends = [from, to].map(AxisState::at_rest);
    Planner::new(1)?.plan(&ends[..1], &ends[1..], std::slice::from_ref(limits))
}

/// Towards zero, to three digits.
fn shortened(value: f64) -> f64 {
    if value == 0.0 {
        return 0.0;
    }
    let digits = 2 - value.abs().log10().floor() as i32;
    let (up, down) = (10f64.powi(digits.max(0)), 10f64.powi((-digits).max(0)));
    // A product a hair below a whole number is that number.
    (value * up / down * (1.0 + 1e-12)).trunc() * down / up
}

/// Positions of the motor side at multiples of `period` (s): a rest of `lead` seconds at `start`, and the
/// moves with their pauses.
///
/// # Errors
/// [`PlanError`] where a move cannot be planned or is too long.
pub fn positions(
    moves: &[ProposedMove],
    start: f64,
    lead: f64,
    period: f64,
) -> Result<Vec<f64>, PlanError> {
    let rest = |seconds: f64| (seconds / period).ceil() as usize;
    let mut position = start;
    let mut all = vec![position; rest(lead)];
    for one in moves {
        let target = position + one.distance;
        let limits = Limits {
            velocity: one.speed,
            acceleration: one.acceleration,
            jerk: one.jerk,
        };
        all.extend(
            plan(position, target, &limits)?
                .sample(period)?
                .positions(0),
        );
        all.extend(vec![target; rest(one.pause_s)]);
        position = target;
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(40))]

        /// Every part stays within the range, the speed, the acceleration and the jerk that were seen, and
        /// ends where it starts.
        #[test]
        fn parts_are_inside_what_was_seen(
            low in -3.0..0.0f64, travel in 0.01..3.0f64, share in 0.0..1.0f64,
            velocity in 0.05..3.0f64, rate in 1.0..20.0f64, sharpness in 3.0..60.0f64,
        ) {
            let limits = Limits {
                velocity,
                acceleration: velocity * rate,
                jerk: velocity * rate * sharpness,
            };
            let seen = Seen { start: low + share * travel, range: (low, low + travel), limits };
            let pauses = Pauses { short: 0.1, settled: 0.5, long: 2.0 };
            let parts = parts(&seen, pauses, "rad");
            // Where no move is long enough to reach a limit, all paces are one; these differ in more than pace.
            prop_assert!(parts.len() >= 7);
            for moves in &parts {
                let period = 1e-3;
                let all = positions(moves, seen.start, 0.1, period).unwrap();
                let rounding = 1e-9;
                prop_assert!(all.iter().all(|x| *x >= low - rounding && *x <= low + travel + rounding));
                prop_assert!((all[all.len() - 1] - seen.start).abs() < rounding);
                // The end of a move falls between two samples: a second difference would see a jump there.
                for pair in all.windows(2) {
                    prop_assert!((pair[1] - pair[0]).abs() <= limits.velocity * period + rounding);
                }
                for one in moves {
                    prop_assert!(one.speed <= limits.velocity * (1.0 + rounding));
                    prop_assert!(one.acceleration <= limits.acceleration * (1.0 + rounding));
                    prop_assert!(one.jerk <= limits.jerk * (1.0 + rounding));
                }
            }
        }
    }
}
