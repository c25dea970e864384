//! The recommended shaper, with the reason in a sentence.

use quell_shapers::{
    Criterion, Mode, Reason, Recommendation, Requirements, Shaper, ShaperError, UncertainMode,
    recommend,
};

/// The 5 % at which insensitivity is told, to its own digit: EI touches it by design, and any doubt
/// about the damping lifts it by a tenth or so.
const ACCEPTABLE: f64 = 0.055;

/// What is asked of the shaper.
#[derive(Clone, Copy)]
pub struct Wish {
    /// One standard deviation of the frequency over the frequency.
    pub frequency_std: f64,
    /// One standard deviation of the damping ratio.
    pub damping_std: f64,
    /// The longest delay, s.
    pub max_delay: Option<f64>,
}

/// The recommended shaper.
pub struct Choice {
    /// The shaper.
    pub shaper: &'static dyn Shaper,
    /// Why, in a sentence.
    pub reason: String,
    /// What it adds to the end of a move, s.
    pub delay: f64,
    /// What it leaves at most for 95 % of the modes that are meant.
    pub worst: f64,
}

/// The shortest shaper that leaves at most 5 % for 95 % of the modes that are meant; where none does,
/// the one that leaves least. `None` where no shaper is within the delay.
///
/// Shapers with negative amplitudes are left out: they can exceed the limits of a move.
pub fn choose(modes: &[Mode], wish: Wish) -> Result<Option<Choice>, ShaperError> {
    let estimates: Vec<UncertainMode> = modes
        .iter()
        .map(|&mode| UncertainMode {
            mode,
            natural_frequency_std: wish.frequency_std * mode.natural_frequency(),
            damping_ratio_std: wish.damping_std,
        })
        .collect();
    let requirements = Requirements {
        longest_delay: wish.max_delay.unwrap_or(f64::INFINITY),
        criterion: Criterion::Worst95,
        acceptable: ACCEPTABLE,
        tolerance: 0.0,
        allow_negative: false,
    };
    match recommend(&estimates, &requirements) {
        Ok(found) => Ok(Some(Choice {
            shaper: found.best.shaper,
            reason: sentence(&found, wish),
            delay: found.best.delay,
            worst: found.best.worst_95,
        })),
        Err(ShaperError::NoneFits { .. }) => Ok(None),
        Err(error) => Err(error),
    }
}

fn sentence(found: &Recommendation, wish: Wish) -> String {
    let best = &found.best;
    let within = wish
        .max_delay
        .map_or(String::new(), |delay| format!(" within {delay} s of delay"));
    let meant = format!(
        "for 95 % of the modes meant (frequency to {}, damping to {}, one standard deviation)",
        percent(wish.frequency_std),
        wish.damping_std
    );
    let why = match found.reason {
        _ if best.worst_95 > ACCEPTABLE => {
            let left = percent(best.worst_95);
            format!("none leaves at most 5 %{within} {meant}; it leaves least, up to {left}")
        }
        Reason::OnlyOne => format!("the only one{within}; it leaves {}", percent(best.worst_95)),
        _ => format!(
            "the shortest{within} that leaves at most 5 % {meant} ({}{})",
            percent(best.worst_95),
            shorter(found)
        ),
    };
    format!(
        "{}, which adds {:.3} s: {why}.",
        best.shaper.name(),
        best.delay
    )
}

/// What the shorter ones leave, of those that could have been chosen.
fn shorter(found: &Recommendation) -> String {
    let left = found
        .candidates
        .iter()
        .filter(|candidate| candidate.shaper.is_convex() && candidate.delay < found.best.delay)
        .map(|candidate| candidate.worst_95)
        .min_by(f64::total_cmp);
    left.map_or(String::new(), |left| {
        format!("; the shorter ones leave {} or more", percent(left))
    })
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
