//! The findings in sentences.

use super::{Findings, registrations};
use crate::identification::{Identification, NO_RESONANCE, Recommended, Run, Stretch, Why};
use crate::page::{decimals_beside, fixed, significant};
use crate::recording::Role;
use quell_shapers::UncertainMode;

/// `decay, 0.39 to 2.00 s`: the data of a run's off-line references.
pub fn used(run: &Run) -> String {
    seconds(run, run.fitted)
}

/// The same for the data of its estimators.
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
    format!("{kind}, {} to {} s", fixed(from, 2), fixed(until, 2))
}

/// The recommended mode, its method, and the reason, in a few sentences.
pub fn recommended(findings: &Findings, best: &Recommended) -> String {
    let modes: Vec<String> = best.modes().map(quoted).collect();
    let found = &findings.found;
    let why = match best.why {
        Why::Motion if found.known_input_holds.is_none() => format!(
            "No unbiased method has a smaller deviation. With the motion as known input it explains {:.1} % of the \
             deformation.",
            100.0 * found.explained
        ),
        Why::Motion => "No unbiased method has a smaller deviation. Motion and free decay agree.".into(),
        Why::Decay => "The motor side's motion does not explain the deformation, so only the free decay counts. No \
                       unbiased method has a smaller deviation there."
            .into(),
        Why::TwoModes => "The likelihood ratio excludes one mode.".into(),
        Why::OffLine => "It is not certain: no on-line estimator gave a mode.".into(),
    };
    let what = of_servo(findings).map_or(String::new(), |what| format!(" {what}"));
    format!("{}, by {}.{what} {why}", modes.join(" and "), best.method)
}

/// A sentence on what the mode is where the command stands for the motor side.
pub fn of_servo(findings: &Findings) -> Option<&'static str> {
    findings.series.includes_servo().then_some(
        "This is a mode of servo and link together, as the recording has no motor_position.",
    )
}

/// A sentence on a damping ratio that may be that of no resonance.
fn damped(best: &Recommended) -> Option<String> {
    let ratio = best.mode.mode.damping_ratio();
    (ratio >= NO_RESONANCE).then(|| {
        format!(
            "It is not certain that this rings: from a damping ratio of {NO_RESONANCE:.3} on a response has no half-power \
             bandwidth, and the 95 % interval begins at {:.3}. Record a faster move, and the rest after it.",
            best.least_damping()
        )
    })
}

/// A sentence on the frequencies at which a mode can be found.
fn searched(found: &Identification) -> String {
    let hertz = |omega: f64| significant(omega / core::f64::consts::TAU, 3);
    let seen = &found.searched;
    format!(
        "A mode was looked for from {} to {} Hz. At {} samples a second none above {} Hz can be seen.",
        hertz(seen.from),
        hertz(seen.to),
        significant(1.0 / seen.sample_time, 3),
        hertz(found.nyquist()),
    )
}

/// A mode with its standard deviations.
fn quoted(known: UncertainMode) -> String {
    let UncertainMode {
        mode,
        natural_frequency_std,
        damping_ratio_std: damping_std,
    } = known;
    let std = natural_frequency_std / core::f64::consts::TAU;
    let [hertz, damping] = [decimals_beside(std, 3), decimals_beside(damping_std, 4)];
    format!(
        "{:.hertz$} Hz (± {std:.hertz$}) with a damping ratio of {:.damping$} (± {damping_std:.damping$})",
        mode.hertz(),
        mode.damping_ratio(),
    )
}

/// A warning if a mode is slower than any joint's: the stamps may be in another unit.
pub fn slow(hertz: f64) -> Option<String> {
    // Recorded joints vibrate at 1.8 Hz and above, long cranes at 0.1 Hz.
    (hertz < 0.1).then(|| {
        format!(
            "A mode of {hertz:.4} Hz is slower than any joint's: the stamps may be in ms or us. Say so with time_unit = \"ms\" \
             in recording.toml."
        )
    })
}

/// All remarks that are not in a table.
pub fn remarks(findings: &Findings) -> Vec<String> {
    let found = &findings.found;
    let mut remarks = Vec::from_iter(motor_side(findings.series.motor_side));
    remarks.extend(findings.series.hangs.as_ref().map(|hangs| {
        format!(
            "{}. That is no motion, and is left out: what is told here is of {} to {} s alone.",
            hangs.words(),
            fixed(findings.found.whole.stretch.from, 3),
            fixed(findings.found.whole.stretch.until, 3)
        )
    }));
    match (found.best_decay, found.known_input_holds) {
        (None, _) => remarks.push(format!(
            "The motor side never rests long enough for a free decay. With its motion as known \
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
            "The measured motor side explains the vibration only for a while. The vibration is fitted in pieces \
             of {:.2} s, each with a free start.",
            found.memory
        ));
    }
    let best = found.recommended();
    remarks.extend(little(found));
    remarks.extend(best.as_ref().and_then(damped));
    remarks.push(searched(found));
    remarks.extend(best.and_then(|best| slow(best.mode.mode.hertz())));
    remarks.extend(best.as_ref().and_then(contradictions));
    remarks.extend(best.and_then(|best| best.doubted).map(doubted));
    remarks.extend(long(found));
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

/// A sentence on a mode that explains less of the deformation than what it leaves, where no free decay shows it.
fn little(found: &Identification) -> Option<String> {
    (found.best_decay.is_none() && found.explained < 0.5).then(|| {
        "The mode is not certain: more of the deformation is something else. Record a move that makes the link ring, and \
         the rest after it."
            .into()
    })
}

/// A sentence if the motor side's position was not measured.
fn motor_side(role: Role) -> Option<String> {
    match role {
        Role::MotorVelocity => {
            Some("The motor side's motion is the integral of motor_velocity.".into())
        }
        Role::CommandPosition => Some(
            "The motor side's motion is taken to be command_position, so that the servo is part of the mode. A recording \
             with motor_position tells the structure from the servo."
                .into(),
        ),
        _ => None,
    }
}

/// The part of a long recording that was analysed.
fn long(found: &Identification) -> Option<String> {
    if !found.is_long() {
        return None;
    }
    let Stretch { from, until } = found.whole.shown;
    let fit = match found.is_fit_of_part() {
        true => {
            "over the whole the batch fit leaves the range of frequencies, so that its values are those of the part"
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

/// A sentence on a second mode that does not vibrate.
fn doubted(second: UncertainMode) -> String {
    format!(
        "With the motion as known input a second mode, {}, explains more than noise. The free decay does not show it: it is \
         more likely an error of the clocks or of the motor side's sensor. It is not recommended.",
        quoted(second)
    )
}

/// A sentence if the stretches contradict each other.
fn contradictions(best: &Recommended) -> Option<String> {
    let [frequency, damping] = best.between;
    let (what, why) = match best.decays_agree {
        false => (
            "The stretches of the recording differ",
            "The mode is not the same throughout, or the sensors' clocks are not",
        ),
        true => (
            "With the motion as known input the mode differs from that of the free decays",
            "The free decays agree: the motion shows more than this mode, or the sensors' clocks differ",
        ),
    };
    let hertz = frequency / core::f64::consts::TAU;
    let parts = [(hertz, " Hz"), (damping, " in the damping ratio")];
    let parts = parts.into_iter().filter(|(by, _)| *by > 0.0);
    let parts: Vec<String> = parts
        .map(|(by, of)| format!("by {}{of}", figure(by)))
        .collect();
    (!parts.is_empty()).then(|| {
        format!(
            "{what} by more than the standard deviations: {}. The standard deviations above include this. {why}.",
            parts.join(", and ")
        )
    })
}

/// Two digits of a deviation.
fn figure(value: f64) -> String {
    let digits = decimals_beside(value, 1);
    format!("{value:.digits$}")
}

/// A sentence on damping against amplitude.
fn damping(findings: &Findings) -> Option<String> {
    let dependence = findings.found.amplitude_dependence.as_ref()?;
    let [first, last] = dependence.ends();
    let word = if dependence.falls_with_amplitude() {
        "falls with the amplitude"
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
