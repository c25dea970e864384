//! Jerk-limited joint moves, planned by Ruckig off the tick and sampled at the control period.
//!
//! A [`Planner`] takes the state of 1 to 7 axes, where they shall go and their [`Limits`], and
//! returns the time-optimal [`Trajectory`] on which all axes arrive together. The trajectory is
//! plain data: it can be sent to another thread, evaluated anywhere ([`Trajectory::state_at`]) and
//! sampled at the control period ([`Trajectory::sample`]).
//!
//! Ruckig works in C++ behind a foreign function interface that trusts its caller: a vector of the
//! wrong length makes it read past the end. So everything is checked on this side first, and what
//! is wrong comes back as a [`PlanError`] that names the axis and the value.
//!
//! The binding tells the duration of a move and states at times, but no phases. They follow in closed form from the
//! duration and one state, which Ruckig's own must agree with; where they do not (a start beyond the limits), they
//! are recovered from many states.
//!
//! There are no waypoints. Ruckig's community edition sends intermediate positions to a service on
//! the network; this crate never sets them, and a test proves that it opens no socket.
//!
//! # Example
//! ```
//! use quell_trajectories::{AxisState, Limits, Planner};
//!
//! // 1 rad with v = 1, a = 2, j = 10: all seven phases, so T = d / v + v / a + a / j = 1.7 s.
//! let limits = [Limits { velocity: 1.0, acceleration: 2.0, jerk: 10.0 }];
//! let planner = Planner::new(1)?;
//! let trajectory =
//!     planner.plan(&[AxisState::at_rest(0.0)], &[AxisState::at_rest(1.0)], &limits)?;
//! assert!((trajectory.duration() - 1.7).abs() < 1e-9);
//!
//! let sampled = trajectory.sample(0.004)?;
//! assert_eq!(sampled.positions(0).last(), Some(&1.0));
//! # Ok::<(), quell_trajectories::PlanError>(())
//! ```
//!
//! Source: L. Berscheid, T. Kroeger, "Jerk-limited Real-time Trajectory Generation with Arbitrary
//! Target States", Robotics: Science and Systems, 2021.

mod axis;
mod check;
mod closed_form;
mod cruise;
mod dip;
mod error;
mod path;
mod planner;
mod problem;
mod profile;
mod ramp;
mod read_back;
mod sampled;
mod solver;
mod stop;
mod trajectory;

pub use axis::{AxisState, Limits, MAX_DEGREES_OF_FREEDOM};
pub use error::PlanError;
pub use planner::Planner;
pub use profile::{AxisProfile, Phase};
pub use sampled::{MAX_SAMPLES, SampledTrajectory};
pub use trajectory::Trajectory;
