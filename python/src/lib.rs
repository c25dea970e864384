//! The compiled half of the Python package `quell`.
//!
//! It takes arrays and gives arrays, and JSON for what has a structure: `python/quell` makes typed objects of these.
//! Nothing is decided here: each function calls the one of the library that the command line calls.

mod course;
mod diagnosis;
mod errors;
mod filter;
mod identification;
mod model;
mod motion;
mod recording;
mod robot;
mod shaper;
mod waiting;

use pyo3::prelude::*;

/// The compiled half of `quell`.
#[pymodule]
mod _quell {
    #[pymodule_export]
    use super::course::course;
    #[pymodule_export]
    use super::diagnosis::{diagnose, predict, score};
    #[pymodule_export]
    use super::filter::AdaptiveFilter;
    #[pymodule_export]
    use super::identification::identify;
    #[pymodule_export]
    use super::main;
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::motion::plan;
    #[pymodule_export]
    use super::recording::{Recording, roles, units};
    #[pymodule_export]
    use super::robot::simulate_robot;
    #[pymodule_export]
    use super::shaper::{Shaper, recommend, shapers_table};

    /// The version of the package.
    #[pymodule_export]
    const VERSION: &str = env!("CARGO_PKG_VERSION");
}

/// Runs the command line, the name of the program first; gives the exit code.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<String>) -> u8 {
    py.detach(|| quell::cli::main_from(arguments.into_iter().map(Into::into)))
}
