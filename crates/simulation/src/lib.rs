//! Simulated flexible arms ([`plant`]), and shaped moves of them in closed loop ([`closed_loop`]).

pub mod closed_loop;
pub mod plant;
