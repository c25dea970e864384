//! Move, stop, shaper, payload.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

use axum::Json as Answer;
use axum::extract::State;
use axum::http::StatusCode;
use schemars::JsonSchema;
use serde::Deserialize;

use super::App;
use super::answer::Refused;
use super::body::{Json, Nothing};
use crate::service::contract::{Accepted, JointSnapshot, Request, ShapingChange, Snapshot, Target};
use crate::service::demo;
use crate::tolerance::Tolerance;

/// Time in which the engine answers: a correction takes a second at most.
const PATIENCE: Duration = Duration::from_secs(5);

/// The body of a move.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Travel {
    /// The joint, where one moves.
    joint: Option<String>,
    /// Where it shall end, deg.
    target_deg: Option<f64>,
    /// The same, rad.
    target_rad: Option<f64>,
    /// Joints that begin and end together, instead of one.
    joints: Option<Vec<One>>,
    /// Shaper for this move alone, `none` for unshaped; the joint's own where absent.
    shaper: Option<String>,
    /// Instead of a shaper, from rest: as fast as it may be when each joint leaves so much vibration, percent of the unshaped.
    residual_percent: Option<f64>,
    /// The same when the tip vibrates at its end by so much, and several joints leave their straight path by so much, mm.
    deviation_mm: Option<f64>,
}

/// One joint of several that move together.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct One {
    /// The joint.
    joint: String,
    /// Where it shall end, deg.
    target_deg: Option<f64>,
    /// The same, rad.
    target_rad: Option<f64>,
}

/// The body of a jog.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Jogged {
    /// The joint.
    joint: String,
    /// Velocity, deg/s; 0 ends the hold.
    velocity_deg_s: f64,
    /// Number of the hold, another one for each press of a button.
    hold: u64,
}

/// The body of a feed.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Feed {
    /// Share of full speed, percent: 0, which stops all motion, or 1 to 100.
    percent: f64,
}

/// The body of a payload.
#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    /// Its mass, kg, 0 or more.
    mass_kg: f64,
}

pub type Answered = Result<Answer<Accepted>, Refused>;

/// `POST /api/v1/move`.
pub async fn travel(State(app): State<Arc<App>>, Json(body): Json<Travel>) -> Answered {
    let snapshot = app.handle.snapshot();
    let Travel {
        joint,
        target_deg,
        target_rad,
        joints,
        shaper,
        residual_percent,
        deviation_mm,
    } = body;
    let tolerance = tolerance(residual_percent, deviation_mm)?;
    if tolerance.is_some() && shaper.is_some() {
        let sentence = "residual_percent and deviation_mm are in the place of a shaper";
        return Err(Refused::value(sentence));
    }
    let single = |joint: String| One {
        joint,
        target_deg,
        target_rad,
    };
    let request = match (joint, joints) {
        (Some(joint), None) => {
            let Target { joint, target } = single(joint).target(&snapshot)?;
            match tolerance {
                Some(tolerance) => Request::MoveWithin {
                    joint,
                    target,
                    tolerance,
                },
                None => Request::Move {
                    joint,
                    target,
                    shaper,
                },
            }
        }
        (None, Some(joints)) if (target_deg, target_rad) == (None, None) => {
            let targets = joints.into_iter().map(|one| one.target(&snapshot));
            let targets = targets.collect::<Result<_, _>>()?;
            Request::MoveTogether {
                targets,
                shaper,
                tolerance,
            }
        }
        (None, None) => {
            let sentence =
                "the body is not what it should be: missing field `joint`, or `joints` for several";
            return Err(Refused::new(StatusCode::BAD_REQUEST, sentence));
        }
        _ => {
            let sentence = "give either joint and its target, or joints, each with its own";
            return Err(Refused::value(sentence));
        }
    };
    ask(&app, request).await
}

/// The tolerance of a move; `None` without one.
fn tolerance(residual: Option<f64>, deviation: Option<f64>) -> Result<Option<Tolerance>, Refused> {
    for (name, value) in [("residual_percent", residual), ("deviation_mm", deviation)] {
        if let Some(value) = value.filter(|value| !(value.is_finite() && *value > 0.0)) {
            let sentence = format!("{name} is {value}, it must be above 0");
            return Err(Refused::value(sentence));
        }
    }
    let tolerance = Tolerance {
        residual: residual.map(|percent| 1e-2 * percent),
        deviation: deviation.map(|millimetres| 1e-3 * millimetres),
    };
    Ok((tolerance != Tolerance::default()).then_some(tolerance))
}

/// `POST /api/v1/jog`.
pub async fn jog(State(app): State<Arc<App>>, Json(body): Json<Jogged>) -> Answered {
    let snapshot = app.handle.snapshot();
    let joint = joint(&snapshot, &body.joint)?.name.clone();
    let velocity = body.velocity_deg_s.to_radians();
    let hold = body.hold;
    let request = Request::Jog {
        joint,
        velocity,
        hold,
    };
    ask(&app, request).await
}

/// `POST /api/v1/feed`.
pub async fn feed(State(app): State<Arc<App>>, Json(body): Json<Feed>) -> Answered {
    if body.percent != 0.0 && !(1.0..=100.0).contains(&body.percent) {
        let sentence = format!(
            "percent is {}, it must be 0, or from 1 to 100",
            body.percent
        );
        return Err(Refused::value(sentence));
    }
    let share = body.percent / 100.0;
    ask(&app, Request::Feed { share }).await
}

/// `POST /api/v1/demo`.
pub async fn demonstrate(State(app): State<Arc<App>>, _: Nothing) -> Answered {
    demo::check(&app.handle)?;
    // One at a time; it continues even if the client disconnects.
    let Ok(place) = Arc::clone(&app.demo).try_acquire_owned() else {
        let sentence = "the demonstration is running already";
        return Err(Refused::new(StatusCode::CONFLICT, sentence));
    };
    let handle = app.handle.clone();
    tokio::spawn(async move {
        if let Err(error) = demo::run(&handle).await {
            tracing::warn!("the demonstration ended early: {error}");
        }
        drop(place);
    });
    Ok(Answer(Accepted::Changed))
}

/// `POST /api/v1/stop`.
pub async fn stop(State(app): State<Arc<App>>, _: Nothing) -> Answered {
    ask(&app, Request::Stop).await
}

/// `POST /api/v1/enable`.
pub async fn enable(State(app): State<Arc<App>>, _: Nothing) -> Answered {
    ask(&app, Request::Enable).await
}

/// `POST /api/v1/disable`.
pub async fn disable(State(app): State<Arc<App>>, _: Nothing) -> Answered {
    ask(&app, Request::Disable).await
}

/// `POST /api/v1/reset`.
pub async fn reset(State(app): State<Arc<App>>, _: Nothing) -> Answered {
    ask(&app, Request::Reset).await
}

/// `POST /api/v1/shaper`.
pub async fn shaper(State(app): State<Arc<App>>, Json(change): Json<ShapingChange>) -> Answered {
    if change == ShapingChange::default() {
        let keys = "enabled, adaptation, kind or mode";
        return Err(Refused::value(format!("nothing to change: give {keys}")));
    }
    ask(&app, Request::Shaping(change)).await
}

/// `POST /api/v1/payload`.
pub async fn payload(State(app): State<Arc<App>>, Json(body): Json<Payload>) -> Answered {
    if body.mass_kg.is_nan() || body.mass_kg < 0.0 {
        let sentence = format!("mass_kg is {}, it must be 0 or more", body.mass_kg);
        return Err(Refused::value(sentence));
    }
    ask(&app, Request::Payload { mass: body.mass_kg }).await
}

/// The joint of that name.
///
/// # Errors
/// A sentence that names the known joints.
pub fn joint<'a>(snapshot: &'a Snapshot, name: &str) -> Result<&'a JointSnapshot, Refused> {
    let found = snapshot.joints.iter().find(|joint| joint.name == name);
    found.ok_or_else(|| {
        let names: Vec<_> = snapshot.joints.iter().map(|joint| &*joint.name).collect();
        let names = names.join(", ");
        Refused::value(format!("there is no joint {name:?}; there are: {names}"))
    })
}

impl One {
    /// The target within the range of the joint. A refusal uses the unit that was given.
    fn target(self, snapshot: &Snapshot) -> Result<Target, Refused> {
        let joint = joint(snapshot, &self.joint)?;
        let (name, value, factor) = match (self.target_deg, self.target_rad) {
            (Some(degrees), None) => ("target_deg", degrees, TAU / 360.0),
            (None, Some(radians)) => ("target_rad", radians, 1.0),
            _ => {
                let sentence = "give exactly one of target_deg and target_rad";
                return Err(Refused::value(sentence));
            }
        };
        let [low, high] = joint.range_rad;
        let target = value * factor;
        // A limit that is given in degrees must not fail by rounding.
        let slack = f64::EPSILON * low.abs().max(high.abs());
        if (low - slack..=high + slack).contains(&target) {
            return Ok(Target {
                joint: self.joint,
                target: target.clamp(low, high),
            });
        }
        let (low, high) = (shown(low / factor), shown(high / factor));
        let sentence = format!(
            "{name} is {value}, {} moves from {low} to {high}",
            joint.name
        );
        Err(Refused::value(sentence))
    }
}

/// A limit without digits that are only rounding.
fn shown(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

pub async fn ask(app: &App, request: Request) -> Answered {
    match tokio::time::timeout(PATIENCE, app.handle.ask(request)).await {
        Ok(answer) => Ok(Answer(answer?)),
        Err(_) => {
            let sentence = format!("the engine did not answer within {} s", PATIENCE.as_secs());
            Err(Refused::new(StatusCode::SERVICE_UNAVAILABLE, sentence))
        }
    }
}
