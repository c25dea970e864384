//! The recommended shaper, with the reason in a sentence.

use super::candidate::{Candidate, TOLERANCE};
use crate::cli::CliError;
use quell_shapers::{
    Criterion, Mode, Reason, Recommendation, Requirements, Shaper, ShaperError, Standing,
    UncertainMode, recommend,
};

/// How well the modes are known, and what is asked of the shaper.
#[derive(Clone, Copy)]
pub struct Wish {
    /// One standard deviation of each frequency over that frequency.
    pub frequency_std: f64,
    /// One standard deviation of each damping ratio.
    pub damping_std: f64,
    /// The longest delay, s; infinity for any.
    pub max_delay: f64,
}

/// What a shaper leaves of modes that are known only so well: the most of any of them.
#[derive(Clone, Copy)]
pub struct Uncertain {
    /// The shaper.
    pub shaper: &'static dyn Shaper,
    /// Mean residual vibration.
    pub expected: f64,
    /// Residual vibration that 95 % of the uncertainty stays below.
    pub worst_95: f64,
    eligible: bool,
}

/// The recommended shaper.
pub struct Choice {
    /// The shaper and its figures.
    pub figures: Uncertain,
    /// Why, in a sentence.
    pub reason: String,
    /// What it adds to the end of a move on the controller's grid, s.
    pub delay: f64,
}

/// What came of the recommendation.
pub struct Advice {
    /// The shapers for which there are figures.
    pub uncertain: Vec<Uncertain>,
    /// The one to take.
    pub choice: Option<Choice>,
}

/// Recommends one shaper for all the modes by [`recommend`]; residuals nearer than 5 % count as
/// equal.
///
/// Several modes are asked about one by one, each with a share of the delay in proportion to its
/// period, and of the shapers recommended for them the one is taken that leaves least of the mode of
/// which it leaves most. The trains of the other modes only take from what is left of a mode (their
/// amplitudes are positive, so their own residual is at most 1), so that the figures are bounds.
///
/// [`recommend`] judges exact impulse times. Where the controller's grid makes the recommended train
/// longer than allowed, or cannot hold it, the one of the others that leaves least is taken.
///
/// # Errors
/// [`CliError::Input`] where a standard deviation is refused.
pub fn choose(candidates: &[Candidate], modes: &[Mode], wish: Wish) -> Result<Advice, CliError> {
    let max_delay = f64::INFINITY;
    let all = ask(modes, Wish { max_delay, ..wish })?;
    let within = ask(modes, wish)?;
    Ok(Advice {
        uncertain: over_all(&all),
        choice: pick(candidates, &within, wish),
    })
}

/// What is recommended for each of the modes; empty where no shaper is within the delay.
fn ask(modes: &[Mode], wish: Wish) -> Result<Vec<Recommendation>, CliError> {
    let one = |&mode| {
        recommend(
            &uncertain_mode(mode, wish),
            &requirements(mode, modes, wish),
        )
    };
    match modes.iter().map(one).collect() {
        Ok(answers) => Ok(answers),
        Err(ShaperError::NoneFits { .. }) => Ok(Vec::new()),
        Err(error) => Err(CliError::input(error)),
    }
}

fn uncertain_mode(mode: Mode, wish: Wish) -> UncertainMode {
    UncertainMode {
        mode,
        natural_frequency_std: wish.frequency_std * mode.natural_frequency(),
        damping_ratio_std: wish.damping_std,
    }
}

fn requirements(mode: Mode, modes: &[Mode], wish: Wish) -> Requirements {
    let periods: f64 = modes.iter().map(Mode::damped_period).sum();
    Requirements {
        longest_delay: wish.max_delay * (mode.damped_period() / periods),
        criterion: Criterion::Worst95,
        tolerance: TOLERANCE,
        allow_negative: false,
    }
}

/// The figures of each shaper over all modes, of those that can be designed for all; with negative
/// amplitudes they are bounds for a single mode only.
fn over_all(answers: &[Recommendation]) -> Vec<Uncertain> {
    let Some(first) = answers.first() else {
        return Vec::new();
    };
    let one = |index: usize| {
        let of_modes = || {
            answers
                .iter()
                .filter_map(|answer| answer.candidates.get(index))
        };
        let shaper = first.candidates[index].shaper;
        let solved = of_modes().all(|candidate| candidate.standing != Standing::Unsolved);
        let bounded = answers.len() == 1 || shaper.is_convex();
        (solved && bounded).then(|| Uncertain {
            shaper,
            expected: of_modes().map(|c| c.expected).fold(0.0, f64::max),
            worst_95: of_modes().map(|c| c.worst_95).fold(0.0, f64::max),
            eligible: of_modes().all(|c| c.standing == Standing::Eligible),
        })
    };
    (0..first.candidates.len()).filter_map(one).collect()
}

/// The recommended one, or where the grid has not enough room for it, the best of the others.
fn pick(candidates: &[Candidate], answers: &[Recommendation], wish: Wish) -> Option<Choice> {
    let mut eligible = over_all(answers);
    eligible.retain(|one| one.eligible);
    eligible.sort_by(|a, b| a.worst_95.total_cmp(&b.worst_95));
    let is_recommended = |one: &&Uncertain| {
        let name = one.shaper.name();
        answers
            .iter()
            .any(|answer| answer.best.shaper.name() == name)
    };
    let best = eligible.iter().find(is_recommended)?;
    let on_grid = |one: &Uncertain| delay_on_grid(candidates, one.shaper, wish.max_delay);
    let (figures, delay, why) = match on_grid(best) {
        Ok(delay) => (*best, delay, reason(best, answers, wish)),
        Err(refusal) => {
            let fits = |one: &Uncertain| Some((*one, on_grid(one).ok()?));
            let (other, delay) = eligible.iter().find_map(fits)?;
            let name = best.shaper.name();
            let why = format!("{name} would be taken, but {refusal}; no other leaves less");
            (other, delay, why)
        }
    };
    let reason = format!(
        "{}, which adds {delay:.3} s: it leaves at most {} with 95 % probability where {}; {why}.",
        figures.shaper.name(),
        percent(figures.worst_95),
        known(wish),
    );
    Some(Choice {
        figures,
        reason,
        delay,
    })
}

/// What the shaper's train adds on the controller's grid, s; in words why it cannot be taken.
fn delay_on_grid(
    candidates: &[Candidate],
    shaper: &dyn Shaper,
    max_delay: f64,
) -> Result<f64, String> {
    let candidate = candidates.iter().find(|c| c.shaper.name() == shaper.name());
    let design = candidate.map(|candidate| candidate.design.as_ref());
    match design {
        Some(Ok(design)) if design.train.duration() <= max_delay => Ok(design.train.duration()),
        Some(Ok(design)) => Err(format!(
            "on the controller's grid it adds {:.4} s",
            design.train.duration()
        )),
        Some(Err(refusal)) => Err(refusal.clone()),
        None => Err("it is not compared".into()),
    }
}

/// Why the recommended one was taken, by the mode of which it leaves most.
fn reason(taken: &Uncertain, answers: &[Recommendation], wish: Wish) -> String {
    let name = taken.shaper.name();
    let within = match wish.max_delay {
        delay if delay.is_finite() => format!(" within {delay} s of delay"),
        _ => String::new(),
    };
    let binding = answers
        .iter()
        .filter(|answer| answer.best.shaper.name() == name)
        .max_by(|a, b| a.best.worst_95.total_cmp(&b.best.worst_95));
    match binding.map(|answer| (answer.reason, answer.best.delay)) {
        Some((Reason::OnlyOne, _)) => format!("no other is{within}"),
        Some((Reason::ShorterAndAsGood(least), delay)) => format!(
            "{}, which leaves least{within} ({}), is less than {} better and {:.3} s longer",
            least.shaper.name(),
            percent(least.worst_95),
            percent(TOLERANCE),
            least.delay - delay,
        ),
        Some((Reason::LeavesLeast, _)) | None => format!("no other{within} leaves less"),
    }
}

/// How well the modes are known, in words.
fn known(wish: Wish) -> String {
    format!(
        "the frequency is known to {} and the damping ratio to {} (one standard deviation)",
        percent(wish.frequency_std),
        wish.damping_std,
    )
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
