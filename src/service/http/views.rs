//! The state of everything now, and the estimates of it.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use axum::http::header::CACHE_CONTROL;
use axum::response::{IntoResponse, Response};
use schemars::JsonSchema;
use serde::Serialize;

use super::App;
use crate::service::contract::{EstimateView, JointSnapshot, ModeValue, Snapshot, TrainView};

#[derive(Serialize, JsonSchema)]
pub struct Estimate<'a> {
    joint: &'a str,
    adaptation: bool,
    adaptation_frozen: bool,
    estimate: &'a Option<EstimateView>,
    mode: Option<ModeValue>,
    mode_since_s: f64,
    shaper: &'static str,
    train: &'a TrainView,
    true_mode: Option<ModeValue>,
}

impl<'a> From<&'a JointSnapshot> for Estimate<'a> {
    fn from(joint: &'a JointSnapshot) -> Self {
        Self {
            joint: &joint.name,
            adaptation: joint.adaptation,
            adaptation_frozen: joint.adaptation_frozen,
            estimate: &joint.estimate,
            mode: joint.mode,
            mode_since_s: joint.mode_since_s,
            shaper: joint.shaper,
            train: &joint.train,
            true_mode: joint.true_mode,
        }
    }
}

/// `GET /api/v1/state`.
pub async fn state(State(app): State<Arc<App>>) -> Response {
    fresh(app.handle.snapshot().as_ref())
}

/// `GET /api/v1/estimates`.
pub async fn estimates(State(app): State<Arc<App>>) -> Response {
    let snapshot: Arc<Snapshot> = app.handle.snapshot();
    let all: Vec<_> = snapshot.joints.iter().map(Estimate::from).collect();
    fresh(&all)
}

/// An answer that is another one the next time.
pub fn fresh(value: &impl Serialize) -> Response {
    ([(CACHE_CONTROL, "no-store")], Json(value)).into_response()
}
