//! Small pictures: one SVG file with a panel beside the other.

use std::fmt::Write;

const WIDTH: f64 = 250.0;
const HEIGHT: f64 = 170.0;
const LEFT: f64 = 12.0;
const TOP: f64 = 26.0;
const BOTTOM: f64 = 34.0;
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

/// All panels in one row.
pub fn row(panels: &[Panel]) -> String {
    let width = WIDTH * panels.len() as f64;
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {HEIGHT}\" font-family=\"sans-serif\" \
         font-size=\"10\" fill=\"#333\">\n<rect width=\"{width}\" height=\"{HEIGHT}\" fill=\"#fff\"/>\n"
    );
    for (index, panel) in panels.iter().enumerate() {
        let x = WIDTH * index as f64;
        let _ = writeln!(
            svg,
            "<g transform=\"translate({x} 0)\">\n{}</g>",
            draw(panel)
        );
    }
    svg + "</svg>\n"
}

fn draw(panel: &Panel) -> String {
    let (x, y) = (range(&panel.x), range(&panel.y));
    let (right, low) = (WIDTH - LEFT, HEIGHT - BOTTOM);
    let at = |value: f64, (from, to): (f64, f64), start: f64, end: f64| {
        start + (value - from) / (to - from) * (end - start)
    };
    let stride = panel.x.len().div_ceil(POINTS).max(1);
    let mut line = String::new();
    for (px, py) in panel.x.iter().zip(&panel.y).step_by(stride) {
        let _ = write!(
            line,
            "{:.1},{:.1} ",
            at(*px, x, LEFT, right),
            at(*py, y, low, TOP)
        );
    }
    let mut svg = format!(
        "<text x=\"{LEFT}\" y=\"14\" font-weight=\"bold\">{}</text>\n\
         <path d=\"M{LEFT} {TOP}V{low}H{right}\" fill=\"none\" stroke=\"#999\"/>\n",
        escaped(&panel.title)
    );
    if y.0 < 0.0 && y.1 > 0.0 {
        let zero = at(0.0, y, low, TOP);
        let _ = writeln!(
            svg,
            "<path d=\"M{LEFT} {zero:.1}H{right}\" stroke=\"#ddd\"/>"
        );
    }
    let _ = write!(
        svg,
        "<polyline points=\"{}\" fill=\"none\" stroke=\"#0072b2\" stroke-width=\"1.2\"/>\n\
         <text x=\"{LEFT}\" y=\"{}\">{}</text>\n<text x=\"{right}\" y=\"{}\" text-anchor=\"end\">{}</text>\n\
         <text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
        line.trim_end(),
        low + 12.0,
        short(x.0),
        low + 12.0,
        short(x.1),
        0.5 * (LEFT + right),
        low + 12.0,
        escaped(&panel.along),
    );
    let _ = writeln!(
        svg,
        "<text x=\"{LEFT}\" y=\"{}\">{}: {} to {}</text>",
        low + 27.0,
        escaped(&panel.up),
        short(y.0),
        short(y.1)
    );
    svg
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
