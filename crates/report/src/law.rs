//! The static law of a finding: in words, and as a picture.

use super::case::Case;
use super::shown::{Shown, peak};
use super::words;
use quell_diagnosis::{Finding, LawCurve, NearestLaw};
use quell_page::{Chart, Page};

/// Legend of the data behind a law.
const SEEN: &str = "what the recording says without it";

/// Known properties of a learned law: its shape, the nearest named law, and its range. Empty for a named law.
pub fn lines(case: &Case, finding: &Finding) -> Vec<String> {
    let (Some(curve), Some(learned)) = (&finding.curve, finding.learned()) else {
        return Vec::new();
    };
    let nearest = learned.nearest.as_ref();
    let nearest = nearest.map(|nearest| closest(case, curve, nearest));
    let said = [Some(learned.sentence.clone()), nearest, range(curve)];
    said.into_iter().flatten().collect()
}

/// The text on a learned law, and the picture of any law.
pub fn section(page: Page, case: &Case, finding: &Finding) -> Page {
    let page = match lines(case, finding) {
        lines if lines.is_empty() => page,
        lines => page.text(lines.join(" ")),
    };
    let chart = finding.curve.as_ref();
    let chart = chart.filter(|curve| !curve.points.is_empty());
    let chart = chart.map(|curve| picture(case, finding, curve));
    chart.into_iter().fold(page, Page::chart)
}

/// The units of coordinate and law.
fn shown(curve: &LawCurve) -> [Shown; 2] {
    [
        Shown::of(&curve.coordinate_unit, peak(&curve.points)),
        law_unit(curve),
    ]
}

/// The unit of the law.
pub fn law_unit(curve: &LawCurve) -> Shown {
    Shown::of(&curve.unit, peak(&curve.values))
}

fn closest(case: &Case, curve: &LawCurve, nearest: &NearestLaw) -> String {
    let name = case.title(&nearest.effect);
    let values: Vec<String> = nearest
        .parameters
        .iter()
        .map(|own| {
            let shown = Shown::of(&own.unit, own.value);
            let name = case.parameter_of(&nearest.effect, &own.name);
            format!("{name} {}", with_unit(shown.number(own.value), &shown))
        })
        .collect();
    let values = words::list(&values, "and");
    if nearest.is_inside() {
        return format!(
            "It is like {name} ({values}), the nearest named law, which stays inside its 95 % band."
        );
    }
    let [along, _] = shown(curve);
    let ranges: Vec<String> = nearest
        .outside
        .iter()
        .map(|[from, to]| match from == to {
            true => format!("at {}", along.number(*from)),
            false => format!("from {} to {}", along.number(*from), along.number(*to)),
        })
        .collect();
    let ranges = with_unit(words::list(&ranges, "and"), &along);
    format!(
        "No named law stays inside its 95 % band: the nearest, {name} ({values}), leaves it {ranges}."
    )
}

fn range(curve: &LawCurve) -> Option<String> {
    let (from, to) = (curve.points.first()?, curve.points.last()?);
    let [along, _] = shown(curve);
    let to = with_unit(along.number(*to), &along);
    Some(format!(
        "It was learned where the {} is {} to {to}; nothing is claimed outside of that.",
        curve.coordinate,
        along.number(*from),
    ))
}

fn with_unit(number: String, shown: &Shown) -> String {
    match shown.unit.as_str() {
        "" => number,
        unit => format!("{number} {unit}"),
    }
}

fn picture(case: &Case, finding: &Finding, curve: &LawCurve) -> Chart {
    let [along, up] = shown(curve);
    let name = case.title(&finding.effect);
    let x = along.values(&curve.points);
    let edge = |edge: usize| -> Vec<f64> {
        let values = curve.ci95.iter().map(|band| band[edge] * up.factor);
        values.collect()
    };
    let within = curve.points[0]..=curve.points[curve.points.len() - 1];
    let seen = |axis: usize, factor: f64| -> Vec<f64> {
        let points = curve.seen.iter().filter(|point| within.contains(&point[0]));
        points.map(|point| point[axis] * factor).collect()
    };
    let title = format!(
        "{}: {} over the {}",
        words::capital(&name),
        curve.law,
        curve.coordinate
    );
    let axes = [along.unit.clone(), up.unit.clone()];
    let [x_unit, y_unit] = axes;
    let chart = Chart::lines(
        title,
        curve.coordinate.clone(),
        x_unit,
        curve.law.clone(),
        y_unit,
    );
    let chart = match seen(0, along.factor) {
        none if none.is_empty() => chart,
        points => chart.points(SEEN, &points, &seen(1, up.factor)),
    };
    let chart = chart
        .band(&name, "95 % band", &x, &edge(0), &edge(1))
        .series(&name, &x, &up.values(&curve.values));
    let nearest = finding
        .learned()
        .and_then(|learned| learned.nearest.as_ref());
    let chart = match nearest {
        Some(nearest) => {
            let name = format!("nearest named law: {}", case.title(&nearest.effect));
            chart.series(name, &x, &up.values(&nearest.values))
        }
        None => chart,
    };
    let read = match finding.learned() {
        Some(_) => {
            "Drawn where it was learned. What the model's own parameters can take up as well makes the band \
                    wide."
        }
        None => "What the law adds to the model, where the motion was.",
    };
    let told = case.force_of_law_told(finding);
    let words: Vec<_> = [read].into_iter().chain(told).collect();
    chart.note(words.join(" "))
}
