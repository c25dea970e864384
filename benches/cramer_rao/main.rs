//! Estimators against the Cramer-Rao bound, over conditions drawn at random.
//!
//! `cargo bench --bench cramer_rao`: no clock is read. Nothing that was drawn is left out: what an estimator
//! does not answer, and where the bound itself says little, is counted and printed.

mod convergence;
mod draw;
mod efficiency;
mod spoiled;
mod statistics;

fn main() {
    println!(
        "Free decays: f 1 to 60 Hz, xi 0.005 to 0.15, amplitude 0.1 to 2 mm, noise 5 to 50 um, 250 to 4000 Hz,"
    );
    println!("any phase, a belief wrong by up to 25 % in f and by any factor in xi, zero known.");
    efficiency::print();
    convergence::print();
    spoiled::print();
}
