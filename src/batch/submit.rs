//! Recordings into a queue.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use super::error::BatchError;
use super::job::Job;
use super::pack::pack;
use super::queue::{Queue, Submitted};
use super::shard::Shard;

/// Recordings, and what is asked of each.
#[derive(Clone, Debug)]
pub struct Batch {
    /// The recordings: manifests, folders with one, MCAP files.
    pub recordings: Vec<PathBuf>,
    /// The text of the model file.
    pub model: String,
    /// Seed of the bootstrap.
    pub seed: u64,
    /// The share to do, if not all.
    pub shard: Option<Shard>,
}

/// The outcome of putting a batch in.
#[derive(Debug, Default)]
pub struct Submission {
    /// Keys of the jobs of this share, each once, in the recordings' order.
    pub keys: Vec<String>,
    /// Jobs that wait now.
    pub queued: usize,
    /// Recordings whose job was there already.
    pub waiting: usize,
    /// Recordings whose job had its answer already.
    pub answered: usize,
    /// Recordings of other shares.
    pub elsewhere: usize,
    /// Recordings that could not be packed, and why.
    pub refused: Vec<(PathBuf, BatchError)>,
}

/// Packs the recordings one by one and puts them into a queue; `told` hears of each that is through, and what
/// became of it, none where it was refused or is another share's.
///
/// # Errors
/// [`BatchError`] where the queue takes no more. A recording that cannot be packed holds nobody up.
pub fn submit(
    queue: &dyn Queue,
    batch: &Batch,
    told: &mut dyn FnMut(Option<Submitted>),
) -> Result<Submission, BatchError> {
    let mut submission = Submission::default();
    let mut known = HashSet::new();
    for path in &batch.recordings {
        let packed = match pack(path) {
            Ok(packed) => packed,
            Err(error) => {
                submission.refused.push((path.clone(), error));
                told(None);
                continue;
            }
        };
        let job = Job::new(name(path), &packed, &batch.model, batch.seed);
        if batch.shard.is_some_and(|shard| !shard.has(&job.key)) {
            submission.elsewhere += 1;
            told(None);
            continue;
        }
        let submitted = queue.submit(&job, packed)?;
        match submitted {
            Submitted::Queued => submission.queued += 1,
            Submitted::Waiting => submission.waiting += 1,
            Submitted::Answered => submission.answered += 1,
        }
        if known.insert(job.key.clone()) {
            submission.keys.push(job.key);
        }
        told(Some(submitted));
    }
    Ok(submission)
}

/// The name of a recording for people: its folder, or its file.
fn name(path: &Path) -> String {
    let named = match path.file_name() {
        Some(name) => Path::new(name).to_path_buf(),
        // As `.` or `..`.
        None => path.canonicalize().unwrap_or_default(),
    };
    named
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}
