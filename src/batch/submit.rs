//! Recordings into a queue.

use std::collections::{HashMap, HashSet};
use std::path::PathBuf;

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
    for (path, name) in batch.recordings.iter().zip(names(&batch.recordings)) {
        let packed = match pack(path) {
            Ok(packed) => packed,
            Err(error) => {
                submission.refused.push((path.clone(), error));
                told(None);
                continue;
            }
        };
        let job = Job::new(name, &packed, &batch.model, batch.seed);
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

/// Names of recordings for people: folder or file of each, with as many folders above as tell it from the others.
fn names(paths: &[PathBuf]) -> Vec<String> {
    // As `.` or `..`: a path without a name has one where it leads.
    let named = |path: &PathBuf| match path.file_name() {
        Some(_) => path.clone(),
        None => path.canonicalize().unwrap_or_default(),
    };
    let paths: Vec<PathBuf> = paths.iter().map(named).collect();
    let tail = |path: &PathBuf, count: usize| -> PathBuf {
        let skipped = path.components().count().saturating_sub(count);
        path.components().skip(skipped).collect()
    };
    let mut counts = vec![1; paths.len()];
    loop {
        let names: Vec<PathBuf> = paths
            .iter()
            .zip(&counts)
            .map(|(p, &n)| tail(p, n))
            .collect();
        let mut held: HashMap<&PathBuf, Vec<usize>> = HashMap::new();
        for (index, name) in names.iter().enumerate() {
            held.entry(name).or_default().push(index);
        }
        let alike = held.values().filter(|same| same.len() > 1).flatten();
        let longer = alike.filter(|&&index| counts[index] < paths[index].components().count());
        let longer: Vec<usize> = longer.copied().collect();
        if longer.is_empty() {
            return names
                .iter()
                .map(|name| name.to_string_lossy().into_owned())
                .collect();
        }
        longer.into_iter().for_each(|index| counts[index] += 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_recordings_apart() {
        let paths = [
            "fleet/a/train",
            "fleet/b/train",
            "fleet/b/test",
            "train",
            "x/./train",
            "x/./train",
        ];
        let named = names(&paths.map(PathBuf::from));
        assert_eq!(
            named,
            ["a/train", "b/train", "test", "train", "x/train", "x/train"]
        );
    }
}
