//! Stamps that are rounded: what rates they can be of.

/// Most digits behind the point of a second: nanoseconds.
const MOST_DIGITS: i32 = 9;
/// What a stamp in steps may be off a whole number: a double's rounding of it and of the origin that was taken from it.
const DUST: f64 = 8.0 * f64::EPSILON;
/// Share of intervals of two steps below which those of one are the period, and a sample is missing now and then: a rate lies within 5 %
/// of one sample a step by chance in one file of twenty. With more than one step no interval is twice another.
const LOST: f64 = 0.05;
/// The share of clocks that lose samples by chance of which one may be taken for a fast one that drifts.
const BY_CHANCE: f64 = 0.01;
/// Halvings of a bracket: what is left of it is below a billionth.
const HALVINGS: usize = 30;

/// Stamps that are rounded to a decimal digit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounded {
    /// What they are rounded to, s.
    pub step: f64,
    /// Samples a second by the first and the last stamp, Hz.
    pub mean: f64,
    /// The least and the greatest rate, Hz, of the even clocks of which these stamps are; `None` of a clock that drifts by more than a step.
    pub rates: Option<[f64; 2]>,
}

impl Rounded {
    /// The rates `1 / T` of the even clocks `a + k T` that no stamp `t_k` is further from than half a step `q`:
    ///
    /// ```text
    /// max(t_k - k T) - min(t_k - k T) <= q
    /// ```
    ///
    /// The left side is convex in `T`, so that these are an interval, whose ends are bisected. Errors of rounding are no noise: at a
    /// period of `10 q / 3` three of them come again and again, and no number of samples tells more than they allow. So there is
    /// no regression with its standard deviation here.
    ///
    /// Where no such clock is, the rate drifts: with intervals of `n` and `n + 1` steps, `n > 1`, no sample is missing, as none is
    /// twice another. Of `N` intervals of one and two steps a share `p` is the rarer, and of an even clock it never stands beside itself.
    /// Samples that are lost by chance look so with a probability of `(1 - p^2)^N`, and the clock is believed below 1 %.
    ///
    /// `None` where the intervals are one number of steps, which is then the period, or more than two neighbouring ones, or
    /// samples may be missing: where less than 5 % of them are two steps, and the others one.
    ///
    /// # Example
    /// ```
    /// use quell_recording::health::Rounded;
    /// let time: Vec<f64> = (0..600).map(|k| (f64::from(k) / 0.3).round() / 1e3).collect();
    /// let [least, greatest] = Rounded::of(&time).unwrap().rates.unwrap();
    /// assert!(least < 300.0 && 300.0 < greatest && greatest - least < 0.12);
    /// ```
    pub fn of(time: &[f64]) -> Option<Self> {
        let (step, stamps) = (0..=MOST_DIGITS).find_map(|digits| in_steps(time, digits))?;
        let intervals: Vec<f64> = stamps.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let least = intervals.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = intervals.iter().copied().fold(0.0, f64::max);
        let longer = intervals.iter().filter(|own| **own == greatest).count() as f64;
        let is_lossy = least == 1.0 && longer < LOST * stamps.len() as f64;
        if greatest - least != 1.0 || is_lossy {
            return None;
        }
        let of = |period: f64| (period * step).recip();
        let rates = periods(&stamps).map(|[shortest, longest]| [of(longest), of(shortest)]);
        let is_whole = rates.is_some() || least > 1.0 || is_spread(&intervals, longer);
        is_whole.then(|| Self {
            step,
            mean: of(stamps[stamps.len() - 1] / intervals.len() as f64),
            rates,
        })
    }

    /// The middle of the rates, Hz; of a clock that drifts the mean.
    pub fn rate(&self) -> f64 {
        let middle = |[least, greatest]: [f64; 2]| 0.5 * (least + greatest);
        self.rates.map_or(self.mean, middle)
    }

    /// The standard deviation of a rate that may be any of these as well, Hz; `None` of a clock that drifts.
    pub fn rate_std(&self) -> Option<f64> {
        self.rates
            .map(|[least, greatest]| (greatest - least) / f64::sqrt(12.0))
    }
}

/// Whether the rarer of two intervals, of which so many are the longer one, never stands beside itself, and would if it came by chance.
fn is_spread(intervals: &[f64], longer: f64) -> bool {
    let count = intervals.len() as f64;
    let is_longer_rare = longer < 0.5 * count;
    let share = longer.min(count - longer) / count;
    let is_rare = |interval: &f64| (*interval > 1.0) == is_longer_rare;
    (1.0 - share * share).powf(count) < BY_CHANCE
        && !intervals.windows(2).any(|pair| pair.iter().all(is_rare))
}

/// Stamps from the first one on in steps of so many digits of a second, if they have no more; with the step.
fn in_steps(time: &[f64], digits: i32) -> Option<(f64, Vec<f64>)> {
    let parts = 10_f64.powi(digits);
    let whole = |stamp: &f64| {
        let steps = stamp * parts;
        ((steps - steps.round()).abs() <= DUST * steps.abs().max(1.0)).then(|| steps.round())
    };
    let first = whole(time.first()?)?;
    let steps: Option<Vec<f64>> = time.iter().map(|own| Some(whole(own)? - first)).collect();
    Some((parts.recip(), steps?))
}

/// The shortest and the longest period, in steps, of the even clocks that no stamp is further from than half a step.
fn periods(stamps: &[f64]) -> Option<[f64; 2]> {
    let last = (stamps.len() - 1) as f64;
    let mean = stamps[stamps.len() - 1] / last;
    // A longer or shorter period is off by more than a step between the ends.
    let (mut shorter, mut longer) = (mean - last.recip(), mean + last.recip());
    let mut within = mean;
    for _ in 0..HALVINGS {
        match off(stamps, within) {
            (range, _) if range <= 1.0 + DUST * stamps[stamps.len() - 1] => break,
            (_, true) => longer = within,
            (_, false) => shorter = within,
        }
        within = 0.5 * (shorter + longer);
    }
    let fits = |period: f64| off(stamps, period).0 <= 1.0 + DUST * stamps[stamps.len() - 1];
    let end = |mut beyond: f64| {
        let mut inside = within;
        for _ in 0..HALVINGS {
            let middle = 0.5 * (inside + beyond);
            match fits(middle) {
                true => inside = middle,
                false => beyond = middle,
            }
        }
        inside
    };
    fits(within).then(|| [end(shorter), end(longer)])
}

/// The range of what is left of stamps beside a period, and whether it falls towards shorter ones.
fn off(stamps: &[f64], period: f64) -> (f64, bool) {
    let (mut least, mut greatest) = ((f64::INFINITY, 0), (f64::NEG_INFINITY, 0));
    for (k, stamp) in stamps.iter().enumerate() {
        let left = stamp - k as f64 * period;
        if left < least.0 {
            least = (left, k);
        }
        if left > greatest.0 {
            greatest = (left, k);
        }
    }
    (greatest.0 - least.0, least.1 > greatest.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rounded_stamps_tell_the_rates_that_they_can_be_of() {
        for (rate, digits, start) in [
            (400.0, 3, 0.0),
            (333.0, 3, 0.0137),
            (701.3, 3, 86_000.02),
            (3200.0, 4, 5.5),
            (93.6, 2, 0.0),
        ] {
            let parts = 10_f64.powi(digits);
            let round = |k: i32| ((start + f64::from(k) / rate) * parts).round() / parts;
            let time: Vec<f64> = (0..4_000).map(round).collect();
            let found = Rounded::of(&time).unwrap();
            let [least, greatest] = found.rates.unwrap();
            assert_eq!(found.step, parts.recip());
            assert!(
                least - 1e-6 <= rate && rate <= greatest + 1e-6,
                "{rate}: {found:?}"
            );
            // Two stamps a step from where they are tell no more.
            assert!(
                (greatest - least) / rate < 2.0 / (parts * time[3_999] - parts * start),
                "{rate}: {found:?}"
            );
        }
    }

    #[test]
    fn a_clock_that_drifts_has_a_mean_rate_and_no_sample_missing() {
        for rate in [400.0, 345.0, 700.0, 600.0, 230.0] {
            // By 4 ms to either side, three times.
            let at = |k: i32| {
                f64::from(k) / rate
                    + 4e-3 * (std::f64::consts::TAU * 3.0 * f64::from(k) / 4e3).sin()
            };
            let time: Vec<f64> = (0..4_000).map(|k| (at(k) * 1e3).floor() / 1e3).collect();
            let found = Rounded::of(&time).unwrap();
            assert_eq!((found.rates, found.rate_std()), (None, None), "{rate}");
            assert!(
                (found.rate() / rate - 1.0).abs() < 2e-4,
                "{rate}: {found:?}"
            );
            let clock = super::super::clock(&time);
            assert_eq!((clock.missing, clock.period), (0, found.mean.recip()));
            let told = super::super::mixed_rates(&clock).unwrap();
            assert!(
                told.contains("drift by more") && !told.contains("mostly"),
                "{told}"
            );
        }
        // Two rates, one after the other, whose intervals are neighbouring steps.
        let two: Vec<f64> = (0..500_u32)
            .map(|k| f64::from(3 * k + k.saturating_sub(250)) / 1e3)
            .collect();
        assert_eq!(Rounded::of(&two).map(|own| own.rates), Some(None));
    }

    #[test]
    fn what_is_even_without_rounding_or_uneven_beyond_it_is_not_rounded() {
        let even: Vec<f64> = (0..500).map(|k| f64::from(k) / 250.0).collect();
        let lost: Vec<f64> = (0..500_u32)
            .map(|k| f64::from(10 * (k + k / 300)) / 3e3)
            .collect();
        let lost: Vec<f64> = lost.iter().map(|own| (own * 1e3).round() / 1e3).collect();
        // A tenth of the samples is lost, by a fixed congruence.
        let mut own = (0_u32, 1_u32);
        let by_chance: Vec<f64> = (0..2_000)
            .map(|_| {
                own.1 = own.1.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
                own.0 += if own.1 >> 16 < 6_554 { 2 } else { 1 };
                f64::from(own.0) / 1e3
            })
            .collect();
        let one_of_fifty: Vec<f64> = (0..500_u32).map(|k| f64::from(k + k / 49) / 1e3).collect();
        for time in [
            one_of_fifty,
            even,
            lost,
            by_chance,
            vec![],
            vec![1.0],
            vec![0.1, 0.2],
            vec![f64::MAX, f64::INFINITY],
        ] {
            assert_eq!(Rounded::of(&time), None);
        }
    }
}
