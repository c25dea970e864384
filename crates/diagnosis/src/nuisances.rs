//! What is fitted besides the effects: clocks, payloads, and the model's own parameters.

use super::bootstrap::Scatter;
use super::explanation::Explanation;
use super::point::Global;
use super::search::Search;
use std::collections::BTreeMap;

/// Confidence intervals of the model's free keys.
pub fn intervals_of_keys(
    search: &Search,
    best: &Explanation,
    scatter: &Scatter,
) -> BTreeMap<String, [f64; 2]> {
    let (problem, point) = (search.problem, &best.fitted.point);
    let interval = |key: &usize| {
        let ci95 = scatter.interval(problem, point, Global::Key(*key));
        let known = ci95.iter().all(|edge| edge.is_finite());
        known.then(|| (problem.kind.keys[*key].name.to_string(), ci95))
    };
    problem.free.iter().filter_map(interval).collect()
}

/// Their values, by name.
pub fn nuisances(search: &Search, explanation: &Explanation) -> BTreeMap<String, f64> {
    let mut all = BTreeMap::new();
    let point = &explanation.fitted.point;
    for (e, experiment) in search.problem.experiments.iter().enumerate() {
        let mark = if e == 0 {
            String::new()
        } else {
            format!("_{}", e + 1)
        };
        for (k, output) in experiment
            .outputs
            .iter()
            .enumerate()
            .filter(|(_, o)| o.own_clock)
        {
            let name = match k {
                0 => format!("clock_offset_s{mark}"),
                _ => format!("clock_offset_of_{}_s{mark}", output.channel.name()),
            };
            all.insert(name, point.locals[e].clocks[k]);
        }
    }
    for index in search.problem.free_payloads.clone() {
        let payload = search.problem.payloads[index].as_deref().unwrap_or("none");
        all.insert(
            format!("relative_inertia_with_payload {payload}"),
            point.inertias[index],
        );
    }
    for &key in &search.problem.free {
        all.insert(
            search.problem.kind.keys[key].name.to_string(),
            point.keys[key],
        );
    }
    all
}
