//! Remarks for the reader of a diagnosis.

use super::figure::figure;
use super::found::Found;
use super::point::Point;
use super::problem::Problem;
use quell_recording::Recording;
use quell_recording::health::{JITTER, health};

/// Irregularities of the recordings, and how they were treated.
pub fn recorded(recordings: &[Recording]) -> Vec<String> {
    let mut remarks = Vec::new();
    for recording in recordings {
        for channel in &recording.channels {
            let (name, of) = (channel.role, &recording.name);
            let health = health(channel);
            let clock = &health.clock;
            if channel.role.is_input() && !channel.varies() {
                remarks.push(format!(
                    "{name} of \"{of}\" stays at one value throughout: if the machine was moved, its sensor is dead \
                     or the column is wrong."
                ));
            }
            let mut irregular = Vec::new();
            if !clock.gaps.is_empty() {
                let gaps = clock.gaps.len();
                irregular.push(format!(
                    "{} missing samples in {gaps} gap(s)",
                    clock.missing
                ));
            }
            if clock.jitter > JITTER * clock.period {
                let jitter = 100.0 * clock.jitter / clock.period;
                irregular.push(format!("the clock jitters by {jitter:.1} % of its period"));
            }
            if !irregular.is_empty() {
                remarks.push(format!(
                    "{name} of \"{of}\": {}. Each sample was used at its own stamp, and none was made up.",
                    irregular.join(", ")
                ));
            }
            let wraps: usize = health.columns.iter().map(|column| column.wraps.len()).sum();
            if wraps > 0 {
                remarks.push(format!(
                    "{name} of \"{of}\": the angle jumped by a turn {wraps} time(s), and was unwrapped."
                ));
            }
        }
    }
    remarks
}

/// What was fitted of the outputs themselves: gains, directions.
pub fn of_outputs(problem: &Problem, found: &Found) -> Vec<String> {
    let mut remarks = gains(problem, &found.best.fitted.point);
    remarks.extend(directions(problem));
    remarks.extend(walk(problem));
    remarks.extend(smoothed(problem));
    remarks
}

/// The noise of a force with the error of the smoothed position, where that is the larger part; of the first recording.
fn smoothed(problem: &Problem) -> Option<String> {
    problem.experiments[0].input_smoothed.as_ref()?;
    let (own, both) = (&problem.sensor_noise[0], &problem.noise[0]);
    let output = problem.experiments[0].outputs.first()?;
    let (own, both) = (own.first()?.deviation, both.first()?.deviation);
    (both > 2f64.sqrt() * own).then(|| {
        format!(
            "The acceleration is that of a smoothed {}. What the smoother may leave out counts as noise of {}: {}, of which its \
             sensor has {}. Smoother moves, a finer encoder or a faster clock lower it.",
            problem.experiments[0].input,
            output.channel,
            figure(both, &output.unit),
            figure(own, &output.unit)
        )
    })
}

/// The largest noise of a velocity that was integrated, at the end of its recording; `None` where it shows none.
fn walk(problem: &Problem) -> Option<String> {
    let walks = problem.experiments.iter().filter_map(|own| {
        let steps = own.input_values.len() as f64;
        let step = own.input_walk.filter(|step| *step > 0.0)?;
        Some((step * steps.sqrt(), own))
    });
    let (most, own) = walks.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "The motor side's position is the integral of motor_velocity: its noise adds up to {most:.2e} {}, and its zero was \
         fitted. A slow error cannot be told from that: record motor_position.",
        own.position_unit
    ))
}

/// Fitted values of the model: effects of the given model that the recording does not need, payloads, keys at the ends of
/// their ranges. They mean nothing where the recording does not determine the model.
pub fn of_fit(problem: &Problem, found: &Found) -> Vec<String> {
    let mut remarks = Vec::new();
    let point = &found.best.fitted.point;
    for term in &point.terms[..point.given_terms] {
        if term.effect.is_negligible(&term.values, &problem.scales) {
            remarks.push(format!(
                "{} in the {}, which the model has, went to nothing: the recording does not need it.",
                term.effect.name,
                term.place.name()
            ));
        }
    }
    for index in problem.free_payloads.clone() {
        let named = |index: usize| problem.payloads[index].as_deref().unwrap_or("none");
        remarks.push(format!(
            "With the payload \"{}\" the link's inertia is {:.3} times that with \"{}\".",
            named(index),
            point.inertias[index],
            named(0)
        ));
    }
    for key in problem.at_their_ends(point) {
        let (low, high) = problem.bounds[key];
        let (name, value) = (problem.kind.keys[key].name, point.keys[key]);
        remarks.push(format!(
            "{name} = {value:.4} is at the end of what is believed of it ({low:.4} to {high:.4}): is the \
             nominal value right?"
        ));
    }
    remarks
}

impl Problem<'_> {
    /// Free keys of the model that are at the ends of their ranges, within a thousandth of these.
    pub fn at_their_ends(&self, point: &Point) -> impl Iterator<Item = usize> {
        let is_at_end = |key: &usize| {
            let ((low, high), value) = (self.bounds[*key], point.keys[*key]);
            let near = 1e-3 * (high - low);
            value - low < near || high - value < near
        };
        self.free.iter().copied().filter(is_at_end)
    }
}

/// How accelerometers of several columns are mounted.
fn directions(problem: &Problem) -> Vec<String> {
    let outputs = problem.experiments.iter().flat_map(|own| &own.outputs);
    let several = outputs.filter(|output| !output.direction.is_empty());
    let told = several.map(|output| {
        let shares: Vec<String> = output.direction.iter().map(|x| format!("{x:.3}")).collect();
        format!(
            "Of the columns of {} the reading along ({}) was used: the direction of the tip's motion, as the motion shows it.",
            output.channel,
            shares.join(", ")
        )
    });
    told.collect()
}

/// Fitted values of gains that were not known.
fn gains(problem: &Problem, point: &Point) -> Vec<String> {
    let mut told = Vec::new();
    for (e, experiment) in problem.experiments.iter().enumerate() {
        if experiment.outputs.iter().all(|own| own.gain.is_none()) {
            continue;
        }
        let rows = problem.complete(e, &problem.run(point, e).residuals);
        let mut coefficients = problem.coefficients(e, &rows).into_iter();
        for output in &experiment.outputs {
            let own = coefficients.by_ref().take(output.columns.len());
            let (Some(gain), Some(last)) = (&output.gain, own.last()) else {
                continue;
            };
            told.push(format!(
                "The scale of {} is unknown, and was fitted: it shows {:.5} {} for one {} of the motor side. An error \
                 of its gain cannot be told.",
                output.channel,
                gain.value * (1.0 + last),
                gain.unit,
                gain.of
            ));
        }
    }
    told
}
