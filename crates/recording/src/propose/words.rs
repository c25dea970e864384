//! The words of columns' names: roles, time, counters.

use super::super::role::Role;

/// Words of roles, in the order of the tests: all of the first and one of the second must be present. The last
/// field tells whether they have no other meaning.
pub const WORDS: &[(Role, &[&str], &[&str], bool)] = &[
    (
        Role::LinkAcceleration,
        &["link"],
        &["acc", "accel", "acceleration"],
        true,
    ),
    (
        Role::TipAcceleration,
        &[],
        &[
            "acc",
            "accel",
            "acceleration",
            "accelerometer",
            "adxl",
            "beschleunigung",
            "vibration",
        ],
        true,
    ),
    (Role::TipAcceleration, &[], &["ax", "ay", "az"], true),
    (Role::Deformation, &[], &["deformation", "deflection"], true),
    (
        Role::Deformation,
        &[],
        &["strain", "flex", "bending"],
        false,
    ),
    (Role::MotorCurrent, &[], &["current", "amps", "strom"], true),
    (
        Role::MotorVoltage,
        &[],
        &["voltage", "volts", "spannung"],
        true,
    ),
    (
        Role::Torque,
        &[],
        &["torque", "tau", "effort", "drehmoment"],
        true,
    ),
    (Role::Force, &[], &["force", "kraft"], true),
    (
        Role::CommandPosition,
        &[],
        &[
            "command",
            "cmd",
            "commanded",
            "setpoint",
            "target",
            "reference",
            "ref",
            "desired",
            "demand",
            "demanded",
            "soll",
            "sollwert",
            "sollposition",
            // A name in data sets for machine learning.
            "action",
        ],
        false,
    ),
    (
        Role::MotorVelocity,
        &["motor"],
        &["velocity", "vel", "speed", "rpm"],
        true,
    ),
    (
        Role::LinkVelocity,
        &["link"],
        &["velocity", "vel", "speed"],
        true,
    ),
    (
        Role::MotorVelocity,
        &["joint"],
        &["velocity", "vel", "speed"],
        false,
    ),
    (Role::MotorVelocity, &[], &["qd", "dq", "qdot"], false),
    (
        Role::LinkPosition,
        &["link"],
        &["position", "pos", "angle"],
        true,
    ),
    (Role::LinkPosition, &[], &["link", "load", "arm"], false),
    (
        Role::TipPosition,
        &[],
        &["tip", "tcp", "tool", "ee", "tracker", "laser"],
        false,
    ),
    (
        Role::MotorPosition,
        &["motor"],
        &["position", "pos", "angle", "encoder"],
        true,
    ),
    (
        Role::MotorPosition,
        &[],
        &[
            "motor",
            "encoder",
            "enc",
            "joint",
            "theta",
            "q",
            "position",
            "pos",
            "angle",
            "state",
            "actual",
            "ist",
            "istposition",
            "winkel",
        ],
        false,
    ),
];

/// Words for time.
pub const TIME: &[&str] = &[
    "time",
    "t",
    "timestamp",
    "stamp",
    "zeit",
    "seconds",
    "millis",
    "micros",
    "date",
    "datetime",
];
/// Words for counters.
pub const COUNTS: &[&str] = &["sample", "index", "n", "i", "row", "no", "nr", "count"];
