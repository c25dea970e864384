#![doc = include_str!("../README.md")]

pub mod alignment;
pub mod arc_registration;
pub mod clock_offset;
pub mod contradiction;
mod course;
pub mod deformation;
pub mod description;
pub mod direction;
pub mod error;
pub mod forced_response;
pub mod fourier;
pub mod golden_section;
pub mod hangs;
pub mod icp;
pub mod icp_registration;
pub mod integrated_velocity;
pub mod kinematics;
pub mod measurement;
pub mod noise;
pub mod polynomial;
pub mod ratio_in_motion;
pub mod registration;
pub mod rest;
pub mod rounding;
pub mod singular_values;
mod smoother;
pub mod spectrum;
pub mod spline;
pub mod static_ratio;
pub mod strong;
pub mod tip_registration;
mod two_sides;
pub mod urdf;

pub use alignment::{Aligned, Aligner, Clock};
pub use arc_registration::{ArcRegistration, register_arc};
pub use clock_offset::{ClockFit, fit_clock_offset};
pub use contradiction::Contradiction;
pub use course::Course;
pub use deformation::{
    DeformationSample, DeformationSensor, RecordedDeformation, deformation, recorded_deformation,
    tip_deformation,
};
pub use description::{Body, Tree, TreeJoint, UrdfChain};
pub use direction::Direction;
pub use error::SignalError;
pub use forced_response::ForcedResponse;
pub use fourier::fourier;
pub use golden_section::golden_section;
pub use hangs::{Hang, Hangs};
pub use icp::{IcpOptions, IcpResult, icp, initial_guess};
pub use icp_registration::register_icp;
pub use integrated_velocity::integrated_velocity;
pub use kinematics::{Chain, ChainJoint, DhRow, JointArc, JointKind};
pub use measurement::Measurement;
pub use noise::{NoiseFloor, noise_floor, quantisation_step};
pub use registration::{Registration, kabsch};
pub use rest::{Motion, Phase, RestDetector, RestRule, free_decays, phases};
pub use rounding::Rounding;
pub use singular_values::SingularValues;
pub use spectrum::{Peak, Spectrum, Window, spectrum};
pub use spline::{CubicSpline, End, check_knots};
pub use static_ratio::{Mistake, StaticRatio};
pub use strong::STRONG;
pub use tip_registration::TipRegistration;
pub use urdf::{read_urdf, read_urdf_tree};
