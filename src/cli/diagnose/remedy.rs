//! What an engineer may do about an effect, in one sentence.

/// By effect.
const REMEDIES: &[(&str, &str)] = &[
    (
        "coulomb_friction",
        "Check lubrication, preload and seals; compensate it with a term that changes sign with the velocity.",
    ),
    (
        "stribeck_friction",
        "Check the lubricant at low speed; avoid creeping moves, or compensate breakaway and sliding friction apart.",
    ),
    (
        "viscous_friction",
        "Check the lubricant's viscosity and temperature; add a term in proportion to the velocity to the feedforward.",
    ),
    (
        "asymmetric_friction",
        "Look for a load or a preload that acts one way; compensate each direction by its own friction.",
    ),
    (
        "force_offset",
        "Look for a bias of the amplifier, gravity or a spring that pulls one way; add the constant to the feedforward.",
    ),
    (
        "cogging",
        "Look for the motor's poles, a ball screw or a bent shaft at this period; compensate it by a table over the position.",
    ),
    (
        "dead_zone",
        "Check the amplifier's offset and dead band; add the breakaway value to small commands.",
    ),
    (
        "stiction",
        "Check lubrication and preload; add the breakaway force to the command when the motion starts.",
    ),
    (
        "drive_lag",
        "Put the lag into the model of the drive, or raise the bandwidth of the inner loop.",
    ),
    (
        "drive_delay",
        "Count the cycles between controller and amplifier; shift the command, or the model's input, by the delay.",
    ),
    (
        "saturation",
        "Lower the acceleration so that the amplifier's limit is not reached, or raise the limit.",
    ),
    (
        "rate_limit",
        "Lower speed or jerk until the command stays below the limit of rate.",
    ),
    (
        "torque_constant_nonlinearity",
        "Correct the torque constant for high currents, where the iron saturates.",
    ),
    (
        "presliding_hysteresis",
        "Expect lost motion at each reversal; approach a target from one side, or compensate with a bristle model.",
    ),
    (
        "hysteretic_stiffness",
        "Expect the position to depend on the way it was reached; approach from one side, or model the loop.",
    ),
    (
        "backlash",
        "Check gear play, couplings and loose screws; preload the gear, or keep the load from changing sign.",
    ),
    (
        "cubic_stiffness",
        "Shape for the frequency at the amplitude that is worked with; it shifts with the size of the move.",
    ),
    (
        "bilinear_stiffness",
        "Look for a preload that lifts off or a stop that is touched on one side; shape for both frequencies.",
    ),
    (
        "quadratic_damping",
        "Expect large vibration to die out faster than small; take the damping at the amplitude that matters.",
    ),
    (
        "transmission_ripple",
        "Look for an eccentric gear or a worn tooth at this period; correct the position by a table.",
    ),
    (
        "stiffness_drift",
        "Look for warming up or a loosening screw; identify the frequency anew while it works.",
    ),
    (
        "viscoelastic_creep",
        "Look for belts, bonded joints and polymer parts; wait for the creep or model it.",
    ),
    (
        "viscous_drag",
        "Damping acts between link and ground: look for cables, hoses and seals that do not turn with the joint.",
    ),
    (
        "quadratic_drag",
        "Look for resistance of air or fluid; it matters at high speed only.",
    ),
    (
        "gravity_load",
        "Put the payload's weight and its lever into the model, or balance it.",
    ),
    (
        "second_mode",
        "Shape for both frequencies; look for a flexible gripper, tool or payload at the second.",
    ),
    (
        "pose_dependent_frequency",
        "Take the frequency by pose: shape for the pose at the end of the move.",
    ),
    (
        "payload_change",
        "Tell the controller of the payload, or let it identify the frequency after each grip.",
    ),
    (
        "end_stop",
        "Keep clear of the stop, or look for a cable that tightens there.",
    ),
    (
        "base_mode",
        "Look at how the machine is bolted down; put a sensor on the base, and shape for its frequency as well.",
    ),
    (
        "clock_skew",
        "Give both devices one clock, or stretch one recording's time by the skew.",
    ),
    ("sensor_delay", "Shift the sensor's stamps by the delay."),
    (
        "sensor_lag",
        "Lower the filtering in the sensor, or put its lag into the model.",
    ),
    (
        "sensor_lag_second_order",
        "Lower the filtering in the sensor, or put its lag into the model; if it rings, look at how it is mounted.",
    ),
    (
        "sensor_gain",
        "Calibrate the sensor's scale against a known motion.",
    ),
    (
        "deformation_gain",
        "The sensor sees another share of the mode than believed: check where it is mounted, and the lever arm.",
    ),
    (
        "misalignment",
        "Align the sensor's axis with the direction of motion, or calibrate its frame.",
    ),
    (
        "sensor_drift",
        "Let the sensor warm up, and set its zero at rest.",
    ),
    (
        "quantisation",
        "Take a finer resolution, or dither; the steps are larger than the model believes.",
    ),
    (
        "external_disturbance",
        "Find out what touched the machine at these times; leave those stretches out.",
    ),
];

/// By place, for effects without a line of their own.
const PLACES: &[(&str, &str)] = &[
    (
        "drive",
        "Look between the command and the motor side: amplifier, motor, bearings.",
    ),
    (
        "transmission",
        "Look between motor side and link: gear, belt, coupling, joint.",
    ),
    (
        "link",
        "Look at what the joint carries: link, tool, payload, cables.",
    ),
    ("base", "Look at how the machine is fixed to the ground."),
    (
        "sensor",
        "Look at the sensor: its scale, filter, clock and mounting.",
    ),
    (
        "environment",
        "Look for what acts on the machine from outside.",
    ),
];

/// The sentence for an effect at a place.
pub fn remedy(effect: &str, place: &str) -> Option<&'static str> {
    let find = |table: &'static [(&str, &'static str)], key: &str| {
        table
            .iter()
            .find(|entry| entry.0 == key)
            .map(|entry| entry.1)
    };
    find(REMEDIES, effect).or_else(|| at(place))
}

/// Where to look, for a place.
pub fn at(place: &str) -> Option<&'static str> {
    let entry = PLACES.iter().find(|entry| entry.0 == place);
    entry.map(|entry| entry.1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    #[test]
    fn each_effect_of_the_catalogue_has_a_remedy_at_each_place() {
        for effect in EFFECTS {
            for place in effect.places {
                assert!(
                    remedy(effect.name, place.name()).is_some(),
                    "{}",
                    effect.name
                );
            }
        }
    }
}
