//! Scores of the model before and after, for each recording.

use super::document::{Fit, Quality, Score, Scored};
use super::score::score;
use quell_model::Model;
use quell_recording::Recording;

/// Recordings that were fitted, and recordings that were held out as a whole.
pub type Recordings<'a> = (&'a [Recording], &'a [Recording]);

/// A model, and the inertia of its link with each payload of the recordings, relative to that of the model.
#[derive(Clone, Copy)]
pub struct Laden<'a> {
    pub model: &'a Model,
    pub payloads: &'a [Option<String>],
    pub inertias: &'a [f64],
}

impl Laden<'_> {
    /// The model with the payload of a recording; a payload that was not fitted is the model's own.
    fn with_payload_of(&self, recording: &Recording) -> Model {
        let mut model = self.model.clone();
        let mut pairs = self.payloads.iter().zip(self.inertias);
        if let Some((_, &inertia)) = pairs.find(|(own, _)| **own == recording.payload) {
            let keys = model.kind.loaded(&model.keys(), inertia);
            for (value, loaded) in model.values.iter_mut().zip(keys) {
                value.value = loaded;
            }
        }
        model
    }
}

/// [`score`] of the refitted model and, if there are findings, of the model with them. A recording for which it
/// fails, for example because the model diverges, is left out.
pub fn scores(
    refitted: Laden,
    with_findings: Option<Laden>,
    (train, held_out): Recordings,
) -> Vec<Scored> {
    let fitted = train.iter().map(|recording| (recording, false));
    let all = fitted.chain(held_out.iter().map(|recording| (recording, true)));
    let scored = |(recording, held_out): (&Recording, bool)| {
        let of = |own: Laden| score(&own.with_payload_of(recording), recording).ok();
        let before = of(refitted)?;
        let after = match with_findings {
            Some(model) => of(model)?,
            None => before.clone(),
        };
        Some(Scored {
            recording: recording.name.clone(),
            held_out,
            before,
            after,
        })
    };
    all.filter_map(scored).collect()
}

/// Replaces the misfits of whole recordings by those of their scores, so that each is the same number
/// everywhere.
pub fn take_over(fit: &mut Fit) {
    let of = |of: fn(&Scored) -> &Score| {
        let rms = |held_out| pooled(fit.scores.iter().filter(|s| s.held_out == held_out).map(of));
        let ([train_rms, _], [held_out_rms, held_out_over_noise]) = (rms(false), rms(true));
        Quality {
            train_rms,
            held_out_rms,
            held_out_over_noise,
        }
    };
    (fit.before, fit.after) = (of(|own| &own.before), of(|own| &own.after));
}

/// Error and error over the noise of all samples together.
fn pooled<'a>(scores: impl Iterator<Item = &'a Score>) -> [f64; 2] {
    let (mut sum, mut over, mut count) = (0.0, 0.0, 0.0);
    for score in scores {
        let samples = score.samples as f64;
        sum += samples * score.rms.powi(2);
        over += samples * score.rms_over_noise.powi(2);
        count += samples;
    }
    [sum, over].map(|sum| (sum / count).sqrt())
}
