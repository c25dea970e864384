//! The run: diagnoses each recording, and reads the truth only afterwards.

use super::folder::{FolderError, read_cases, read_truths, write_case, write_truths};
use super::generator::{Case, generate, generate_kind};
use super::kind::Kind;
use super::score::{Judged, Score};
use super::truth::Truth;
use super::verdict::Verdict;
use quell_recording::Recording;
use quell_trajectories::PlanError;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;
use thiserror::Error;

/// A diagnosis under test. It gets the nominal model, the recording to diagnose and, to score the resulting
/// model, other moves that it must not use otherwise.
pub type Diagnose<'a> =
    dyn Fn(&Path, &Recording, &Recording) -> Result<Verdict, String> + Sync + 'a;

/// Where the cases come from.
#[derive(Clone, Debug)]
pub enum Source {
    /// The generator.
    Generated {
        /// How many.
        cases: u64,
        /// The seed.
        seed: u64,
        /// Kinds, in turn; the mixture where there are none.
        kinds: Vec<Kind>,
        /// Folder that keeps them; else only the models are written, for a while.
        keep: Option<PathBuf>,
    },
    /// A folder.
    Folder(PathBuf),
}

/// Why a run stops.
#[derive(Debug, Error)]
pub enum ProofError {
    /// A folder of cases.
    #[error(transparent)]
    Folder(#[from] FolderError),
    /// A case whose moves cannot be planned.
    #[error("case {index} of seed {seed}: {source}")]
    Plan {
        /// The seed.
        seed: u64,
        /// The case.
        index: u64,
        /// The planner's error.
        source: PlanError,
    },
}

impl From<quell_recording::RecordingError> for ProofError {
    fn from(error: quell_recording::RecordingError) -> Self {
        Self::Folder(error.into())
    }
}

/// Diagnoses all cases, on all cores, and scores them. `done` is called after each case.
///
/// A diagnosis that fails counts as a case that went wrong.
///
/// # Errors
/// [`ProofError`] where a case cannot be made, written or read.
pub fn run(
    source: &Source,
    diagnose: &Diagnose,
    done: &(dyn Fn() + Sync),
) -> Result<Score, ProofError> {
    let cases = match source {
        Source::Folder(folder) => from_folder(folder, diagnose, done)?,
        Source::Generated {
            cases,
            seed,
            kinds,
            keep,
        } => {
            let passing = std::env::temp_dir();
            let passing = passing.join(format!("quell-prove-{}-{seed}", std::process::id()));
            let folder = keep.as_ref().unwrap_or(&passing);
            let one = |index| {
                let kind = kinds.get(index as usize % kinds.len().max(1)).copied();
                let case = made(kind, *seed, index);
                let judged = case
                    .and_then(|case| generated(folder, keep.is_some(), (index, case), diagnose));
                done();
                judged
            };
            let judged = (0..*cases)
                .into_par_iter()
                .map(one)
                .collect::<Result<Vec<_>, _>>();
            match keep {
                Some(folder) => {
                    let cases = judged.as_ref().map_or(&[][..], |cases| &cases[..]);
                    write_truths(folder, cases.iter().map(|c| (c.name.as_str(), &c.truth)))?;
                }
                // A temporary folder that cannot be removed may stay.
                None => drop(std::fs::remove_dir_all(&passing)),
            }
            judged?
        }
    };
    Ok(Score { cases })
}

fn made(kind: Option<Kind>, seed: u64, index: u64) -> Result<Case, ProofError> {
    let case = match kind {
        Some(kind) => generate_kind(kind, seed, index),
        None => generate(seed, index),
    };
    case.map_err(|source| ProofError::Plan {
        seed,
        index,
        source,
    })
}

fn generated(
    folder: &Path,
    keep: bool,
    (index, case): (u64, Case),
    diagnose: &Diagnose,
) -> Result<Judged, ProofError> {
    let number = index as usize;
    let sealed = if keep {
        write_case(folder, number, &case)?
    } else {
        super::folder::write_model(folder, number, &case)?
    };
    let verdict = timed(diagnose, &sealed.model, &case.train, &case.test);
    let oracle = Some(case.oracle());
    Ok(Judged::new(sealed.name, case.truth, verdict, oracle))
}

fn from_folder(
    folder: &Path,
    diagnose: &Diagnose,
    done: &(dyn Fn() + Sync),
) -> Result<Vec<Judged>, ProofError> {
    let sealed = read_cases(folder)?;
    let one = |case: &super::SealedCase| -> Result<(String, Verdict), ProofError> {
        let train = Recording::from_path(&case.train)?;
        let test = Recording::from_path(&case.test)?;
        let verdict = timed(diagnose, &case.model, &train, &test);
        done();
        Ok((case.name.clone(), verdict))
    };
    let verdicts = sealed.par_iter().map(one).collect::<Result<Vec<_>, _>>()?;
    let truths = read_truths(folder)?;
    let judged = verdicts.into_iter().filter_map(|(name, verdict)| {
        let truth: Truth = truths.get(&name)?.clone();
        Some(Judged::new(name, truth, verdict, None))
    });
    Ok(judged.collect())
}

fn timed(diagnose: &Diagnose, model: &Path, train: &Recording, test: &Recording) -> Verdict {
    let start = Instant::now();
    let verdict = diagnose(model, train, test);
    let seconds = start.elapsed().as_secs_f64();
    match verdict {
        // The closure may measure the time of the diagnosis itself.
        Ok(verdict) if verdict.seconds > 0.0 => verdict,
        Ok(verdict) => Verdict { seconds, ..verdict },
        Err(reason) => {
            tracing::warn!(model = %model.display(), reason, "diagnosis failed");
            Verdict::failed(seconds)
        }
    }
}
