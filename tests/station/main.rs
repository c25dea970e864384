//! The service without its threads, stepped by a simulated clock: nothing here depends on a machine that is
//! quiet.

mod heard;
mod learning;
mod model;
mod sequence;
mod untimed;
mod world;
