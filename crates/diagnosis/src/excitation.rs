//! Whether recordings can say anything of a model: no information is not health.
//!
//! A channel that does not vary carries nothing ([`carried`]). A motion excites a model where an unknown that
//! is wrong by what is commonly believed of it would be seen above the noise ([`Untold`]). Where it would not, the
//! model fits whatever it says, and its fit is no evidence for it.

mod at_rest;
mod carried;
mod mute;
mod sampled;
mod silent;
mod untold;
mod words;

pub use at_rest::at_rest;
pub use carried::{Carried, carried};
pub use mute::mute;
pub use sampled::sampled;
pub use silent::silent;
pub use untold::Untold;
pub use words::figure;
