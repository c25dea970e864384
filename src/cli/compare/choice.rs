//! The recommended shaper, with the reason in a sentence.

use super::candidate::{Candidate, Design, TOLERANCE};
use quell_shapers::Shaper;
use std::cmp::Ordering;

/// Errors up to this many standard deviations are to be covered: 95 % of a Gaussian's.
const DEVIATIONS: f64 = 2.0;
/// A worst value this little above the tolerance is rounding: shapers touch it by design.
const TOUCHING: f64 = 1e-9;

/// What is asked of the shaper.
#[derive(Clone, Copy)]
pub struct Wish {
    /// One standard deviation of the frequency over the frequency.
    pub frequency_std: f64,
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
    /// Its greatest residual vibration over the errors to be covered.
    pub worst: f64,
}

/// One candidate that may be chosen.
struct Entry<'a> {
    shaper: &'static dyn Shaper,
    design: &'a Design,
    worst: f64,
}

/// The shortest shaper that leaves at most 5 % over two standard deviations of frequency; where
/// none does, the one that leaves least. Shapers with negative amplitudes are left out, since they
/// can exceed the limits of the move, and so are those above the delay that is allowed.
pub fn choose(candidates: &[Candidate], wish: Wish) -> Option<Choice> {
    let entries = entries(candidates, wish);
    let holds = |entry: &&Entry| entry.worst <= TOLERANCE + TOUCHING;
    let within = match wish.max_delay {
        Some(delay) => format!(" within {delay} s of delay"),
        None => String::new(),
    };
    let range = format!(
        "frequency errors of +-{}",
        percent(DEVIATIONS * wish.frequency_std)
    );
    let (best, reason) = match entries.iter().filter(holds).min_by(|a, b| a.order(b)) {
        Some(best) => {
            let shorter = entries.iter().filter(|entry| entry.order(best).is_lt());
            let left = shorter.map(|entry| entry.worst).min_by(f64::total_cmp);
            let left =
                left.map(|left| format!("; the shorter ones leave {} or more", percent(left)));
            let reason = format!("the shortest{within} that leaves at most 5.0 % over {range}");
            (
                best,
                format!(
                    "{reason} ({}{})",
                    percent(best.worst),
                    left.unwrap_or_default()
                ),
            )
        }
        None => {
            let best = entries.iter().min_by(|a, b| a.worst.total_cmp(&b.worst))?;
            let left = percent(best.worst);
            let reason = format!("none leaves at most 5.0 %{within} over {range}; it leaves least");
            (best, format!("{reason}, up to {left}"))
        }
    };
    let delay = best.design.train.duration();
    let reason = format!("{}, which adds {delay:.3} s: {reason}.", best.shaper.name());
    Some(Choice {
        shaper: best.shaper,
        reason,
        delay,
        worst: best.worst,
    })
}

/// The candidates that may be chosen.
fn entries(candidates: &[Candidate], wish: Wish) -> Vec<Entry<'_>> {
    let allowed = wish.max_delay.unwrap_or(f64::INFINITY);
    let mut entries = Vec::new();
    for Candidate { shaper, design } in candidates {
        if let (true, Ok(design)) = (shaper.is_convex(), design)
            && design.train.duration() <= allowed
        {
            let worst = design.worst(DEVIATIONS * wish.frequency_std);
            entries.push(Entry {
                shaper: *shaper,
                design,
                worst,
            });
        }
    }
    entries
}

impl Entry<'_> {
    /// By duration; of equally long ones the one that leaves less comes first.
    fn order(&self, other: &Self) -> Ordering {
        let ticks = |entry: &Self| entry.design.train.duration_in_ticks();
        ticks(self)
            .cmp(&ticks(other))
            .then(self.worst.total_cmp(&other.worst))
    }
}

fn percent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}
