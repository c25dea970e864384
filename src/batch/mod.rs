//! Batches: many recordings, each diagnosed by itself, on one machine or on many.
//!
//! A recording becomes a [`Job`] that bears all it needs: files, model, seed. Its key is the hash of these,
//! so that the same job is known wherever it comes from. A [`Queue`] takes jobs and hands them out; [`work`]
//! does them. There are two queues, [`InProcess`] and, with the feature `nats`, one in NATS JetStream; what
//! stands between is the same code.
//!
//! A job is acknowledged after its [`Answer`] is stored, and an answer is stored once: a worker may die at
//! any instant, and another does the job again. What cannot be diagnosed gets an answer as well, the error,
//! and so does a job whose workers died time and again: it is set aside, and holds nobody up.

mod answer;
mod error;
mod features;
mod find;
mod folder;
mod hash;
mod in_process;
mod job;
#[cfg(feature = "nats")]
mod nats;
mod pack;
mod packed;
mod queue;
mod shard;
mod submit;
mod unpack;
mod work;

pub use answer::{About, Answer, Done};
pub use error::BatchError;
pub use features::connect;
pub use find::find;
pub use folder::{Folder, REPORT};
pub use in_process::InProcess;
pub use job::Job;
pub use pack::{MOST_BYTES, pack};
pub use packed::Packed;
pub use queue::{Claim, Queue, Submitted, Taken, Ticket};
pub use shard::Shard;
pub use submit::{Batch, Submission, submit};
pub use unpack::unpack;
pub use work::{MOST_DELIVERIES, Work, work};
