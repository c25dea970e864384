//! The next move: an experiment that separates explanations which the recordings cannot.
//!
//! The distance `T` of the best explanation from each of its equals is taken on moves that the limits
//! seen in the recordings allow. Those whose least `T` is the largest are proposed.

mod advice;
mod contest;
mod distance;
mod ideas;
mod imagined;
mod information;
mod payload;
mod programme;
mod seen;
mod words;

use super::document::{NextMove, Verdict};
use super::explanation::Explanation;
use super::found::Found;
use super::point::EffectAt;
use super::problem::Problem;
use super::search::Search;
use super::stop::Stop;
use advice::advice;
use contest::Contest;
use distance::Rival;
use ideas::Ideas;
pub use information::Information;
use payload::Payload;
use quell_model::effects::Effect;
use rayon::prelude::*;

/// Chi-squared that separates: 10 is "very strong" evidence between models of as many unknowns (Kass and
/// Raftery, J. American Statistical Association 90 (1995)).
pub const SEPARATES: f64 = 10.0;
/// Chi-squared at which the diagnosis will decide: twice the logarithm of odds of 1000 to 1, doubled as a
/// margin for chance, since `T` scatters by `2 sqrt(T)`.
const ENOUGH: f64 = 30.0;
/// Number of equals that are considered, the nearest ones.
const RIVALS: usize = 3;

/// There was no time for the next move.
pub struct Late;

/// The next move; none where nothing is in doubt or nothing was explained.
///
/// # Errors
/// [`Late`] where it was not found before `enough`.
pub fn next_move(
    search: &Search,
    found: &Found,
    verdict: Verdict,
    enough: &Stop,
) -> Result<Option<NextMove>, Late> {
    let doubtful = matches!(verdict, Verdict::Ambiguous | Verdict::PartlyExplained);
    if !doubtful || found.equals.is_empty() {
        return Ok(None);
    }
    let problem = &Problem {
        stop: search.problem.stop.or(enough),
        ..search.problem.clone()
    };
    if problem.stop.now() {
        return Err(Late);
    }
    let next = between_equals(&Search { problem, ..*search }, found);
    match problem.stop.was_asked() {
        true => Err(Late),
        false => Ok(Some(next)),
    }
}

/// The move that tells the best explanation from its equals.
fn between_equals(search: &Search, found: &Found) -> NextMove {
    (search.progress)(0.9, "looking for the next move");
    let mut equals: Vec<&Explanation> = found.equals.iter().collect();
    equals.truncate(RIVALS);
    let pairs: Vec<Pair> = equals
        .iter()
        .map(|equal| Pair::new(&found.best, equal))
        .collect();
    let ideas = Ideas::new(search.problem);
    let contest = Contest {
        rivals: pairs
            .par_iter()
            .map(|pair| Rival::new(search.problem, pair.right, pair.wrong))
            .collect(),
        ideas: &ideas,
        unit: found.temperature,
    };
    let payload = Payload::HALF_MORE.changes(search.problem);
    propose(&contest, &pairs, payload)
}

/// The best explanation and one of its equals.
struct Pair<'a> {
    right: &'a super::point::Point,
    wrong: &'a super::point::Point,
    best: Vec<EffectAt>,
    equal: Vec<EffectAt>,
    /// Whether the equal is taken to be right.
    reversed: bool,
}

impl<'a> Pair<'a> {
    /// The best explanation is taken to be right. The exception: if the equal's law contains it as a limit, the
    /// equal could never fail, and is taken to be right instead.
    fn new(best: &'a Explanation, equal: &'a Explanation) -> Self {
        let [own, theirs] = words::apart(&best.effects(), &equal.effects());
        let holds = |law: &Effect, simple: &Effect| law.contains(simple) || law.becomes(simple);
        let limit = |simple: &&EffectAt| theirs.iter().any(|law| holds(law.0, simple.0));
        let reversed = !own.is_empty() && own.iter().filter(limit).count() == own.len();
        let points = [&best.fitted.point, &equal.fitted.point];
        let [right, wrong] = if reversed {
            [points[1], points[0]]
        } else {
            points
        };
        Self {
            right,
            wrong,
            best: own,
            equal: theirs,
            reversed,
        }
    }

    /// Names in files.
    fn names(&self) -> [String; 2] {
        words::called(&self.best, &self.equal, |effect| effect.name)
    }

    /// Names in sentences.
    fn titles(&self) -> [String; 2] {
        words::called(&self.best, &self.equal, |effect| effect.title)
    }

    fn remedy(&self) -> &'static str {
        advice(&self.best, &self.equal)
    }
}

fn propose(contest: &Contest, pairs: &[Pair], payload: bool) -> NextMove {
    let count = pairs.len();
    let plan = contest.plan(Payload::NONE, count);
    let idea = plan.and_then(|plan| contest.ideas.joined(&plan.ideas));
    let apart = idea
        .as_ref()
        .map_or(vec![0.0; count], |idea| contest.together(idea));
    let (parted, alike): (Vec<usize>, Vec<usize>) =
        (0..count).partition(|&k| apart[k] >= SEPARATES);
    let nearest = parted
        .into_iter()
        .min_by(|&a, &b| apart[a].total_cmp(&apart[b]));
    let (Some(idea), Some(nearest)) = (idea, nearest) else {
        return inseparable(contest, &pairs[0], apart[0], payload);
    };
    let pair = &pairs[nearest];
    let mut why = words::separates(&idea, &pair.titles(), apart[nearest], pair.reversed);
    for k in alike {
        why += &words::besides(&pairs[k].titles(), pairs[k].remedy());
    }
    NextMove {
        why,
        separates: pair.names(),
        expected_score: apart[nearest],
        moves: idea.moves,
    }
}

fn inseparable(contest: &Contest, pair: &Pair, score: f64, payload: bool) -> NextMove {
    let mut why = words::inseparable(&pair.titles(), score, pair.remedy());
    let plan = payload
        .then(|| contest.plan(Payload::HALF_MORE, 1))
        .flatten();
    if let Some(plan) = plan.filter(|plan| plan.apart[0] >= SEPARATES)
        && let Some(idea) = contest.ideas.joined(&plan.ideas)
    {
        why += &words::with_payload(&idea, plan.apart[0]);
    }
    NextMove {
        why,
        separates: pair.names(),
        expected_score: score,
        moves: Vec::new(),
    }
}
