//! Time series on their own clocks: alignment, registration of frames, kinematics, spectra.

pub mod alignment;
pub mod deformation;
pub mod error;
pub mod kinematics;
pub mod measurement;
pub mod urdf;

pub use alignment::{Aligned, Aligner, Clock};
pub use deformation::{DeformationSample, DeformationSensor};
pub use error::SignalError;
pub use kinematics::{Chain, ChainJoint, DhRow, JointArc, JointKind};
pub use measurement::Measurement;
pub use urdf::{Body, UrdfChain, read_urdf};
