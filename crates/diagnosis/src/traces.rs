//! Series of a diagnosis for a report.

/// One output over one recording.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OutputTrace {
    /// Name of the recording and role of the output, such as `deformation`.
    pub name: String,
    /// Unit of all its values.
    pub unit: String,
    /// Stamps, s.
    pub time: Vec<f64>,
    /// Measured values; for a position of a flexible joint its deformation, which is the visible part.
    pub recorded: Vec<f64>,
    /// Values of the refitted model.
    pub before: Vec<f64>,
    /// Values of the model with the findings.
    pub after: Vec<f64>,
    /// Standard deviation of the noise.
    pub noise_std: f64,
    /// Stretches that were held out of the fit, s.
    pub held_out: Vec<[f64; 2]>,
}

/// The missing force (or sensor error) over a coordinate.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CoordinateTrace {
    /// Name of the coordinate, such as `deformation rate`.
    pub coordinate: String,
    /// Its unit.
    pub coordinate_unit: String,
    /// Unit of the missing force.
    pub unit: String,
    /// Coordinate.
    pub x: Vec<f64>,
    /// Missing force.
    pub missing: Vec<f64>,
    /// Share of its variance that the coordinate explains, 0 to 1, for each coordinate tried.
    pub explained: Vec<(String, f64)>,
}

/// Amplitude spectrum of the residual.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SpectrumTrace {
    /// Hz.
    pub frequency: Vec<f64>,
    /// Amplitude before, in the output's unit.
    pub before: Vec<f64>,
    /// Amplitude after.
    pub after: Vec<f64>,
}

/// All that the report draws.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Traces {
    /// One for each output and recording; the first is the most important.
    pub outputs: Vec<OutputTrace>,
    /// Missing force over time: stamps, values, its standard deviation.
    pub missing_time: Vec<f64>,
    /// Missing force.
    pub missing: Vec<f64>,
    /// Its standard deviation.
    pub missing_std: Vec<f64>,
    /// Its unit.
    pub missing_unit: String,
    /// The coordinate that it follows best.
    pub coordinate: Option<CoordinateTrace>,
    /// Spectrum of the first output's residual.
    pub spectrum: SpectrumTrace,
    /// Share of the residual's energy above the noise in each phase of the motion.
    pub phases: Vec<(String, f64)>,
}
