//! `quell diagnose`: what physics a model lacks, from what was recorded.

mod findings;
mod head;
mod motion;
mod next;
pub mod page;
mod place;
mod ranking;
mod record;
mod remedy;
mod shown;
mod words;
