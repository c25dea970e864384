//! What the reader of a diagnosis should know besides the verdict.

use super::problem::Problem;
use super::search::Found;

/// Keys at their bounds, and what a clock suggests.
pub fn remarks(problem: &Problem, found: &Found) -> Vec<String> {
    let mut remarks = Vec::new();
    let point = &found.best.fitted.point;
    for &key in &problem.free {
        let (low, high) = problem.bounds[key];
        let (name, value) = (problem.kind.keys[key].name, point.keys[key]);
        // Within a thousandth of the range.
        let near = 1e-3 * (high - low);
        if value - low < near || high - value < near {
            remarks.push(format!(
                "{name} = {value:.4} is at the end of what is believed of it ({low:.4} to {high:.4}): is the \
                 nominal value right?"
            ));
        }
    }
    remarks
}
