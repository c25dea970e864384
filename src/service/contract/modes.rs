//! The modes that moves have taught.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::learning::{Charted, ModeChart, ModeOnWay};

/// What is known of the modes of a joint.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct LearningView {
    /// The modes on the way of the last move, in the order in which they were found; none before one is known.
    pub modes: Vec<KnownMode>,
    /// Share of the unshaped vibration that the next move was expected to leave, percent; absent where no train was prescribed.
    pub expected_percent: Option<f64>,
    /// Why the train is not followed in motion: `several_modes`, `pose`, `worse`, `unexplained`; absent where it is.
    pub held: Option<String>,
    /// The same in words.
    pub held_reason: Option<String>,
}

impl LearningView {
    /// Labels and sizes of [`Self::numbers`], as `std_msgs/msg/Float64MultiArray` has them.
    pub fn dimensions(&self) -> [(&'static str, usize); 2] {
        [("mode", self.modes.len()), (KnownMode::LABEL, 6)]
    }

    /// The modes as numbers, one after the other; whether a mode is shaped for is 1 or 0.
    pub fn numbers(&self) -> Vec<f64> {
        self.modes.iter().flat_map(KnownMode::numbers).collect()
    }
}

/// A mode on the way of a move.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct KnownMode {
    /// Undamped natural frequency in the middle of the way, Hz.
    pub frequency_hz: f64,
    /// One standard deviation of it, Hz.
    pub frequency_std_hz: f64,
    /// Undamped natural frequencies where the way begins and ends, Hz.
    pub along_hz: [f64; 2],
    /// Damping ratio.
    pub damping_ratio: f64,
    /// One standard deviation of it.
    pub damping_ratio_std: f64,
    /// Its part of what the move leaves unshaped, percent.
    pub contribution_percent: f64,
    /// Whether it is shaped for; one that hardly rings is told, not shaped for.
    pub shaped: bool,
}

impl KnownMode {
    const LABEL: &'static str =
        "frequency_hz,frequency_std_hz,damping_ratio,damping_ratio_std,contribution_percent,shaped";

    fn numbers(&self) -> [f64; 6] {
        [
            self.frequency_hz,
            self.frequency_std_hz,
            self.damping_ratio,
            self.damping_ratio_std,
            self.contribution_percent,
            f64::from(self.shaped),
        ]
    }
}

impl From<&ModeOnWay> for KnownMode {
    fn from(mode: &ModeOnWay) -> Self {
        let [first, .., last] = &mode.modes;
        Self {
            frequency_hz: mode.known.mode.hertz(),
            frequency_std_hz: hertz(mode.known.natural_frequency_std),
            along_hz: [first.hertz(), last.hertz()],
            damping_ratio: mode.known.mode.damping_ratio(),
            damping_ratio_std: mode.known.damping_ratio_std,
            contribution_percent: 100.0 * mode.contribution,
            shaped: mode.shaped,
        }
    }
}

/// The map of a joint's modes over its pose.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct JointMap {
    /// The joint.
    pub joint: String,
    /// Payload for which it is drawn, kg.
    pub payload_kg: f64,
    /// One entry a mode.
    pub modes: Vec<ModeMap>,
}

/// The map of a mode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct ModeMap {
    /// Damping ratio in the middle of the range.
    pub damping_ratio: f64,
    /// One standard deviation of it.
    pub damping_ratio_std: f64,
    /// Frequency over the range of the joint.
    pub curve: Vec<MapPoint>,
    /// What each move said on the average of its way, the oldest first.
    pub moves: Vec<MapMove>,
}

/// A frequency at a position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct MapPoint {
    /// Position, rad.
    pub position_rad: f64,
    /// Undamped natural frequency, Hz.
    pub frequency_hz: f64,
    /// One standard deviation of it, Hz.
    pub frequency_std_hz: f64,
}

/// What a move said.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct MapMove {
    /// Where it began, rad.
    pub from_rad: f64,
    /// Where it ended, rad.
    pub to_rad: f64,
    /// Payload, kg.
    pub payload_kg: f64,
    /// The average frequency, and where it holds.
    pub average: MapPoint,
}

impl JointMap {
    /// Of a joint that carries a payload, kg.
    pub fn new(joint: &str, payload: f64, chart: &[ModeChart]) -> Self {
        let said = |spoken: &crate::learning::Spoken| MapMove {
            from_rad: spoken.way[0],
            to_rad: spoken.way[1],
            payload_kg: spoken.payload,
            average: (&spoken.average).into(),
        };
        let mode = |chart: &ModeChart| ModeMap {
            damping_ratio: chart.damping[0],
            damping_ratio_std: chart.damping[1],
            curve: chart.curve.iter().map(MapPoint::from).collect(),
            moves: chart.moves.iter().map(said).collect(),
        };
        Self {
            joint: joint.to_owned(),
            payload_kg: payload,
            modes: chart.iter().map(mode).collect(),
        }
    }

    /// The curves as CSV, one line a mode and position; modes are counted from 1.
    pub fn csv(&self) -> String {
        let mut text = String::from("mode,position_rad,frequency_hz,frequency_std_hz\n");
        for (k, mode) in self.modes.iter().enumerate() {
            for point in &mode.curve {
                let MapPoint {
                    position_rad,
                    frequency_hz,
                    frequency_std_hz,
                } = point;
                let line = format!(
                    "{},{position_rad},{frequency_hz},{frequency_std_hz}\n",
                    k + 1
                );
                text.push_str(&line);
            }
        }
        text
    }
}

impl From<&Charted> for MapPoint {
    fn from(at: &Charted) -> Self {
        Self {
            position_rad: at.position,
            frequency_hz: hertz(at.natural_frequency),
            frequency_std_hz: hertz(at.std),
        }
    }
}

fn hertz(omega: f64) -> f64 {
    omega / core::f64::consts::TAU
}
