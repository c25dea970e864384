//! Sizes of the motion that a model explains, as reference for the size of every effect.

/// Extremes of a baseline simulation, in the model's units. All finite and above 0, but for the
/// ranges and the candidate events.
#[derive(Clone, Debug, PartialEq)]
pub struct Scales {
    /// Largest deformation; a hundredth of the travel without an elastic joint.
    pub deformation: f64,
    /// Largest rate of the deformation; the largest speed without an elastic joint.
    pub deformation_rate: f64,
    /// Least and greatest position of the link (of the motor side where there is no link).
    pub position: (f64, f64),
    /// Largest speed of the link (or motor side).
    pub velocity: f64,
    /// Largest acceleration of the link (or motor side).
    pub acceleration: f64,
    /// Largest force where forces act: elastic force or drive force.
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
    /// Instants of possible unexplained events, s; the most suspicious first.
    pub candidate_events: Vec<f64>,
    /// Significant angular frequencies of the unexplained residual, rad/s; the strongest first.
    pub candidate_frequencies: Vec<f64>,
    /// Orders of a force periodic in position (teeth, poles, balls), in radians per unit of position, that
    /// would explain most of the residual; the strongest first.
    pub candidate_orders: Vec<f64>,
    /// What the link may have met at possible unexplained events; the most suspicious first.
    pub candidate_stops: Vec<CandidateStop>,
    /// Whether a force drives the link, rather than the motion of the motor side.
    pub forced: bool,
    /// Whether the output is the angle of a tip from a tracker, whose scale shows in the radius only.
    pub tracked: bool,
    /// Whether it is an axis without a spring.
    pub rigid: bool,
    /// The ranges that are visited.
    pub visited: Visited,
}

/// Something that the link may have met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CandidateStop {
    /// Position of the link when it was pushed.
    pub position: f64,
    /// Its farthest position about then.
    pub farthest: f64,
    /// 1 for a stop above the link, -1 for one below it.
    pub side: f64,
}

impl CandidateStop {
    /// One that the link met at its farthest position.
    pub fn at(position: f64, side: f64) -> Self {
        Self {
            position,
            farthest: position,
            side,
        }
    }
}

/// Least and greatest value of the coordinates of static laws. An empty range is unknown: the largest size in
/// both directions is used instead.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Visited {
    /// Deformation.
    pub deformation: (f64, f64),
    /// Rate of the deformation.
    pub deformation_rate: (f64, f64),
    /// Position on the drive's side.
    pub motor_position: (f64, f64),
    /// Its velocity.
    pub motor_velocity: (f64, f64),
    /// Input.
    pub input: (f64, f64),
    /// Reading of the sensor.
    pub reading: (f64, f64),
}

/// A motion of size 1 in every respect, without candidates, for callers that do not depend on the scales.
impl Default for Scales {
    fn default() -> Self {
        Self {
            deformation: 1.0,
            deformation_rate: 1.0,
            position: (-1.0, 1.0),
            velocity: 1.0,
            acceleration: 1.0,
            force: 1.0,
            input: 1.0,
            natural_frequency: 1.0,
            damping_ratio: 0.1,
            span: (0.0, 1.0),
            sample_time: 0.01,
            candidate_events: Vec::new(),
            candidate_frequencies: Vec::new(),
            candidate_orders: Vec::new(),
            candidate_stops: Vec::new(),
            forced: false,
            tracked: false,
            rigid: false,
            visited: Visited::default(),
        }
    }
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

    /// Range of the deformation.
    pub fn visited_deformation(&self) -> (f64, f64) {
        known(self.visited.deformation, self.deformation)
    }

    /// Range of the rate of the deformation, equally long in both directions.
    pub fn visited_slip(&self) -> (f64, f64) {
        both_ways(self.visited.deformation_rate, self.deformation_rate)
    }

    /// Range of the link's position.
    pub fn visited_position(&self) -> (f64, f64) {
        known(self.position, self.deformation)
    }

    /// Range of the position on the drive's side.
    pub fn visited_motor_position(&self) -> (f64, f64) {
        match self.visited.motor_position {
            (from, to) if from < to => (from, to),
            _ => self.visited_position(),
        }
    }

    /// Range of its velocity, equally long in both directions.
    pub fn visited_motor_velocity(&self) -> (f64, f64) {
        both_ways(self.visited.motor_velocity, self.velocity)
    }

    /// Range of the input.
    pub fn visited_input(&self) -> (f64, f64) {
        known(self.visited.input, self.input)
    }

    /// Range of the sensor's readings.
    pub fn visited_reading(&self) -> (f64, f64) {
        match self.visited.reading {
            (from, to) if from < to => (from, to),
            _ => self.visited_position(),
        }
    }
}

/// A range, or this size in both directions.
fn known((from, to): (f64, f64), size: f64) -> (f64, f64) {
    match from < to {
        true => (from, to),
        false => (-size, size),
    }
}

/// The larger size of a range in both directions: friction has a curve for each direction, whatever the motion
/// visited.
fn both_ways(range: (f64, f64), size: f64) -> (f64, f64) {
    let (from, to) = known(range, size);
    let most = to.max(-from);
    (-most, most)
}
