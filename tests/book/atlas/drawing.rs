//! Small pictures: one SVG file with a panel beside the other.

use super::lines::{lines, width};
use std::fmt::Write;

const WIDTH: f64 = 250.0;
const LEFT: f64 = 12.0;
const RIGHT: f64 = WIDTH - LEFT;
/// Height of the axes.
const HIGH: f64 = 110.0;
/// Size of the font, and from one line to the next.
const FONT: f64 = 10.0;
const LINE: f64 = 12.0;
/// Base of the first line of a title.
const FIRST: f64 = 14.0;
/// Points of a line, at most.
const POINTS: usize = 240;

/// One curve over its axis.
pub struct Panel {
    pub title: String,
    pub x: Vec<f64>,
    pub y: Vec<f64>,
    /// What is along the axes, with units.
    pub along: String,
    pub up: String,
}

impl Panel {
    fn titles(&self) -> Vec<String> {
        lines(&self.title, FONT, RIGHT - LEFT)
    }

    /// What is along the upright axis, and from where to where.
    fn ordinate(&self) -> Vec<String> {
        let (low, high) = range(&self.y);
        let text = format!("{}: {}\u{a0}to\u{a0}{}", self.up, short(low), short(high));
        lines(&text, FONT, RIGHT - LEFT)
    }
}

/// All panels in one row, their axes at one height.
pub fn row(panels: &[Panel]) -> String {
    let most = |of: fn(&Panel) -> Vec<String>| panels.iter().map(|own| of(own).len()).max();
    let top = FIRST + LINE * most(Panel::titles).unwrap_or(0) as f64;
    let low = top + HIGH;
    let height = low + 2.0 * LINE + LINE * most(Panel::ordinate).unwrap_or(0) as f64;
    let total = WIDTH * panels.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {total} {height}\" font-family=\"sans-serif\" \
         font-size=\"{FONT}\" fill=\"#333\">\n<rect width=\"{total}\" height=\"{height}\" fill=\"#fff\"/>\n"
    );
    for (index, panel) in panels.iter().enumerate() {
        let x = WIDTH * index as f64;
        let drawn = draw(panel, top, low);
        let _ = writeln!(svg, "<g transform=\"translate({x} 0)\">\n{drawn}</g>");
    }
    svg + "</svg>\n"
}

/// A panel whose axes go from `top` down to `low`.
fn draw(panel: &Panel, top: f64, low: f64) -> String {
    let (x, y) = (range(&panel.x), range(&panel.y));
    let at = |value: f64, (from, to): (f64, f64), start: f64, end: f64| {
        start + (value - from) / (to - from) * (end - start)
    };
    let mut svg = written(&panel.titles(), FIRST, " font-weight=\"bold\"");
    let _ = writeln!(
        svg,
        "<path d=\"M{LEFT} {top}V{low}H{RIGHT}\" fill=\"none\" stroke=\"#999\"/>"
    );
    if y.0 < 0.0 && y.1 > 0.0 {
        let zero = at(0.0, y, low, top);
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {zero:.1}H{RIGHT}\" stroke=\"#ddd\"/>"
        );
    }
    let stride = panel.x.len().div_ceil(POINTS).max(1);
    let points = panel.x.iter().zip(&panel.y).step_by(stride);
    let points = points.map(|(px, py)| {
        let (px, py) = (at(*px, x, LEFT, RIGHT), at(*py, y, low, top));
        format!("{px:.1},{py:.1}")
    });
    let _ = writeln!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"1.2\"/>",
        points.collect::<Vec<_>>().join(" ")
    );
    svg + &abscissa(panel, low + LINE) + &written(&panel.ordinate(), low + 2.0 * LINE + 3.0, "")
}

/// Both ends of the abscissa, and between them what it is.
fn abscissa(panel: &Panel, base: f64) -> String {
    let (from, to) = range(&panel.x);
    let [from, to] = [short(from), short(to)];
    let widest = width(&from, FONT).max(width(&to, FONT));
    assert!(
        width(&panel.along, FONT) + 2.0 * widest < RIGHT - LEFT,
        "\"{}\" runs into the ends of its axis",
        panel.along
    );
    let middle = 0.5 * (LEFT + RIGHT);
    let along = escaped(&panel.along);
    format!(
        "<text x=\"{LEFT}\" y=\"{base}\">{from}</text>\n\
         <text x=\"{RIGHT}\" y=\"{base}\" text-anchor=\"end\">{to}</text>\n\
         <text x=\"{middle}\" y=\"{base}\" text-anchor=\"middle\">{along}</text>\n"
    )
}

/// Lines of text, the first at a base.
fn written(lines: &[String], base: f64, attributes: &str) -> String {
    let line = |(index, line): (usize, &String)| {
        let y = base + LINE * index as f64;
        format!(
            "<text x=\"{LEFT}\" y=\"{y}\"{attributes}>{}</text>\n",
            escaped(line)
        )
    };
    lines.iter().enumerate().map(line).collect()
}

/// From the least to the greatest, never empty.
fn range(values: &[f64]) -> (f64, f64) {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match low < high {
        true => (low, high),
        false => (low - 1.0, high + 1.0),
    }
}

/// Three digits.
pub fn short(value: f64) -> String {
    if value == 0.0 {
        return "0".into();
    }
    let power = value.abs().log10().floor() as i32;
    match power {
        -3..=3 => {
            let text = format!("{value:.*}", (2 - power).max(0) as usize);
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').into(),
                false => text,
            }
        }
        _ => format!("{value:.2e}"),
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;")
}
