//! How large the motion is that a model explains: the yardstick of every effect's size.

/// Extremes of a baseline simulation, in the model's units. All finite and above 0, but for the
/// range of positions and the candidate events.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// Largest deformation; a hundredth of the travel where nothing bends.
    pub deformation: f64,
    /// Largest rate of the deformation; the largest speed where nothing bends.
    pub deformation_rate: f64,
    /// Least and greatest position of the link (of the motor side where there is no link).
    pub position: (f64, f64),
    /// Largest speed of the link (or motor side).
    pub velocity: f64,
    /// Largest acceleration of the link (or motor side).
    pub acceleration: f64,
    /// Largest force at the place where forces act: elastic force or drive force.
    pub force: f64,
    /// Largest value of the input.
    pub input: f64,
    /// Dominant angular frequency of the axis, rad/s (1 / duration of the fastest move where it has
    /// no spring).
    pub natural_frequency: f64,
    /// Damping ratio of that mode.
    pub damping_ratio: f64,
    /// First and last instant, s.
    pub span: (f64, f64),
    /// Sampling period of the sensor, s.
    pub sample_time: f64,
    /// Instants at which something unexplained seems to happen, s; the most suspicious first.
    pub candidate_events: Vec<f64>,
    /// Angular frequencies that stand out of the unexplained residual, rad/s; the strongest first.
    pub candidate_frequencies: Vec<f64>,
    /// Radians of a force periodic in position for one unit of position (teeth, poles, balls) that
    /// would explain most of the residual; the strongest first.
    pub candidate_orders: Vec<f64>,
    /// Where the link was when something unexplained seems to have happened, and the sign of its velocity;
    /// the most suspicious first.
    pub candidate_stops: Vec<[f64; 2]>,
    /// Whether a force drives the link, and not the motion of the motor side.
    pub forced: bool,
    /// Whether the output is the angle of a tip that a tracker sees: its scale shows in the radius alone.
    pub tracked: bool,
    /// Whether nothing bends: an axis without a spring.
    pub rigid: bool,
}

impl Scales {
    /// Length of the recording, s.
    pub fn duration(&self) -> f64 {
        self.span.1 - self.span.0
    }

    /// Undamped period of the mode, s.
    pub fn period(&self) -> f64 {
        std::f64::consts::TAU / self.natural_frequency
    }

    /// Length of the range of positions.
    pub fn travel(&self) -> f64 {
        self.position.1 - self.position.0
    }
}
