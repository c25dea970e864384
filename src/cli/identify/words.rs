//! The findings in sentences.

use super::{Findings, registrations};
use crate::estimators::ESTIMATORS;
use crate::identification::{Identification, Run, Stretch};
use crate::page::{decimals_beside, fixed};
use quell_shapers::UncertainMode;

/// `decay 0.39-2.00s`: what a run's off-line references used.
pub fn used(run: &Run) -> String {
    seconds(run, run.fitted)
}

/// The same for what its estimators were shown.
pub fn shown(run: &Run) -> String {
    seconds(run, run.shown)
}

fn seconds(run: &Run, Stretch { from, until }: Stretch) -> String {
    let is_all = Stretch { from, until } == run.stretch;
    let kind = match (run.is_free_decay, is_all) {
        (true, _) => "decay",
        (_, true) => "all",
        _ => "part",
    };
    format!("{kind} {}-{}s", fixed(from, 2), fixed(until, 2))
}

/// The mode that is quoted, with its standard deviations: of the default estimator, else of the batch fit.
pub fn known(findings: &Findings) -> Option<UncertainMode> {
    let found = &findings.found;
    let quoted = found
        .quoted(0)
        .and_then(|run| run.estimator(ESTIMATORS[0].name)?.estimate)
        .map(|e| UncertainMode {
            mode: e.mode,
            natural_frequency_std: e.natural_frequency_std,
            damping_ratio_std: e.damping_ratio_std,
        });
    let fitted = || {
        let fit = found.reference().batch()?;
        Some(UncertainMode {
            mode: fit.mode,
            natural_frequency_std: fit.natural_frequency_std.unwrap_or(0.0),
            damping_ratio_std: fit.damping_ratio_std.unwrap_or(0.0),
        })
    };
    quoted.or_else(fitted)
}

/// A warning where a mode is slower than any joint's: the stamps may be in another unit.
pub fn slow(hertz: f64) -> Option<String> {
    // Recorded joints vibrate at 1.8 Hz and above, long cranes at 0.1 Hz.
    (hertz < 0.1).then(|| {
        format!(
            "A mode of {hertz:.4} Hz is slower than any joint's: the stamps may be in ms or us. Say so with time_unit = \"ms\" \
             in recording.toml."
        )
    })
}

/// Everything that a table does not say.
pub fn remarks(findings: &Findings) -> Vec<String> {
    let found = &findings.found;
    let mut remarks = Vec::new();
    match (found.best_decay, found.known_input_holds) {
        (None, _) => remarks.push(format!(
            "The motor side never rests long enough for a free decay; with its motion as known \
             input the model explains {:.1} % of the deformation's variance.",
            100.0 * found.explained
        )),
        (_, Some(false)) => remarks.push(
            "The motor side's motion does not explain the deformation by one mode (a filter in the \
             sensor, or more physics): all estimators were run on the free decay."
                .into(),
        ),
        _ => {}
    }
    if found.memory.is_finite() && found.known_input_holds != Some(false) {
        remarks.push(format!(
            "The motor side, as measured, does not carry the vibration to the end: it is taken as \
             free again after every {:.2} s.",
            found.memory
        ));
    }
    remarks.extend(known(findings).and_then(|known| slow(known.mode.hertz())));
    remarks.extend(long(found));
    remarks.extend(two_modes(findings));
    remarks.extend(damping(findings));
    if let Some(registration) = &findings.series.registration {
        remarks.push(format!(
            "The tip sensor's clock reads {:+.3} ms (± {:.1} us) against the encoder's; it was \
             registered to {:.1} um rms off the arc's plane.",
            1e3 * registration.clock.offset,
            1e6 * registration.clock_offset_std,
            1e6 * registration.normal_rms,
        ));
    }
    remarks.extend(registrations::remarks(&findings.registered));
    remarks
}

/// The part of a long recording that was looked at.
fn long(found: &Identification) -> Option<String> {
    if !found.is_long() {
        return None;
    }
    let Stretch { from, until } = found.whole.shown;
    let fit = match found.is_fit_of_part() {
        true => {
            "over the whole the batch fit leaves the range of frequencies, and what is told of it is of the part"
        }
        false => "the batch fit goes on from there over the whole",
    };
    let mut words = format!(
        "The recording is long: the mode was looked for from {from:.0} s to {until:.0} s, where the deformation \
         varies most, and the estimators were run over that part; {fit}."
    );
    if found.rests_looked_at < found.rests {
        words += &format!(
            " Of {} rests {} were looked at for a free decay, spread over the recording.",
            found.rests, found.rests_looked_at
        );
    }
    Some(words)
}

/// A sentence on a second mode, and what to do about it.
fn two_modes(findings: &Findings) -> Option<String> {
    let (first, second) = findings.found.two_modes()?;
    let [one, other] = [first, second].map(|e| {
        let (std, damping_std) = (e.natural_frequency_std / core::f64::consts::TAU, e.damping_ratio_std);
        let [hertz, damping] = [decimals_beside(std, 3), decimals_beside(damping_std, 4)];
        format!(
            "{:.hertz$} Hz (± {std:.hertz$}) with a damping ratio of {:.damping$} (± {damping_std:.damping$})",
            e.mode.hertz(),
            e.mode.damping_ratio(),
        )
    });
    Some(format!(
        "There are two modes: {one}, and {other}. One is excluded by the likelihood ratio. `quell shape` \
         shapes for both: `--mode {:.3},{:.4} --mode {:.3},{:.4}`.",
        first.mode.hertz(),
        first.mode.damping_ratio(),
        second.mode.hertz(),
        second.mode.damping_ratio(),
    ))
}

/// A sentence on damping against amplitude.
fn damping(findings: &Findings) -> Option<String> {
    let dependence = findings.found.amplitude_dependence.as_ref()?;
    let [first, last] = dependence.ends();
    let word = if dependence.falls_with_amplitude() {
        "falls as the amplitude does"
    } else if dependence.grows_as_amplitude_falls() {
        "grows as the amplitude falls, as dry friction makes it"
    } else {
        return Some(
            "The damping does not depend on the amplitude, as far as this decay tells.".into(),
        );
    };
    Some(format!(
        "The damping {word}: {:.4} at an amplitude of {} mrad, {:.4} at {} mrad.",
        first.damping_ratio,
        fixed(1e3 * first.amplitude, 3),
        last.damping_ratio,
        fixed(1e3 * last.amplitude, 3),
    ))
}
