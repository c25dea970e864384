//! The recommended shaper, with the reason in sentences.

use super::candidate::Candidate;
use crate::cli::CliError;
use crate::identification::ToldMode;
use quell_shapers::{
    Criterion, Reason, Recommendation, Requirements, Shaper, ShaperError, Standing, UncertainMode,
    recommend,
};

/// The uncertainty of modes of which nothing tells it, and the requirements on the shaper.
#[derive(Clone, Copy)]
pub struct Wish {
    /// One standard deviation of each frequency over that frequency.
    pub frequency_std: f64,
    /// One standard deviation of each damping ratio.
    pub damping_std: f64,
    /// Residual vibration that is small enough.
    pub acceptable: f64,
    /// The longest delay, s; infinity for any.
    pub max_delay: f64,
}

impl Wish {
    /// A mode with the deviations that are told with it, or with these.
    pub fn known(&self, told: &ToldMode) -> UncertainMode {
        let frequency_std = self.frequency_std * told.mode.natural_frequency();
        told.or(frequency_std, self.damping_std)
    }
}

/// A shaper's figures over the uncertainty, from the crate of shapers.
pub type Figures = quell_shapers::Candidate;

/// The recommended shaper.
pub struct Choice {
    /// The shaper and its figures.
    pub figures: Figures,
    /// The reason, in sentences.
    pub reason: String,
    /// Delay that it adds to the end of a move on the controller's grid, s.
    pub delay: f64,
}

/// The result of the recommendation.
pub struct Advice {
    /// Every shaper's figures.
    pub figures: Vec<Figures>,
    /// The recommended one; `None` if no shaper is within the delay.
    pub choice: Option<Choice>,
}

/// Recommends one shaper for all the modes by [`recommend`]: the shortest with an acceptable residual for 95 %
/// of the uncertainty; without such a shaper, the one with the least residual.
///
/// [`recommend`] uses exact impulse times. If the recommended train is longer than allowed on the controller's
/// grid, or does not fit on it, the one with the least residual among the others is taken.
///
/// # Errors
/// [`CliError::Input`] where a standard deviation is refused.
pub fn choose(
    candidates: &[Candidate],
    modes: &[ToldMode],
    wish: Wish,
) -> Result<Advice, CliError> {
    let max_delay = f64::INFINITY;
    let all = ask(modes, Wish { max_delay, ..wish })?;
    let found = ask(modes, wish)?;
    Ok(Advice {
        figures: all.map_or(Vec::new(), |all| all.candidates.to_vec()),
        choice: found.and_then(|found| pick(candidates, &found, (wish, known(modes, wish)))),
    })
}

/// The crate's recommendation; `None` if no shaper is within the delay.
fn ask(modes: &[ToldMode], wish: Wish) -> Result<Option<Recommendation>, CliError> {
    let estimates: Vec<UncertainMode> = modes.iter().map(|told| wish.known(told)).collect();
    let requirements = Requirements {
        longest_delay: wish.max_delay,
        criterion: Criterion::Worst95,
        acceptable: wish.acceptable,
        tolerance: 0.0,
        allow_negative: false,
    };
    match recommend(&estimates, &requirements) {
        Ok(found) => Ok(Some(found)),
        Err(ShaperError::NoneFits { .. }) => Ok(None),
        Err(error) => Err(CliError::input(error)),
    }
}

/// The recommended shaper, or the best of the others if it does not fit on the grid.
fn pick(
    candidates: &[Candidate],
    found: &Recommendation,
    (wish, known): (Wish, String),
) -> Option<Choice> {
    let on_grid = |one: &Figures| delay_on_grid(candidates, one.shaper, wish.max_delay);
    let (figures, delay, why) = match on_grid(&found.best) {
        Ok(delay) => (found.best, delay, reason(found, wish)),
        Err(refusal) => {
            let eligible = found.candidates.iter();
            let eligible = eligible.filter(|one| one.standing == Standing::Eligible);
            let others = eligible.filter_map(|one| Some((*one, on_grid(one).ok()?)));
            let (least, delay) = others.min_by(|a, b| a.0.worst_95.total_cmp(&b.0.worst_95))?;
            let name = found.best.shaper.name();
            let left = percent(least.worst_95);
            let why =
                format!("{name} would be taken, but {refusal}. Of the others it leaves least");
            (least, delay, format!("{why}, up to {left}"))
        }
    };
    let name = figures.shaper.name();
    Some(Choice {
        figures,
        reason: format!("{name}, which adds {delay:.3} s. {why}. This holds {known}."),
        delay,
    })
}

/// The delay of the shaper's train on the controller's grid, s, or the reason why it is not possible.
fn delay_on_grid(
    candidates: &[Candidate],
    shaper: &dyn Shaper,
    max_delay: f64,
) -> Result<f64, String> {
    let same = |candidate: &&Candidate| candidate.shaper.name() == shaper.name();
    let candidate = candidates.iter().find(same).ok_or("it is not compared")?;
    let design = candidate.design.as_ref().map_err(String::clone)?;
    match design.train.duration() {
        delay if delay <= max_delay => Ok(delay),
        delay => Err(format!("on the controller's grid it adds {delay:.4} s")),
    }
}

/// The reason for the choice, a sentence without its full stop.
fn reason(found: &Recommendation, wish: Wish) -> String {
    let best = &found.best;
    let (left, acceptable) = (percent(best.worst_95), percent(wish.acceptable));
    let within = match wish.max_delay {
        delay if delay.is_finite() => format!(" within {delay} s of delay"),
        _ => String::new(),
    };
    let holds = best.worst_95 <= wish.acceptable;
    match found.reason {
        Reason::OnlyOne => format!("It is the only one{within}, and leaves up to {left}"),
        Reason::LeavesLeast if !holds => {
            format!("None{within} leaves at most {acceptable}. It leaves least, up to {left}")
        }
        Reason::ShorterAndAsGood(least) => {
            let name = least.shaper.name();
            format!("It leaves up to {left}, as little as {name}, which is longer")
        }
        Reason::LeavesLeast | Reason::ShortestAcceptable => {
            let shorter = shorter(found);
            format!("It is the shortest{within} that leaves at most {acceptable}: {left}{shorter}")
        }
    }
}

/// The residual of the shorter shapers that were eligible.
fn shorter(found: &Recommendation) -> String {
    let is_shorter =
        |one: &&Figures| one.standing == Standing::Eligible && one.delay < found.best.delay;
    let shorter = found.candidates.iter().filter(is_shorter);
    let least = shorter.map(|one| one.worst_95).min_by(f64::total_cmp);
    least.map_or(String::new(), |left| {
        format!("; the shorter ones leave {} or more", percent(left))
    })
}

/// The uncertainty that the residuals hold for, in words.
fn known(modes: &[ToldMode], wish: Wish) -> String {
    let is_told =
        |told: &ToldMode| told.natural_frequency_std.is_some() && told.damping_ratio_std.is_some();
    if modes.iter().all(is_told) {
        return "with 95 % probability, for the standard deviations of the modes".into();
    }
    let else_known = match modes.iter().any(is_told) {
        true => ", where nothing else is told with it",
        false => "",
    };
    format!(
        "for 95 % of the machines whose frequency is known to {} and damping ratio to {} \
         (one standard deviation{else_known})",
        percent(wish.frequency_std),
        wish.damping_std,
    )
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
