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
            "acc\u{e9}l\u{e9}ration",
            "vibration",
        ],
        true,
    ),
    (Role::TipAcceleration, &[], &["ax", "ay", "az"], true),
    (
        Role::Deformation,
        &[],
        &[
            "deformation",
            "deflection",
            "defl",
            "d\u{e9}formation",
            "durchbiegung",
        ],
        true,
    ),
    (
        Role::Deformation,
        &[],
        &["strain", "flex", "bending"],
        false,
    ),
    (
        Role::MotorCurrent,
        &[],
        &["current", "amps", "strom", "motorstrom", "courant"],
        true,
    ),
    (
        Role::MotorVoltage,
        &[],
        &["voltage", "volts", "spannung"],
        true,
    ),
    // Beside what a loop commands: `extra_force`.
    (Role::KnownForce, &["force"], EXTRA, true),
    (Role::KnownForce, &["torque"], EXTRA, true),
    (
        Role::Torque,
        &[],
        &[
            "torque",
            "tau",
            "effort",
            "drehmoment",
            "motormoment",
            "couple",
            "momenten",
        ],
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
            "consigne",
            "goal",
            "planned",
            // A name in data sets for machine learning.
            "action",
        ],
        false,
    ),
    (
        Role::CommandPosition,
        &["set"],
        &["position", "pos", "angle", "point", "value"],
        false,
    ),
    // Of Power PMAC: `Motor[1].DesPos`.
    (Role::CommandPosition, &["des"], &["position", "pos"], false),
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
        &[],
        &["motorgeschwindigkeit", "motordrehzahl"],
        true,
    ),
    (
        Role::MotorVelocity,
        &[],
        &[
            "velocity",
            "vel",
            "speed",
            "qd",
            "dq",
            "qdot",
            "geschwindigkeit",
            "geschwindigkeits",
            "drehzahl",
            "vitesse",
        ],
        false,
    ),
    (
        Role::LinkPosition,
        &["link"],
        &["position", "pos", "angle"],
        true,
    ),
    (
        Role::LinkPosition,
        &[],
        &["abtriebswinkel", "abtriebsposition", "lastwinkel"],
        true,
    ),
    (Role::LinkPosition, &["last"], &["lage", "winkel"], false),
    (
        Role::LinkPosition,
        &[],
        &[
            "link",
            "load",
            "arm",
            "abtrieb",
            "abtriebsseite",
            "lastseite",
        ],
        false,
    ),
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
        &["moteur"],
        &["position", "angle"],
        true,
    ),
    (
        Role::MotorPosition,
        &[],
        &["motorposition", "motorwinkel"],
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
            "act",
            "present",
            "feedback",
            "fbk",
            "ist",
            "istposition",
            "istwert",
            "lage",
            "winkel",
        ],
        false,
    ),
];

/// Words for a force that acts besides those that the machine makes, and is known.
const EXTRA: &[&str] = &["extra", "additional", "known"];

/// Words that tell two signals of one joint apart: how they were made, or which of its sensors they are of.
pub const BESIDE: &[&str] = &[
    "raw",
    "filtered",
    "unfiltered",
    "filt",
    "smoothed",
    "measured",
    "meas",
    "estimated",
    "est",
    "observed",
    "simulated",
    "sim",
    "model",
    "predicted",
    "error",
    "err",
    "mean",
    "std",
    "min",
    "max",
    "absolute",
    "abs",
    "relative",
    "rel",
    "incremental",
    "input",
    "output",
    "inner",
    "outer",
    "primary",
    "secondary",
    "low",
    "high",
];

/// Words for what is left between a command and what was measured: no quantity of the joint itself.
pub const ERRORS: &[&str] = &[
    "err",
    "error",
    "errors",
    "lag",
    "following",
    "schleppfehler",
    "schleppabstand",
    "regelabweichung",
    "fehler",
    "erreur",
];

/// Words for time.
pub const TIME: &[&str] = &[
    "time",
    "t",
    "timestamp",
    "stamp",
    "zeit",
    "uhrzeit",
    "zeitstempel",
    "temps",
    "heure",
    "seconds",
    "elapsed",
    "millis",
    "micros",
    "date",
    "datetime",
];
/// Words for counters.
pub const COUNTS: &[&str] = &[
    "sample", "index", "n", "i", "row", "no", "nr", "count", "scan", "tick", "frame", "seq",
    "point",
];

/// Words for what an axis carries.
pub const PAYLOADS: &[&str] = &["payload", "nutzlast", "zuladung"];

/// Words for angles, which no length follows: the `m` of `theta_m` is the motor.
pub const ANGLES: &[&str] = &["theta", "phi", "q", "angle", "winkel"];

/// Words for the inputs of an instrument.
pub const INPUTS: &[&str] = &[
    "ch", "chan", "channel", "kanal", "voie", "canal", "input", "ai", "analog", "in", "trace",
    "probe", "signal",
];
