#![doc = include_str!("../README.md")]

pub mod adaptation;
pub mod controller;
pub mod estimators;
pub mod learning;
pub mod tolerance;
