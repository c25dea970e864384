//! The fastest move from rest to rest within a tolerance: of what vibrates after it, and of the path.
//!
//! - *Residual*: the largest amplitude of a mode after the command has ended, relative to that of the same move
//!   unshaped, as fast as the limits allow. Both are the largest over the box of two standard deviations around
//!   the mode.
//! - *Deviation*: a distance of the tip, m. It bounds the distance of the command from the planned path, the
//!   straight line between start and target in joint space, and every vibration after the end. A single joint
//!   cannot leave its path before the end.
//!
//! The unshaped move with each [train](trains) of the catalogue is a candidate. For each shorter duration the motion that leaves
//! least is a convex problem ([`program`]). The least duration is found by bisection. What is found is checked on its own: limits, end,
//! residual along the edges of the boxes, path at every tick.

mod check;
mod known;
mod left;
mod program;
mod search;
mod steps;
mod swing;
mod trains;

use quell_shapers::{GridTrain, UncertainMode};
use quell_trajectories::{Limits, PlanError, SampledTrajectory};

use self::left::least;
use self::search::Search;
use self::trains::Trains;

/// A joint that moves.
#[derive(Clone, Debug)]
pub struct Moving {
    /// Start and target, rad; they must differ.
    pub ends: [f64; 2],
    /// Its limits.
    pub limits: Limits,
    /// Its modes with their uncertainty; none of a stiff joint.
    pub modes: Vec<UncertainMode>,
    /// Largest distance of the tip from its axis on the way, m.
    pub lever: f64,
}

impl Moving {
    fn distance(&self) -> f64 {
        self.ends[1] - self.ends[0]
    }
}

/// Allowed residual of a move, and allowed deviation from its path. `None` is no bound.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tolerance {
    /// Share of the unshaped vibration, above 0.
    pub residual: Option<f64>,
    /// Distance of the tip, m, above 0. If it is absent, several joints keep their path.
    pub deviation: Option<f64>,
}

/// The fastest move that was found.
#[derive(Clone, Debug)]
pub struct Fastest {
    /// The motion of each joint at the control period; it is sent as it is, without a train.
    pub plans: Vec<SampledTrajectory>,
    /// Upper bounds of its residuals.
    pub bounds: Bounds,
}

/// Upper bounds of a move's residuals, for modes anywhere in their boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Largest residual of a joint, as a share of its unshaped vibration.
    pub residual: f64,
    /// The largest amplitude of a joint, at the tip, m.
    pub vibration: f64,
    /// Largest distance of the commanded tip from the path, m: the sum over the joints.
    pub departure: f64,
}

impl Fastest {
    /// Time until the command rests, s.
    pub fn duration(&self) -> f64 {
        let period = self.plans.first().map_or(0.0, SampledTrajectory::period);
        self.ticks() as f64 * period
    }

    fn ticks(&self) -> usize {
        self.plans.first().map_or(0, |plan| plan.samples() - 1)
    }
}

/// The reason why there is no such move.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceError {
    /// It cannot be planned.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// A number of the tolerance is not valid.
    #[error("the allowed {what} is {value}; it must be finite and above 0")]
    Value {
        /// Residual or deviation.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A joint has no way to go.
    #[error("joint {index} of the move, counted from 0, starts at its target")]
    NoWay {
        /// The joint among those that move.
        index: usize,
    },
    /// No tried move has a residual this small.
    #[error(
        "no move of up to {longest:.3} s keeps the tolerance within two standard deviations of the modes{}",
        self::needs(needed)
    )]
    Unattainable {
        /// Longest duration that was tried, s.
        longest: f64,
        /// The tolerance that the one that leaves least is within; `None` where none could be made.
        needed: Option<Tolerance>,
    },
}

/// What must be allowed, with three digits, rounded up.
fn needs(needed: &Option<Tolerance>) -> String {
    let up = |value: f64| {
        let decimals = (2.0 - value.log10().floor()).clamp(0.0, 12.0);
        let unit = 10_f64.powf(-decimals);
        format!("{:.*}", decimals as usize, (value / unit).ceil() * unit)
    };
    let needed = needed.unwrap_or_default();
    let residual = needed
        .residual
        .map(|share| format!("a residual of {} %", up(1e2 * share)));
    let deviation = needed
        .deviation
        .map(|metres| format!("a deviation of {} mm", up(1e3 * metres)));
    let both: Vec<String> = residual.into_iter().chain(deviation).collect();
    if both.is_empty() {
        return String::new();
    }
    format!("; the best one needs {}", both.join(" and "))
}

/// The fastest move of one joint or several within a tolerance, at a control period (s).
///
/// Off the tick: a tenth of a second for one joint; up to seconds for several that may leave their path, and on long moves with several modes.
///
/// # Errors
/// [`ToleranceError`].
pub fn fastest(
    joints: &[Moving],
    tolerance: Tolerance,
    period: f64,
) -> Result<Fastest, ToleranceError> {
    let search = Search::new(joints, tolerance, period)?;
    if let Some(unshaped) = search.unshaped()? {
        return Ok(unshaped);
    }
    let [mut low, longest] = search.range();
    // A move by trains first: what is found then is faster still. Without one the longest move: if that fails, all do.
    let first = search.by_trains();
    let first = first.or_else(|left| search.within(longest).map_err(|other| least(left, other)));
    let mut best = first.map_err(|left| ToleranceError::Unattainable {
        longest: longest as f64 * period,
        needed: left.map(|left| left.needed(tolerance)),
    })?;
    let mut high = best.ticks();
    while high - low > 1 {
        let ticks = low + (high - low) / 2;
        match search.within(ticks) {
            Ok(found) => (high, best) = (ticks, found),
            Err(_) => low = ticks,
        }
    }
    Ok(best)
}

/// Largest share of the unshaped vibration that a train leaves of the plan at the limits, for comparison.
///
/// # Errors
/// [`ToleranceError`] as [`fastest`].
pub fn share_left(joint: &Moving, train: &GridTrain) -> Result<f64, ToleranceError> {
    let joints = core::slice::from_ref(joint);
    let search = Search::new(joints, Tolerance::default(), train.sample_time())?;
    Ok(search.share_left(&Trains::from(train.clone())))
}
