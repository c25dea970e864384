//! Charts: curves over a common abscissa, and impulse trains.

use super::html::{json_number, json_string};
use super::prose::prose;
use super::series::{Axis, Series};
use super::thin::STRETCHES;
use maud::{Markup, html};

/// Curves, points and bands over one abscissa, or impulse trains; with lines at given places.
///
/// The page shows it with zoom (drag), cursor values and a legend that hides curves. Charts of the
/// same abscissa (name and unit) share the cursor.
#[derive(Clone, Debug, PartialEq)]
pub struct Chart {
    title: String,
    kind: &'static str,
    x: Axis,
    y: Axis,
    series: Vec<Series>,
    markers: Vec<Line>,
    levels: Vec<Line>,
    shades: Vec<Shade>,
    note: Option<String>,
}

/// A shaded stretch of the abscissa or, `upright`, of the ordinate.
#[derive(Clone, Debug, PartialEq)]
struct Shade {
    from: f64,
    to: f64,
    label: String,
    upright: bool,
}

#[derive(Clone, Debug, PartialEq)]
struct Line {
    at: f64,
    label: String,
}

impl Chart {
    /// Curves over an abscissa; each quantity with its unit ("" if it has none).
    pub fn lines(
        title: impl Into<String>,
        x_name: impl Into<String>,
        x_unit: impl Into<String>,
        y_name: impl Into<String>,
        y_unit: impl Into<String>,
    ) -> Self {
        let axis = |name, unit| Axis {
            name,
            unit,
            logarithmic: false,
            range: None,
        };
        Self {
            title: title.into(),
            kind: "lines",
            x: axis(x_name.into(), x_unit.into()),
            y: axis(y_name.into(), y_unit.into()),
            series: Vec::new(),
            markers: Vec::new(),
            levels: Vec::new(),
            shades: Vec::new(),
            note: None,
        }
    }

    /// Impulse trains: a stem from zero for each impulse, the trains side by side.
    pub fn stems(
        title: impl Into<String>,
        x_name: impl Into<String>,
        x_unit: impl Into<String>,
        y_name: impl Into<String>,
        y_unit: impl Into<String>,
    ) -> Self {
        Self {
            kind: "stems",
            ..Self::lines(title, x_name, x_unit, y_name, y_unit)
        }
    }

    /// A curve (or a train). `x` and `y` are of one length (else the longer one is cut); a `y` that
    /// is not finite interrupts the curve, an `x` that is not finite is left out.
    pub fn series(self, name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        self.push(name.into(), "line", x, y, &[])
    }

    /// A broad pale curve, so that curves which are added after it and lie on it are seen.
    pub fn broad(self, name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        self.push(name.into(), "broad", x, y, &[])
    }

    /// Points that no line connects.
    pub fn points(self, name: impl Into<String>, x: &[f64], y: &[f64]) -> Self {
        self.push(name.into(), "points", x, y, &[])
    }

    /// The area between `low` and `high` around a curve, in the curve's colour, as of a standard
    /// deviation; `words` say what it is. Drawn below the curves that are added after it.
    pub fn band(
        self,
        curve: impl Into<String>,
        words: &str,
        x: &[f64],
        low: &[f64],
        high: &[f64],
    ) -> Self {
        let mut chart = self.push(curve.into(), "band", x, high, low);
        if let Some(band) = chart.series.last_mut() {
            band.label = format!("{} {words}", band.name);
        }
        chart
    }

    /// A vertical dashed line at `x` with a few words.
    pub fn marker(mut self, x: f64, label: impl Into<String>) -> Self {
        self.markers.push(Line {
            at: x,
            label: label.into(),
        });
        self
    }

    /// A horizontal dashed line at `y` with a few words.
    pub fn level(mut self, y: f64, label: impl Into<String>) -> Self {
        self.levels.push(Line {
            at: y,
            label: label.into(),
        });
        self
    }

    /// Shades the abscissa from `from` to `to` over the whole height, with a few words ("" for none).
    pub fn shade_x(mut self, from: f64, to: f64, label: impl Into<String>) -> Self {
        self.shades.push(Shade {
            from,
            to,
            label: label.into(),
            upright: false,
        });
        self
    }

    /// Shades the ordinate from `from` to `to` over the whole width, with a few words.
    pub fn shade_y(self, from: f64, to: f64, label: impl Into<String>) -> Self {
        let mut chart = self.shade_x(from, to, label);
        if let Some(shade) = chart.shades.last_mut() {
            shade.upright = true;
        }
        chart
    }

    /// A logarithmic abscissa; what is not above 0 is left out.
    pub fn x_log(mut self) -> Self {
        self.x.logarithmic = true;
        self
    }

    /// A logarithmic ordinate; what is not above 0 interrupts the curve.
    pub fn y_log(mut self) -> Self {
        self.y.logarithmic = true;
        self
    }

    /// The part of the abscissa to show first; the reader may zoom.
    pub fn x_range(mut self, from: f64, to: f64) -> Self {
        self.x.range = Some((from, to));
        self
    }

    /// The part of the ordinate to show.
    pub fn y_range(mut self, from: f64, to: f64) -> Self {
        self.y.range = Some((from, to));
        self
    }

    /// A sentence below the chart: what to see in it.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(note.into());
        self
    }

    fn push(mut self, name: String, kind: &'static str, x: &[f64], y: &[f64], low: &[f64]) -> Self {
        let mut order: Vec<_> = (0..x.len().min(y.len()))
            .filter(|&i| x[i].is_finite())
            .collect();
        order.sort_by(|&a, &b| x[a].total_cmp(&x[b]));
        let pick = |values: &[f64]| {
            order
                .iter()
                .map(|&i| values.get(i).copied().unwrap_or(f64::NAN))
                .collect()
        };
        let low = if kind == "band" {
            pick(low)
        } else {
            Vec::new()
        };
        let (x, y) = (pick(x), pick(y));
        self.series.push(Series {
            label: name.clone(),
            name,
            kind,
            x,
            y,
            low,
        });
        self
    }

    /// Names that take colours.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.series.iter().map(|series| series.name.as_str())
    }

    /// The chart's place in the page; the script draws into it.
    pub(super) fn render(&self, number: usize) -> Markup {
        html! {
            figure.chart style="margin-inline:0" {
                figcaption { (self.title) }
                div.plot id=(format!("plot-{number}")) role="img" aria-label=(self.title) {}
                p.note {
                    @if let Some(note) = &self.note { (prose(note)) " " }
                    @if let Some(thinning) = self.thinning() { (thinning) " " }
                    span.mouse { "Drag to zoom, double-click to see all again." }
                }
            }
        }
    }

    /// A sentence that says how the longest series was thinned, if one was.
    fn thinning(&self) -> Option<String> {
        let thinned = self
            .series
            .iter()
            .filter_map(|series| series.thinned_from(&self.x));
        let all = thinned.max()?;
        Some(format!(
            "Not all of {all} samples are drawn: of each of {STRETCHES} stretches the first, the last, the smallest and the \
             largest."
        ))
    }

    /// The chart's data for the script.
    pub(super) fn json(&self, colour: &dyn Fn(&str) -> usize) -> String {
        let series: Vec<_> = self
            .series
            .iter()
            .map(|series| series.json(&self.x, &self.y, colour(&series.name)))
            .collect();
        let lines = |lines: &[Line]| {
            let one = |line: &Line| {
                format!(
                    "{{\"at\":{},\"label\":{}}}",
                    json_number(line.at, 10),
                    json_string(&line.label)
                )
            };
            let list: Vec<_> = lines
                .iter()
                .filter(|line| line.at.is_finite())
                .map(one)
                .collect();
            list.join(",")
        };
        let drawn = self
            .shades
            .iter()
            .filter(|s| s.from.is_finite() && s.to.is_finite());
        let shades: Vec<_> = drawn.map(Shade::json).collect();
        format!(
            "{{\"kind\":\"{}\",\"x\":{},\"y\":{},\"series\":[{}],\"markers\":[{}],\"levels\":[{}],\
             \"shades\":[{}]}}",
            self.kind,
            self.x.json(),
            self.y.json(),
            series.join(","),
            lines(&self.markers),
            lines(&self.levels),
            shades.join(","),
        )
    }
}

impl Shade {
    fn json(&self) -> String {
        format!(
            "{{\"from\":{},\"to\":{},\"label\":{},\"upright\":{}}}",
            json_number(self.from, 10),
            json_number(self.to, 10),
            json_string(&self.label),
            self.upright,
        )
    }
}
