//! The next move: what would tell explanations apart that the recordings cannot.
//!
//! Of the best explanation `A` and each of its equals `B` the distance `T` is taken on experiments that
//! the limits seen in the recordings allow. The one whose least `T` is the largest is proposed.

mod advice;
mod contest;
mod distance;
mod ideas;
mod imagined;
mod payload;
mod programme;
mod seen;
mod words;

use super::document::{NextMove, Verdict};
use super::explanation::Explanation;
use super::search::{Found, Search};
use crate::effects::Place;
use crate::model::Experiment;
use advice::advice;
use contest::Contest;
use distance::{Rival, as_explained};
use ideas::ideas;
use payload::Payload;
use rayon::prelude::*;

/// Chi-squared that separates: 10 is "very strong" evidence between models of as many unknowns (Kass and
/// Raftery, J. American Statistical Association 90 (1995)).
pub const SEPARATES: f64 = 10.0;
/// Equals that are looked at, the nearest ones.
const RIVALS: usize = 3;
/// What to do next; none where nothing is in doubt or nothing was explained.
pub fn next_move(search: &Search, found: &Found, verdict: Verdict) -> Option<NextMove> {
    let doubtful = matches!(verdict, Verdict::Ambiguous | Verdict::PartlyExplained);
    if !doubtful || found.equals.is_empty() {
        return None;
    }
    (search.progress)(0.9, "looking for the next move");
    let (problem, best) = (search.problem, &found.best.fitted.point);
    let explained: Vec<Experiment> = (problem.experiments.iter().zip(&best.locals))
        .map(|(e, local)| imagined::explained(problem.kind, best, e, local))
        .collect();
    let recordings = as_explained(problem, &explained);
    let mut equals: Vec<&Explanation> = found.equals.iter().map(|t| &t.explanation).collect();
    equals.sort_by(|a, b| search.criterion(a).total_cmp(&search.criterion(b)));
    equals.truncate(RIVALS);
    let ideas = ideas(problem);
    let rivals = equals.par_iter();
    let contest = Contest {
        problem: &recordings,
        best,
        rivals: rivals
            .map(|equal| Rival::new(&recordings, &equal.fitted.point))
            .collect(),
        ideas: &ideas,
        unit: found.unit,
    };
    let pairs = Pairs {
        own: found.best.effects(),
        theirs: equals.iter().map(|equal| equal.effects()).collect(),
    };
    Some(propose(&contest, &pairs))
}

/// Effects of the best explanation and of its equals.
struct Pairs {
    own: Vec<(&'static str, Place)>,
    theirs: Vec<Vec<(&'static str, Place)>>,
}

impl Pairs {
    fn names(&self, rival: usize) -> [String; 2] {
        words::names(&self.own, &self.theirs[rival])
    }

    fn remedy(&self, rival: usize) -> &'static str {
        advice(&self.own, &self.theirs[rival])
    }
}

fn propose(contest: &Contest, pairs: &Pairs) -> NextMove {
    let count = contest.rivals.len();
    let idea = contest.winner(Payload::NONE, count).map(|winner| winner.0);
    let apart = idea.map_or(vec![0.0; count], |idea| contest.together(idea));
    let (parted, alike): (Vec<usize>, Vec<usize>) =
        (0..count).partition(|&k| apart[k] >= SEPARATES);
    let nearest = parted
        .into_iter()
        .min_by(|&a, &b| apart[a].total_cmp(&apart[b]));
    let (Some(idea), Some(nearest)) = (idea, nearest) else {
        return inseparable(contest, pairs, apart[0]);
    };
    let names = pairs.names(nearest);
    let mut why = words::separates(idea, &names, apart[nearest]);
    for k in alike {
        why += &words::besides(&pairs.names(k), pairs.remedy(k));
    }
    NextMove {
        why,
        separates: names,
        expected_score: apart[nearest],
        moves: idea.moves.clone(),
    }
}

fn inseparable(contest: &Contest, pairs: &Pairs, score: f64) -> NextMove {
    let names = pairs.names(0);
    let mut why = words::inseparable(&names, score, pairs.remedy(0));
    if Payload::HALF_MORE.changes(contest.problem)
        && let Some((idea, apart)) = contest.winner(Payload::HALF_MORE, 1)
        && apart[0] >= SEPARATES
    {
        why += &words::with_payload(idea, apart[0]);
    }
    NextMove {
        why,
        separates: names,
        expected_score: score,
        moves: Vec::new(),
    }
}
