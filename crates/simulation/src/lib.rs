#![doc = include_str!("../README.md")]

pub mod closed_loop;
pub mod plant;
