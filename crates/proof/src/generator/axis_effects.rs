//! The effects that can be hidden in a driven axis.

use super::axis::Axis;
use super::plan::Table;
use super::surfaces::DryFriction;
use std::f64::consts::TAU;

/// Forces of the motion without anything hidden.
pub struct Forces {
    /// Rms, N.
    pub rms: f64,
    /// Greatest, N.
    pub most: f64,
    /// Rms of the force's rate over its rms, 1/s.
    pub rate: f64,
    /// Greatest speed, m/s.
    pub speed: f64,
    /// Least and greatest position, m.
    pub span: [f64; 2],
}

/// Parameters by name.
pub type Parameters = Vec<(&'static str, f64)>;

/// An effect: name, table, and how it enters for a share of the force and three numbers in [0, 1).
pub type Entry = (
    &'static str,
    Table,
    fn(&mut Axis, &Forces, f64, [f64; 3]) -> Parameters,
);

const KNOWN: Table = Table::Catalogue;

/// Effects as the textbook has them, and what the mixture has outside the catalogue.
pub const ENTRIES: &[Entry] = &[
    ("coulomb_friction", KNOWN, |axis, forces, share, _| {
        let friction = share * forces.rms;
        axis.dry = Some(DryFriction::coulomb(friction));
        vec![("friction", friction)]
    }),
    ("stribeck_friction", KNOWN, |axis, forces, share, shape| {
        let friction = share * forces.rms;
        let breakaway = 1.4 + 1.1 * shape[0];
        let stribeck_velocity = forces.speed * (0.02 + 0.1 * shape[1]);
        axis.dry = Some(DryFriction {
            breakaway,
            stribeck_velocity,
            ..DryFriction::coulomb(friction)
        });
        vec![
            ("excess", breakaway - 1.0),
            ("friction", friction),
            ("stribeck_velocity", stribeck_velocity),
        ]
    }),
    (
        "asymmetric_friction",
        KNOWN,
        |axis, forces, share, shape| {
            let uneven = (0.3 + 0.6 * shape[0]) * (shape[1] - 0.5).signum();
            let sides = [1.0 + uneven, 1.0 - uneven].map(|side| side * share * forces.rms);
            axis.dry = Some(DryFriction {
                kinetic: sides,
                ..DryFriction::coulomb(0.0)
            });
            vec![("asymmetry", uneven), ("friction", share * forces.rms)]
        },
    ),
    ("force_offset", KNOWN, |axis, forces, share, shape| {
        axis.offset = (shape[0] - 0.5).signum() * share * forces.rms;
        // The catalogue counts a force against the motion.
        vec![("force", -axis.offset)]
    }),
    ("cogging", KNOWN, |axis, forces, share, shape| {
        let pitch = 0.02 + 0.06 * shape[0];
        axis.cogging = [
            share * forces.rms * 2f64.sqrt(),
            TAU / pitch,
            TAU * shape[1],
        ];
        vec![("amplitude", axis.cogging[0]), ("order", axis.cogging[1])]
    }),
    ("dead_zone", KNOWN, |axis, forces, share, _| {
        axis.dead_zone = share * forces.rms;
        vec![("half_width", axis.dead_zone)]
    }),
    ("saturation", KNOWN, |axis, forces, share, _| {
        axis.saturation = (1.0 - 1.5 * share) * forces.most;
        vec![("limit", axis.saturation)]
    }),
    (
        "torque_constant_nonlinearity",
        KNOWN,
        |axis, forces, share, _| {
            axis.loss = [share, forces.most];
            vec![("loss", share), ("reference", forces.most)]
        },
    ),
    ("drive_lag", KNOWN, |axis, forces, share, _| {
        axis.lag = share / forces.rate;
        vec![("time_constant", axis.lag)]
    }),
    (
        "position_dependent_friction",
        Table::Strange,
        |axis, forces, share, shape| {
            let waves = [0.7 + 0.3 * shape[0], TAU / (0.03 + 0.1 * shape[1])];
            let friction = share * forces.rms;
            axis.dry = Some(DryFriction {
                waves,
                ..DryFriction::coulomb(friction)
            });
            vec![
                ("depth", waves[0]),
                ("friction", friction),
                ("order", waves[1]),
            ]
        },
    ),
];
