//! Whether recordings contain information about a model: a good fit without information proves nothing.
//!
//! A channel that does not vary carries nothing ([`carried`]). A motion excites a model if an error of an
//! unknown, as large as its usual uncertainty, would be seen above the noise ([`Untold`]). If it would not, the
//! model fits with wrong values, too, and its fit is no evidence for it.

mod at_rest;
mod carried;
mod mute;
mod resonance;
mod sampled;
mod silent;
mod untold;
mod words;

pub use at_rest::at_rest;
pub use carried::{Carried, carried};
pub use mute::mute;
pub use resonance::NoResonance;
pub use sampled::sampled;
pub use silent::silent;
pub use untold::Untold;
