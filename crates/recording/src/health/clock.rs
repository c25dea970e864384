//! A channel's clock: period, jitter, gaps.

use super::{Rounded, median};

/// Figures of a clock, s.
#[derive(Clone, Debug, PartialEq)]
pub struct Clock {
    /// Number of samples.
    pub samples: usize,
    /// First stamp.
    pub start: f64,
    /// Last stamp minus the first.
    pub duration: f64,
    /// Median interval; of stamps that are rounded one over [`Rounded::rate`]. 0 for a single sample.
    pub period: f64,
    /// Root mean square of interval minus period, gaps left out.
    pub jitter: f64,
    /// Greatest `|interval - period|`, gaps left out.
    pub worst_jitter: f64,
    /// Intervals nearer to two periods, or more, than to one.
    pub gaps: Vec<Gap>,
    /// Samples that the gaps would hold.
    pub missing: usize,
    /// What stamps that are rounded tell of their rate.
    pub rounded: Option<Rounded>,
}

/// A hole in a clock.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Stamp before the hole, s.
    pub from: f64,
    /// Stamp after the hole, s.
    pub until: f64,
    /// Samples that it would hold: `round(interval / period) - 1`.
    pub missing: usize,
}

/// The figures of stamps that increase strictly.
///
/// # Example
/// ```
/// use quell_recording::health::clock;
/// let figures = clock(&[0.0, 0.5, 1.0, 2.5, 3.0]);
/// assert_eq!((figures.period, figures.missing, figures.gaps.len()), (0.5, 2, 1));
/// ```
pub fn clock(time: &[f64]) -> Clock {
    let intervals: Vec<f64> = time.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let rounded = Rounded::of(time);
    let period = rounded.map_or_else(|| median(intervals.clone()), |own| own.rate().recip());
    let mut clock = Clock {
        samples: time.len(),
        start: time.first().copied().unwrap_or(0.0),
        duration: intervals.iter().sum(),
        period,
        jitter: 0.0,
        worst_jitter: 0.0,
        gaps: Vec::new(),
        missing: 0,
        rounded,
    };
    for (interval, pair) in intervals.iter().zip(time.windows(2)) {
        let periods = (interval / period).round();
        // A rounded interval may be twice the period of a fast sensor.
        if periods >= 2.0 && rounded.is_none() {
            let missing = periods as usize - 1;
            clock.gaps.push(Gap {
                from: pair[0],
                until: pair[1],
                missing,
            });
            clock.missing = clock.missing.saturating_add(missing);
        } else {
            let deviation = (interval - period).abs();
            // Relative to the period, so that no square overflows.
            clock.jitter += (deviation / period).powi(2);
            clock.worst_jitter = clock.worst_jitter.max(deviation);
        }
    }
    let regular = intervals.len() - clock.gaps.len();
    clock.jitter = period * (clock.jitter / regular.max(1) as f64).sqrt();
    clock
}

impl Clock {
    /// Samples per second over the whole duration, gaps included; `None` for a single sample.
    ///
    /// # Example
    /// ```
    /// use quell_recording::health::clock;
    /// let figures = clock(&[0.0, 0.01, 0.02, 0.03, 0.042, 0.052]);
    /// assert!((figures.mean_rate().unwrap() - 5.0 / 0.052).abs() < 1e-9);
    /// ```
    pub fn mean_rate(&self) -> Option<f64> {
        (self.duration > 0.0).then(|| (self.samples - 1) as f64 / self.duration)
    }

    /// Samples per second where there is no gap: by [`Rounded`] of stamps that are rounded, else by the first and the last stamp,
    /// as the period of a fast sensor, which is one interval, is uncertain by a rounding step. `None` for a single sample.
    ///
    /// # Example
    /// ```
    /// use quell_recording::health::clock;
    /// let rounded: Vec<f64> = (0..3200).map(|k| (k as f64 / 3200.0 * 1e6).round() / 1e6).collect();
    /// let figures = clock(&rounded);
    /// assert!((figures.rate().unwrap() - 3200.0).abs() < figures.rate_std().unwrap());
    /// ```
    pub fn rate(&self) -> Option<f64> {
        if let Some(rounded) = self.rounded {
            return Some(rounded.rate());
        }
        let periods = (self.samples.saturating_sub(1) as f64) + self.missing as f64;
        (self.duration > 0.0).then(|| periods / self.duration)
    }

    /// Standard deviation of [`Self::rate`]: the jitter is that of an interval, so of the difference of any two
    /// independent stamps. Of even stamps that are rounded by [`Rounded::rate_std`].
    pub fn rate_std(&self) -> Option<f64> {
        if let Some(std) = self.rounded.and_then(|own| own.rate_std()) {
            return Some(std);
        }
        Some(self.rate()? * self.jitter / self.duration)
    }

    /// One over [`Self::period`], samples per second; `None` for a single sample.
    pub fn usual_rate(&self) -> Option<f64> {
        (self.period > 0.0).then(|| 1.0 / self.period)
    }
}
