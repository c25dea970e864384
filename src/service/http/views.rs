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

/// What is known of a joint's mode in motion.
#[derive(Serialize, JsonSchema)]
pub struct Estimate<'a> {
    /// Name of the joint.
    joint: &'a str,
    /// Whether the train follows the estimate.
    adaptation: bool,
    /// Whether adaptation waits, because a sensor is not to be trusted.
    adaptation_frozen: bool,
    /// The estimate; absent before there is one.
    estimate: &'a Option<EstimateView>,
    /// The mode that is shaped for.
    mode: Option<ModeValue>,
    /// Since when, seconds since 1970.
    mode_since_s: f64,
    /// Name of the shaper, `none` for unshaped.
    shaper: &'static str,
    /// The train in force.
    train: &'a TrainView,
    /// The mode of the simulated arm; absent for a real one.
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

/// An answer that must not be cached.
pub fn fresh(value: &impl Serialize) -> Response {
    ([(CACHE_CONTROL, "no-store")], Json(value)).into_response()
}
