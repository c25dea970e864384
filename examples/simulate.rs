//! Simulates a move of the embedded arm whose belief is 25 % off: unshaped, shaped, adaptive.

use quell::closed_loop::Scenario;
use quell::plant::Robot;
use quell::shapers::Mode;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let belief = Mode::from_hertz(10.15, 0.084)?;
    let comparison = Scenario::new(Robot::rx170(), belief).run()?;
    for (kind, _) in comparison.moves() {
        let left = 100.0 * comparison.ratio(kind);
        println!("{} leaves {left:.2} % of the vibration", kind.name());
    }
    Ok(())
}
