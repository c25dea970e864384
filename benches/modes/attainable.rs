//! What a train can leave at best, of an arm that is known in full.

use super::plant::{Plant, PlantMode};
use super::programme::{PERIOD, Programme, plan};
use quell_shapers::{GridTrain, Mode, Setpoint, ShapingFilter, shaper_by_name};
use quell_trajectories::SampledTrajectory;

/// Rules that are tried for each mode.
const RULES: [&str; 6] = ["zv", "zvd", "ei", "zvdd", "ei2", "ei3"];
/// Factors of all frequencies, in steps of 2.5 %: a gap makes a mode slower.
const FACTORS: std::ops::RangeInclusive<i32> = -16..=6;
/// The motor side has followed from here on, rad.
const FOLLOWED: f64 = 1e-6;
/// Periods of the belief after a move, as the programmes wait.
const WATCHED: f64 = 12.0;

/// Periods of the slowest mode that the longest learned trains last.
const SHORT: f64 = 2.02;

/// What a move left.
#[derive(Clone, Copy, Debug, Default)]
struct Ended {
    /// The largest deformation, rad.
    peak: f64,
    /// Length of the train, s, and in periods of the slowest mode.
    delay: f64,
    periods: f64,
}

/// Root of the mean square.
fn size(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, n), x| (sum + x * x, n + 1.0));
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// One rule with one factor of the frequencies.
#[derive(Clone, Copy, Debug)]
struct Candidate(&'static str, f64);

/// What candidates leave of a programme.
pub struct Attainable {
    /// The least of all candidates, for each move.
    per_move: Vec<Ended>,
    /// The candidate that is best over all moves.
    one_rule: Vec<Ended>,
    rule: Candidate,
}

impl Attainable {
    /// Both over `base`, rad, and the rule.
    pub fn over(&self, base: f64) -> String {
        let of = |ended: &[Ended]| size(ended.iter().map(|left| left.peak)) / base;
        let length = size(self.one_rule.iter().map(|left| left.delay));
        let Candidate(rule, factor) = self.rule;
        let (one, each) = (of(&self.one_rule), of(&self.per_move));
        format!("one rule {one:.3} ({rule} x {factor:.3}, {length:.3} s), each move {each:.3}")
    }
}

fn candidates() -> Vec<Candidate> {
    let factors = || FACTORS.map(|k| 1.0 + 0.025 * f64::from(k));
    RULES
        .iter()
        .flat_map(|rule| factors().map(|factor| Candidate(rule, factor)))
        .collect()
}

impl Candidate {
    /// The train for all modes where the move ends.
    fn train(&self, modes: &[PlantMode], at: f64, payload: f64) -> Option<GridTrain> {
        let rule = shaper_by_name(self.0)?;
        let mut train: Option<GridTrain> = None;
        for mode in modes {
            let omega = self.1 * mode.frequency(at, payload);
            let mode = Mode::new(omega, mode.damping).ok()?;
            let own = rule.on_grid(mode, PERIOD).ok()?;
            train = Some(match train {
                Some(train) => train.convolve(&own).ok()?,
                None => own,
            });
        }
        train
    }
}

/// One move with a train, and the arm after it.
fn moved(
    programme: &Programme,
    before: &Plant,
    plan: &SampledTrajectory,
    train: &GridTrain,
) -> (Ended, Plant) {
    let mut plant = before.clone();
    let mut filter = ShapingFilter::new(PERIOD, train.duration_in_ticks() + 2);
    let (positions, velocities) = (plan.positions(0), plan.velocities(0));
    filter.reset(positions[0]);
    filter.install(train).expect("a train at rest");
    let last = positions.len() - 1;
    let quiet = (WATCHED / programme.belief_hz / PERIOD) as usize;
    let mut trace = Vec::new();
    for k in 0..=last + train.duration_in_ticks() + quiet {
        let k = k.min(last);
        let sent = filter.step(Setpoint {
            position: positions[k],
            velocity: velocities[k],
            acceleration: 0.0,
        });
        plant.step(sent.position, sent.velocity);
        trace.push((plant.motor(), plant.deformation()));
    }
    let away = |(motor, _): &(f64, f64)| (motor - positions[last]).abs() > FOLLOWED;
    let end = trace.iter().rposition(away).map_or(0, |last| last + 1);
    let seen = trace[end..].iter().map(|one| one.1);
    let peak = seen.fold(0.0, |peak, x| f64::max(peak, x.abs()));
    let slowest = programme
        .modes
        .iter()
        .map(|mode| mode.frequency(positions[last], plant.payload));
    let slowest = slowest.fold(f64::INFINITY, f64::min);
    let ended = Ended {
        peak,
        delay: train.duration(),
        periods: train.duration() * slowest / std::f64::consts::TAU,
    };
    (ended, plant)
}

/// One candidate in all moves.
fn all_moves(programme: &Programme, candidate: Candidate) -> Option<Vec<Ended>> {
    let mut plant = Plant::new(
        &programme.modes,
        programme.faults,
        PERIOD,
        programme.start,
        programme.seed,
    );
    let mut from = programme.start;
    let mut ended = Vec::new();
    for (target, payload) in &programme.moves {
        plant.payload = *payload;
        let train = candidate.train(&programme.modes, *target, *payload)?;
        let (left, after) = moved(programme, &plant, &plan(from, *target), &train);
        (plant, from) = (after, *target);
        ended.push(left);
    }
    Some(ended)
}

/// All candidates, and those that last at most so many periods of the slowest mode.
pub fn attainable(programme: &Programme) -> [Attainable; 2] {
    let all: Vec<(Candidate, Vec<Ended>)> = candidates()
        .into_iter()
        .filter_map(|candidate| Some((candidate, all_moves(programme, candidate)?)))
        .collect();
    [SHORT, f64::INFINITY].map(|periods| best_of(programme, &all, periods))
}

fn best_of(programme: &Programme, all: &[(Candidate, Vec<Ended>)], periods: f64) -> Attainable {
    let by = |one: &&(Candidate, Vec<Ended>)| size(one.1.iter().map(|left| left.peak));
    let short = |left: &Ended| left.periods <= periods;
    let allowed = all.iter().filter(|one| one.1.iter().all(short));
    let best = allowed
        .min_by(|a, b| by(a).total_cmp(&by(b)))
        .expect("a candidate");
    let least = |k: usize| {
        let of_move = all.iter().map(|one| one.1[k]).filter(short);
        of_move
            .min_by(|a, b| a.peak.total_cmp(&b.peak))
            .expect("a candidate")
    };
    Attainable {
        per_move: (0..programme.moves.len()).map(least).collect(),
        one_rule: best.1.clone(),
        rule: best.0,
    }
}
