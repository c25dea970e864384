//! Trains and moves, common to all verbs.

use quell_shapers::{
    GridTrain, Setpoint, Shaper, ShaperError, ShapingFilter, UncertainMode, common_train,
};
use quell_trajectories::{Limits, Planner};

use super::CliError;
use crate::closed_loop::ClosedLoopError;
use crate::controller::{SlowedPlan, plan_shaped};
use crate::tolerance::Tolerance;

/// The longest allowed train, ticks: 48 MB of delay line, 17 minutes at 1 kHz.
pub const LONGEST_TRAIN: usize = 1_000_000;

/// Share of a limit by which a command at its limit may seem to exceed it: rounding of velocities and
/// accelerations by the planner, and of differences over one tick.
const ROUNDING: f64 = 1e-9;

/// The shaper's train for all the modes at once, its taps on the controller's grid (period in s).
///
/// [`ShaperError`] where it cannot be designed for one of the modes, or is longer than any filter.
pub fn train(
    shaper: &dyn Shaper,
    modes: impl IntoIterator<Item = UncertainMode>,
    sample_time: f64,
) -> Result<GridTrain, ShaperError> {
    let mut trains = vec![GridTrain::identity(sample_time)?];
    for known in modes {
        trains.push(shaper.on_grid_for(&known, sample_time)?);
    }
    let train = common_train(&trains)?;
    match train.duration_in_ticks() {
        ticks if ticks > LONGEST_TRAIN => Err(ShaperError::TooLong {
            ticks,
            capacity: LONGEST_TRAIN,
        }),
        _ => Ok(train),
    }
}

/// Shaped columns, each from rest at its first value, all lengthened until the last of them has come to its
/// end.
///
/// # Errors
/// [`ShaperError`] where a filter cannot take the train.
pub fn shaped(
    columns: &[impl AsRef<[f64]>],
    train: &GridTrain,
) -> Result<Vec<Vec<f64>>, ShaperError> {
    let step = |filter: &mut ShapingFilter, value| filter.step(Setpoint::at_rest(value)).position;
    let ends = |column: &[f64]| Some((*column.first()?, *column.last()?));
    let (mut filters, mut shaped) = (Vec::new(), Vec::new());
    for column in columns.iter().map(AsRef::as_ref) {
        let (first, last) = ends(column).unwrap_or_default();
        let mut filter = ShapingFilter::new(train.sample_time(), train.duration_in_ticks());
        filter.install(train)?;
        filter.reset(first);
        shaped.push(
            column
                .iter()
                .map(|value| step(&mut filter, *value))
                .collect::<Vec<_>>(),
        );
        filters.push((filter, last));
    }
    while !filters.iter().all(|(filter, _)| filter.is_settled()) {
        for ((filter, last), shaped) in filters.iter_mut().zip(&mut shaped) {
            shaped.push(step(filter, *last));
        }
    }
    Ok(shaped)
}

/// Plans a move from rest to rest (rad) whose shaped command keeps the limits; a train with negative
/// impulses slows it down.
///
/// # Errors
/// [`CliError::Input`] where the move cannot be planned, or exceeds the limits however slow it is.
pub fn plan(ends: [f64; 2], limits: Limits, train: &GridTrain) -> Result<SlowedPlan, CliError> {
    let planner = Planner::new(1).map_err(CliError::input)?;
    let slowed = plan_shaped(&planner, ends, limits, train).map_err(CliError::input)?;
    match slowed.peaks.worst() {
        ratio if ratio > 1.0 + ROUNDING => Err(CliError::input(ClosedLoopError::Limits {
            ratio,
            percent: 100.0 * slowed.speed,
        })),
        _ => Ok(slowed),
    }
}

/// The tolerance of a move: a residual in percent, a deviation in millimetres; `None` without either.
pub fn tolerance(residual: Option<f64>, deviation: Option<f64>) -> Option<Tolerance> {
    (residual.is_some() || deviation.is_some()).then_some(Tolerance {
        residual: residual.map(|percent| 1e-2 * percent),
        deviation: deviation.map(|millimetres| 1e-3 * millimetres),
    })
}

/// The remark on a move that was slowed down to `speed` (1 is full speed).
pub fn slowed(shaper: &str, speed: f64) -> String {
    format!(
        "the negative impulses of {shaper} would exceed the limits; slowed to {:.2} % speed",
        100.0 * speed
    )
}
