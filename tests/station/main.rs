//! The service without its threads, stepped by a simulated clock: nothing here depends on a machine that is
//! quiet.

mod beyond;
mod faults;
#[path = "../service_disk/faulty.rs"]
mod faulty;
mod feed;
mod heard;
mod jog;
mod learning;
mod model;
mod modes;
mod oracle;
#[path = "../modes/plant.rs"]
mod plant;
mod sequence;
mod set_clock;
mod stops;
mod together;
mod tolerance;
mod turns;
mod untimed;
mod ways;
mod world;
