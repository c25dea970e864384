//! Learning where the tracker stands and how its clock reads, from a slow move.

use quell_trajectories::Limits;

use super::ClosedLoopError;
use crate::plant::ArmSimulation;
use crate::signal::DeformationSensor;

pub(super) fn commission(
    arm: &mut ArmSimulation,
    _limits: Limits,
) -> Result<DeformationSensor, ClosedLoopError> {
    Ok(arm
        .robot()
        .deformation_sensor(&arm.robot().home(), arm.joint())?)
}
