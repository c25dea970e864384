//! The coordinate that the missing part follows: a scatter plot, and the share that each coordinate explains.

use super::case::Case;
use super::shares::percentages;
use super::shown::{Shown, peak};
use super::words;
use quell_diagnosis::CoordinateTrace;
use quell_page::{Bars, Chart};

/// Most points of a scatter plot.
const POINTS: usize = 2000;
/// Number of stretches of a coordinate over which the missing force is averaged.
const STRETCHES: usize = 24;
/// Fewest samples of such an average.
const LEAST: usize = 4;

/// The missing force over the coordinate that it follows best, and its mean.
pub fn scatter(case: &Case) -> Option<Chart> {
    let trace = case
        .traces
        .coordinate
        .as_ref()
        .filter(|trace| !trace.x.is_empty())?;
    let unit = match trace.unit.as_str() {
        "" => &case.traces.missing_unit,
        unit => unit,
    };
    let missing = words::missing_name(unit);
    let (along, up) = (
        Shown::of(&trace.coordinate_unit, peak(&trace.x)),
        Shown::of(unit, peak(&trace.missing)),
    );
    let stride = trace.x.len().div_ceil(POINTS);
    let thin = |values: &[f64], shown: &Shown| -> Vec<f64> {
        values
            .iter()
            .step_by(stride)
            .map(|value| value * shown.factor)
            .collect()
    };
    let [x, low, mean, high] = averages(trace);
    let coordinate = words::plain(&trace.coordinate);
    let title = format!("The missing part over the {coordinate}");
    let chart = Chart::lines(
        title,
        coordinate,
        along.unit.clone(),
        words::short(missing),
        up.unit.clone(),
    )
    .points(missing, &thin(&trace.x, &along), &thin(&trace.missing, &up))
    .band(
        "mean",
        "± 1 standard deviation",
        &along.values(&x),
        &up.values(&low),
        &up.values(&high),
    )
    .series("mean", &along.values(&x), &up.values(&mean));
    Some(match stride {
        1 => chart,
        _ => chart.note(format!(
            "One sample in {stride} is drawn; the mean is over all."
        )),
    })
}

/// Non-empty stretches of equal width: coordinate, and the mean minus, without and plus one deviation.
fn averages(trace: &CoordinateTrace) -> [Vec<f64>; 4] {
    let pairs = trace.x.iter().copied().zip(trace.missing.iter().copied());
    let pairs: Vec<_> = pairs
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    let low = pairs
        .iter()
        .fold(f64::INFINITY, |low, pair| low.min(pair.0));
    let high = pairs
        .iter()
        .fold(f64::NEG_INFINITY, |high, pair| high.max(pair.0));
    let mut stretches = vec![Vec::new(); STRETCHES];
    for pair in pairs {
        let place = (pair.0 - low) / (high - low) * STRETCHES as f64;
        stretches[(place as usize).min(STRETCHES - 1)].push(pair);
    }
    let mut curves: [Vec<f64>; 4] = Default::default();
    for stretch in stretches.iter().filter(|stretch| stretch.len() >= LEAST) {
        let count = stretch.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| stretch.iter().map(of).sum::<f64>() / count;
        let (x, y) = (mean(&|pair| pair.0), mean(&|pair| pair.1));
        let std = mean(&|pair| (pair.1 - y).powi(2)).sqrt();
        let values = [x, y - std, y, y + std];
        curves
            .iter_mut()
            .zip(values)
            .for_each(|(curve, value)| curve.push(value));
    }
    curves
}

/// Share of the missing part that each coordinate explains.
pub fn explained(trace: &CoordinateTrace) -> Option<Bars> {
    let shares: Vec<_> = trace
        .explained
        .iter()
        .map(|(name, share)| (words::plain(name), *share))
        .collect();
    let best = words::plain(&trace.coordinate);
    let bars = percentages(
        "What it follows: share of the missing part that each coordinate explains",
        shares,
    )?;
    Some(
        bars.1
            .iter()
            .position(|name| *name == best)
            .into_iter()
            .fold(bars.0, Bars::marked),
    )
}
