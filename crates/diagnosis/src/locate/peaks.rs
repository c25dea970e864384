//! Significant lines of a spectrum.

/// Probability that noise alone gives any peak.
const FALSE_ALARM: f64 = 0.001;

/// A significant line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Line {
    /// Index of the line, interpolated by a parabola.
    pub at: f64,
    /// Power over the floor.
    pub ratio: f64,
}

/// Significant local maxima of a power spectrum between two lines, the strongest first.
///
/// The power of a line of noise is exponentially distributed about its floor, so the greatest of `m` exceeds
/// `ln(m / p)` times the floor with probability `p` (Fisher, 1929, for a known floor). The floor is the median
/// of the neighbourhood over `ln 2`; it follows coloured noise and the skirts of a peak.
pub(super) fn lines(power: &[f64], from: usize, to: usize) -> Vec<Line> {
    let to = to.min(power.len().saturating_sub(1));
    if from < 1 || to < from + 16 {
        return Vec::new();
    }
    let floor = Floor::new(power, from, to);
    let threshold = ((to - from) as f64 / FALSE_ALARM).ln();
    let mut found: Vec<Line> = (from..to)
        .filter(|&k| power[k] > power[k - 1] && power[k] >= power[k + 1])
        .filter_map(|k| {
            let ratio = power[k] / floor.at(k);
            (ratio > threshold).then(|| Line {
                at: k as f64 + shift(&power[k - 1..=k + 1]),
                ratio,
            })
        })
        .collect();
    found.sort_by(|a, b| b.ratio.total_cmp(&a.ratio));
    found
}

/// Top of the parabola through the logarithms of three neighbours, relative to the middle one.
fn shift(power: &[f64]) -> f64 {
    let [l, c, r] = [power[0], power[1], power[2]].map(|x| x.max(f64::MIN_POSITIVE).ln());
    let curvature = l - 2.0 * c + r;
    if curvature < 0.0 {
        (0.5 * (l - r) / curvature).clamp(-0.5, 0.5)
    } else {
        0.0
    }
}

/// Logarithm of the floor at lines in geometric steps, straight between them.
struct Floor {
    knots: Vec<(f64, f64)>,
}

impl Floor {
    fn new(power: &[f64], from: usize, to: usize) -> Self {
        let mut knots = Vec::new();
        let mut centre = from;
        while centre <= to {
            // A neighbourhood of at least 33 lines, and half an octave to each side.
            let half = 16.max(centre * 2 / 5);
            let low = centre.saturating_sub(half).max(from);
            let near = &power[low..=(centre + half).max(low + 16).min(to)];
            let mut near = near.to_vec();
            let middle = near.len() / 2;
            let median = *near.select_nth_unstable_by(middle, f64::total_cmp).1;
            let floor = median / std::f64::consts::LN_2;
            knots.push((centre as f64, floor.max(f64::MIN_POSITIVE).ln()));
            centre += (half / 2).max(1);
        }
        Self { knots }
    }

    fn at(&self, line: usize) -> f64 {
        let x = line as f64;
        let after = self.knots.partition_point(|knot| knot.0 <= x);
        let log = match (
            after.checked_sub(1).map(|k| self.knots[k]),
            self.knots.get(after),
        ) {
            (Some((x0, y0)), Some((x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
            (Some((_, y)), None) | (None, Some(&(_, y))) => y,
            (None, None) => 0.0,
        };
        log.exp()
    }
}
