//! Move, stop, shaper, payload.

use std::f64::consts::TAU;
use std::sync::Arc;
use std::time::Duration;

use axum::Json as Answer;
use axum::extract::State;
use axum::http::StatusCode;
use serde::Deserialize;

use super::App;
use super::answer::Refused;
use super::body::{Json, Nothing};
use crate::service::contract::{Accepted, JointSnapshot, Request, ShapingChange, Snapshot};

/// Time in which the engine answers: a correction takes a second at most.
const PATIENCE: Duration = Duration::from_secs(5);

/// The body of a move.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Travel {
    joint: String,
    target_deg: Option<f64>,
    target_rad: Option<f64>,
    shaper: Option<String>,
}

/// The body of a payload.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Payload {
    mass_kg: f64,
}

type Answered = Result<Answer<Accepted>, Refused>;

/// `POST /api/move`.
pub async fn travel(State(app): State<Arc<App>>, Json(body): Json<Travel>) -> Answered {
    let snapshot = app.handle.snapshot();
    let target = body.target(joint(&snapshot, &body.joint)?)?;
    let Travel { joint, shaper, .. } = body;
    let request = Request::Move {
        joint,
        target,
        shaper,
    };
    ask(&app, request).await
}

/// `POST /api/stop`.
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

/// `POST /api/shaper`.
pub async fn shaper(State(app): State<Arc<App>>, Json(change): Json<ShapingChange>) -> Answered {
    if change == ShapingChange::default() {
        let keys = "enabled, adaptation, kind or mode";
        return Err(Refused::value(format!("nothing to change: give {keys}")));
    }
    ask(&app, Request::Shaping(change)).await
}

/// `POST /api/payload`.
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
/// A sentence that names those that there are.
pub fn joint<'a>(snapshot: &'a Snapshot, name: &str) -> Result<&'a JointSnapshot, Refused> {
    let found = snapshot.joints.iter().find(|joint| joint.name == name);
    found.ok_or_else(|| {
        let names: Vec<_> = snapshot.joints.iter().map(|joint| &*joint.name).collect();
        let names = names.join(", ");
        Refused::value(format!("there is no joint {name:?}; there are: {names}"))
    })
}

impl Travel {
    /// The target, rad, within the range of the joint. What is refused is told in the unit that was given.
    fn target(&self, joint: &JointSnapshot) -> Result<f64, Refused> {
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
            return Ok(target.clamp(low, high));
        }
        let (low, high) = (shown(low / factor), shown(high / factor));
        let sentence = format!(
            "{name} is {value}, {} moves from {low} to {high}",
            joint.name
        );
        Err(Refused::value(sentence))
    }
}

/// A limit without the digits that only rounding made.
fn shown(value: f64) -> f64 {
    (value * 1e9).round() / 1e9
}

async fn ask(app: &App, request: Request) -> Answered {
    match tokio::time::timeout(PATIENCE, app.handle.ask(request)).await {
        Ok(answer) => Ok(Answer(answer?)),
        Err(_) => {
            let sentence = format!("the engine did not answer within {} s", PATIENCE.as_secs());
            Err(Refused::new(StatusCode::SERVICE_UNAVAILABLE, sentence))
        }
    }
}
