//! Estimators against the Cramer-Rao bound, over conditions drawn at random.
//!
//! `cargo bench --bench cramer_rao`: no clock is read. Nothing that was drawn is left out: what an estimator
//! does not answer, and where the bound itself says little, is counted and printed. One part alone:
//! `cargo bench --bench cramer_rao -- two_modes`.

mod convergence;
mod draw;
mod efficiency;
mod spoiled;
mod statistics;
mod two_modes;

const PARTS: [(&str, fn()); 4] = [
    ("efficiency", efficiency::print),
    ("convergence", convergence::print),
    ("spoiled", spoiled::print),
    ("two_modes", two_modes::print),
];

fn main() {
    println!(
        "Free decays: f 1 to 60 Hz, xi 0.005 to 0.15, amplitude 0.1 to 2 mm, noise 5 to 50 um, 250 to 4000 Hz,"
    );
    println!("any phase, a belief wrong by up to 25 % in f and by any factor in xi, zero known.");
    // Cargo itself adds arguments that begin with dashes.
    let asked: Vec<String> = std::env::args()
        .skip(1)
        .filter(|word| !word.starts_with('-'))
        .collect();
    for (name, print) in PARTS {
        if asked.is_empty() || asked.iter().any(|word| word == name) {
            print();
        }
    }
}
