//! Time series on their own clocks: alignment, registration of frames, kinematics, spectra.

pub mod measurement;

pub use measurement::Measurement;
