//! One stretch of a recording as a model sees it: an input, and the outputs to be predicted.

use super::circle::Radius;
use super::coupling::Coupling;
use super::gain::Gain;
use super::known::Known;
use super::piecewise::{Grid, Hold};
use quell_recording::Role;

/// The record of one sensor.
#[derive(Clone, Debug)]
pub struct Output {
    /// The quantity that it measures; a tip position has become an angle, and is a link position.
    pub role: Role,
    /// Role of the channel.
    pub channel: Role,
    /// Stamps, s.
    pub time: Vec<f64>,
    /// Values, SI.
    pub values: Vec<f64>,
    /// Columns that are added to the prediction with unknown coefficients: an offset, the frame.
    pub columns: Vec<Vec<f64>>,
    /// Information on these coefficients from other coordinates of the sensor: rows `(weights, value)` of a
    /// least-squares problem in units of one standard deviation.
    pub witness: Vec<(Vec<f64>, f64)>,
    /// Radius of the tip's circle as the tracker saw it, if the arc determines it.
    pub radius: Option<Radius>,
    /// Direction of the tip's motion in the columns of an accelerometer, a unit vector; empty where one column was given.
    pub direction: Vec<f64>,
    /// First guess of an unknown gain; the last of the columns corrects it.
    pub gain: Option<Gain>,
    /// Factor from residuals to reported errors, which are in `unit`.
    pub scale: f64,
    /// Unit of reported errors.
    pub unit: String,
    /// Whether it has a clock of its own, different from the input's.
    pub own_clock: bool,
    /// First guess of the excess of its clock's reading, s.
    pub clock_offset: f64,
    /// Noise level of the other coordinates of the sensor, in the unit of the values.
    pub noise_witness: Option<f64>,
    /// Rounding step of the coordinates from which the values are computed, in the unit of the values.
    pub coordinate_step: Option<f64>,
}

/// The start of a window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Window {
    /// When, s: a stamp of the input.
    pub time: f64,
    /// Position and velocity of the motor side, deformation and its rate, as they were measured.
    pub state: [f64; 4],
}

/// One stretch of a recording.
#[derive(Clone, Debug)]
pub struct Experiment {
    /// Which channel drives it.
    pub input: Role,
    /// Its stamps, s.
    pub input_time: Vec<f64>,
    /// Its values, SI.
    pub input_values: Vec<f64>,
    /// Standard deviation of the noise that an interval of the samples adds to it, where it is the integral of a measured
    /// velocity.
    pub input_walk: Option<f64>,
    /// Response of the error of its values to independent draws of unit variance, one for each sample, where they were
    /// smoothed: as many samples before the draw's own as from that on.
    pub input_smoothed: Option<Vec<f64>>,
    /// Its course between samples.
    pub hold: Hold,
    /// Nodes of the integration.
    pub grid: Grid,
    /// The measurements.
    pub outputs: Vec<Output>,
    /// Position of the motor side and deformation at the start, and their rates, as far as measured.
    pub initial: [f64; 4],
    /// Instants at which the motion is restarted; empty where the model does not drift.
    pub windows: Vec<Window>,
    /// Coupling of a free motor side to its measured motion; `None` where it is simulated by itself.
    pub coupling: Option<Coupling>,
    /// Known forces on the link and its known inertia, over time.
    pub known: Known,
    /// Unit of positions.
    pub position_unit: String,
    /// Unit of the input.
    pub input_unit: String,
    /// Unit of the model's forces: that of the drive's input where no key converts it to a force, else N, N.m
    /// or that of a measured force.
    pub force_unit: String,
    /// The payload of the axis, as the recording calls it.
    pub payload: Option<String>,
    /// Index of its recording in a set; an event of one recording does not happen in another.
    pub recording: usize,
}

impl Experiment {
    /// The same experiment with other values of the input at its stamps; values that are not finite change
    /// nothing.
    pub fn with_input(&self, values: Vec<f64>) -> Self {
        let mut other = self.clone();
        let step = self.grid.step() * (1.0 + 1e-9);
        if let Ok(grid) = Grid::new(&self.input_time, &values, self.hold, step) {
            other.set_grid(grid);
            other.input_values = values;
        }
        other
    }

    /// Sets other nodes of the integration.
    pub(super) fn set_grid(&mut self, grid: Grid) {
        self.coupling = self.coupling.take().map(|own| own.over(&grid, &[]));
        self.grid = grid;
    }

    /// The same in one piece, with its motor side coupled to the measured motion at this rate, rad/s; unchanged
    /// where no encoder measures the motor side.
    #[must_use]
    pub fn coupled(&self, rate: f64) -> Self {
        let mut outputs = self.outputs.iter();
        let encoder = outputs.find(|output| output.role == Role::MotorPosition);
        let coupling =
            encoder.and_then(|own| Coupling::new([&own.time, &own.values], rate, &self.grid));
        let windows = match coupling {
            Some(_) => Vec::new(),
            None => self.windows.clone(),
        };
        Self {
            coupling,
            windows,
            ..self.clone()
        }
    }

    /// First and last instant of the input, s.
    pub fn span(&self) -> (f64, f64) {
        (
            self.input_time[0],
            self.input_time[self.input_time.len() - 1],
        )
    }

    /// Mean distance of the input's stamps, s.
    pub fn mean_interval(&self) -> f64 {
        let (first, last) = self.span();
        (last - first) / (self.input_time.len() - 1) as f64
    }

    /// Number of measured values.
    pub fn samples(&self) -> usize {
        self.outputs.iter().map(|output| output.values.len()).sum()
    }
}
