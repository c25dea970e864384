//! Demonstration of shaping on the simulated arm: the same move unshaped, shaped for a wrong mode, and shaped
//! for the mode that was learned in the meantime.

use std::time::Duration;

use super::contract::{
    Accepted, Handle, JointSnapshot, ModeValue, Phase, Request, ServiceError, ShapingChange,
    Snapshot,
};

/// Ends of the moves, rad.
const ENDS: [f64; 2] = [core::f64::consts::FRAC_PI_6, 0.0];
/// Error of the belief: a quarter, as `quell move` assumes.
const WRONG: f64 = 1.25;
/// Interval of the checks whether a move is over.
const LOOKED: Duration = Duration::from_millis(20);
/// A move that takes longer was stopped by a user.
const PATIENCE: Duration = Duration::from_secs(10);

/// Checks that the robot is the simulated arm, the only one that may move without a person beside it.
///
/// # Errors
/// [`ServiceError::OnlyEmbedded`] for another one.
pub fn check(handle: &Handle) -> Result<(), ServiceError> {
    match handle.snapshot().robot {
        "embedded" => Ok(()),
        _ => Err(ServiceError::OnlyEmbedded {
            what: "a demonstration",
        }),
    }
}

/// Runs the demonstration: unshaped, wrong belief, adapting, adapted. It enables moves, as its request implies,
/// and ends early if a user stops or disables. Shaper and adaptation are then again what they were. So is the
/// mode, if it ended early; else the one that was learned stays.
///
/// # Errors
/// The error of a request that is refused; that of [`check`].
pub async fn run(handle: &Handle) -> Result<(), ServiceError> {
    check(handle)?;
    let first = until(handle, |snapshot| rests(snapshot, 0)).await?;
    let before = &first.joints[0];
    let shown = show(handle, before).await;
    let restored = ShapingChange {
        joint: Some(before.name.clone()),
        adaptation: Some(before.adaptation),
        enabled: Some(before.shaping),
        kind: Some(before.shaper.into()),
        mode: before.mode.filter(|_| shown.is_err()),
    };
    handle.ask(Request::Shaping(restored)).await?;
    shown
}

async fn show(handle: &Handle, first: &JointSnapshot) -> Result<(), ServiceError> {
    let joint = first.name.clone();
    let truth = first.true_mode.or(first.mode);
    let wrong = truth.map(|mode| ModeValue {
        frequency_hz: WRONG * mode.frequency_hz,
        ..mode
    });
    handle.ask(Request::Enable).await?;
    let steps = [
        (Some("none"), false),
        (None, false),
        (None, true),
        (None, true),
    ];
    for (step, (shaper, adaptation)) in steps.into_iter().enumerate() {
        let change = ShapingChange {
            adaptation: Some(adaptation),
            enabled: Some(true),
            kind: Some("zv".into()),
            mode: wrong.filter(|_| step < 2),
            ..ShapingChange::default()
        };
        handle.ask(Request::Shaping(change)).await?;
        let asked = handle.ask(Request::Move {
            joint: joint.clone(),
            target: ENDS[step % 2],
            shaper: shaper.map(str::to_owned),
        });
        let Accepted::Move { id, .. } = asked.await? else {
            return Ok(());
        };
        let done = until(handle, |snapshot| rests(snapshot, id)).await?;
        if done.moves.iter().any(|one| one.id == id && one.interrupted) {
            return Err(ServiceError::Stopped);
        }
    }
    Ok(())
}

/// Whether everything rests, and the result of this move is published.
fn rests(snapshot: &Snapshot, id: u64) -> bool {
    let told = id == 0 || snapshot.moves.iter().any(|done| done.id == id);
    told && snapshot
        .joints
        .first()
        .is_some_and(|joint| joint.phase == Phase::Rest && joint.motor_rad.is_some())
}

async fn until(
    handle: &Handle,
    holds: impl Fn(&Snapshot) -> bool,
) -> Result<std::sync::Arc<Snapshot>, ServiceError> {
    let waited = async {
        loop {
            let snapshot = handle.snapshot();
            if holds(&snapshot) {
                return snapshot;
            }
            tokio::time::sleep(LOOKED).await;
        }
    };
    let waited = tokio::time::timeout(PATIENCE, waited).await;
    waited.map_err(|_| ServiceError::Stopped)
}
