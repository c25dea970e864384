//! A law defined by its values at equally spaced knots.

use quell_signal::{CubicSpline, End};

/// The twice differentiable piecewise cubic through ordinates at equally spaced knots; beyond the first and
/// the last knot it goes on with constant slope.
///
/// It is linear in its ordinates and reproduces every cubic polynomial (its ends are not-a-knot). Interpolation
/// error of the order of `h^4 f''''`. The pieces are computed once: an evaluation costs an index and a cubic,
/// and does not allocate.
///
/// Source: de Boor, A Practical Guide to Splines (1978), chapter IV.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    from: f64,
    /// Knots for a unit of the coordinate.
    density: f64,
    /// Coefficients in rising powers of the position within a piece, in spacings. First the straight line
    /// before the first knot, which begins one spacing before it, then the cubics, then the straight line after
    /// the last.
    pieces: Box<[[f64; 4]]>,
}

impl Spline {
    /// A spline through these ordinates, the first at `from` and the last at `to`. A single ordinate gives a
    /// constant; so does the first one if `from` is not below `to`. If one is not finite, all values are NaN.
    ///
    /// # Example
    /// ```
    /// use quell_model::effects::Spline;
    /// let cubic = |x: f64| x * x * x - x;
    /// let spline = Spline::new(-1.0, 1.0, &[-1.0, -0.5, 0.0, 0.5, 1.0].map(cubic));
    /// assert!((spline.value(0.3) - cubic(0.3)).abs() < 1e-15);
    /// // Constant slope outside: x^3 - x has the slope 2 at 1.
    /// assert!((spline.value(3.0) - 4.0).abs() < 1e-14);
    /// ```
    pub fn new(from: f64, to: f64, ordinates: &[f64]) -> Self {
        let spaces = ordinates.len().saturating_sub(1) as f64;
        let density = spaces / (to - from);
        let (density, ordinates) = match density > 0.0 && density.is_finite() {
            true => (density, ordinates),
            false => (0.0, &ordinates[..ordinates.len().min(1)]),
        };
        Self {
            from,
            density,
            pieces: pieces(ordinates).into(),
        }
    }

    /// The law's value.
    #[inline]
    pub fn value(&self, x: f64) -> f64 {
        let ([a, b, c, d], s) = self.piece(x);
        a + s * (b + s * (c + s * d))
    }

    /// The value; beyond the knots the slope goes on only if, with a slope of `own` beside it, it stays above
    /// 0; else the value of the last knot stays. So a spring always pulls back from where nobody has been.
    #[inline]
    pub fn stable(&self, x: f64, own: f64) -> f64 {
        match self.end(x) {
            Some(end) if self.slope(x) + own <= 0.0 => end,
            _ => self.value(x),
        }
    }

    /// The value; beyond the knots it does not fall below that of the last one.
    #[inline]
    pub fn not_less(&self, x: f64) -> f64 {
        self.end(x)
            .map_or_else(|| self.value(x), |end| end.max(self.value(x)))
    }

    /// The value; beyond the knots that of the last one.
    #[inline]
    pub fn nearest(&self, x: f64) -> f64 {
        self.end(x).unwrap_or_else(|| self.value(x))
    }

    /// The value and its derivative; beyond the knots the value of the last one, and 0.
    #[inline]
    pub fn held(&self, x: f64) -> [f64; 2] {
        match self.end(x) {
            Some(end) => [end, 0.0],
            None => [self.value(x), self.slope(x)],
        }
    }

    /// The value of the last knot for a place beyond the knots.
    #[inline]
    fn end(&self, x: f64) -> Option<f64> {
        let knots = (x - self.from) * self.density;
        let last = self.pieces.len() - 1;
        match self.pieces.len() {
            // A constant.
            1 => None,
            _ if knots < 0.0 => Some(self.pieces[1][0]),
            _ if knots as usize + 1 >= last => Some(self.pieces[last][0]),
            _ => None,
        }
    }

    /// Its derivative.
    #[inline]
    pub fn slope(&self, x: f64) -> f64 {
        let ([_, b, c, d], s) = self.piece(x);
        self.density * (b + s * (2.0 * c + s * 3.0 * d))
    }

    /// Distance of the knots; infinite where it is a constant.
    pub fn spacing(&self) -> f64 {
        1.0 / self.density
    }

    /// The knots: coordinate and ordinate. None of a constant.
    pub(super) fn knots(&self) -> impl Iterator<Item = [f64; 2]> {
        let ordinates = self.pieces.iter().skip(1).map(|piece| piece[0]);
        let at = |(k, ordinate)| [self.from + k as f64 / self.density, ordinate];
        ordinates.enumerate().map(at)
    }

    /// The largest fall from a knot to the next.
    pub(super) fn steepest_fall(&self) -> f64 {
        let knots = self.pieces.iter().skip(1).map(|piece| piece[0]);
        let falls = knots.clone().zip(knots.skip(1)).map(|(a, b)| a - b);
        falls.fold(0.0, f64::max)
    }

    #[inline]
    fn piece(&self, x: f64) -> ([f64; 4], f64) {
        // Shifted by the line before the first knot; negative values and NaN become index 0.
        let knots = (x - self.from) * self.density + 1.0;
        let index = (knots as usize).min(self.pieces.len() - 1);
        (self.pieces[index], knots - index as f64)
    }
}

fn pieces(ordinates: &[f64]) -> Vec<[f64; 4]> {
    let constant = |value| vec![[value, 0.0, 0.0, 0.0]];
    let [first, .., last] = *ordinates else {
        return constant(ordinates.first().copied().unwrap_or(0.0));
    };
    let knots: Vec<f64> = (0..ordinates.len()).map(|k| k as f64).collect();
    let Ok(spline) = CubicSpline::new(&knots, ordinates, End::NotAKnot) else {
        return constant(f64::NAN);
    };
    let slope = |k: usize| spline.derivative(knots[k]);
    let end = ordinates.len() - 1;
    let mut pieces = vec![[first - slope(0), slope(0), 0.0, 0.0]];
    for k in 0..end {
        let (before, after) = (spline.second(k), spline.second(k + 1));
        let slope = ordinates[k + 1] - ordinates[k] - (2.0 * before + after) / 6.0;
        pieces.push([ordinates[k], slope, before / 2.0, (after - before) / 6.0]);
    }
    pieces.push([last, slope(end), 0.0, 0.0]);
    pieces
}
