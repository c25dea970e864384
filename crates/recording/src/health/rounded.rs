//! Even stamps that are rounded: what rates they can be of.

/// Most digits behind the point of a second: nanoseconds.
const MOST_DIGITS: i32 = 9;
/// What a stamp in steps may be off a whole number: a double's rounding of it and of the origin that was taken from it.
const DUST: f64 = 8.0 * f64::EPSILON;
/// Share of intervals of two steps below which those of one are the period, and a sample is missing now and then: a rate lies within 5 %
/// of one sample a step by chance in one file of twenty. With more than one step no interval is twice another.
const LOST: f64 = 0.05;
/// Halvings of a bracket: what is left of it is below a billionth.
const HALVINGS: usize = 30;

/// Stamps of an even clock that are rounded to a decimal digit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rounded {
    /// What they are rounded to, s.
    pub step: f64,
    /// The least and the greatest rate, Hz, of which these stamps are.
    pub rates: [f64; 2],
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
    /// `None` where the intervals are one number of steps, which is then the period, or more than two neighbouring ones, or no
    /// such clock is, or samples may be missing: where less than 5 % of them are two steps, and the others one.
    ///
    /// # Example
    /// ```
    /// use quell_recording::health::Rounded;
    /// let time: Vec<f64> = (0..600).map(|k| (f64::from(k) / 0.3).round() / 1e3).collect();
    /// let [least, greatest] = Rounded::of(&time).unwrap().rates;
    /// assert!(least < 300.0 && 300.0 < greatest && greatest - least < 0.12);
    /// ```
    pub fn of(time: &[f64]) -> Option<Self> {
        let (step, stamps) = (0..=MOST_DIGITS).find_map(|digits| in_steps(time, digits))?;
        let intervals = || stamps.windows(2).map(|pair| pair[1] - pair[0]);
        let least = intervals().fold(f64::INFINITY, f64::min);
        let greatest = intervals().fold(0.0, f64::max);
        let longer = intervals().filter(|own| *own == greatest).count() as f64;
        let is_lossy = least == 1.0 && longer < LOST * stamps.len() as f64;
        if greatest - least != 1.0 || is_lossy {
            return None;
        }
        let [shortest, longest] = periods(&stamps)?;
        let rates = [longest, shortest].map(|period| (period * step).recip());
        Some(Self { step, rates })
    }

    /// The middle of the rates, Hz.
    pub fn rate(&self) -> f64 {
        0.5 * (self.rates[0] + self.rates[1])
    }

    /// The standard deviation of a rate that may be any of these as well, Hz.
    pub fn rate_std(&self) -> f64 {
        (self.rates[1] - self.rates[0]) / f64::sqrt(12.0)
    }
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
            let [least, greatest] = found.rates;
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
    fn what_is_even_without_rounding_or_uneven_beyond_it_is_not_rounded() {
        let even: Vec<f64> = (0..500).map(|k| f64::from(k) / 250.0).collect();
        // Two rates, one after the other, whose intervals are neighbouring steps.
        let two: Vec<f64> = (0..500_u32)
            .map(|k| f64::from(3 * k + k.saturating_sub(250)) / 1e3)
            .collect();
        let lost: Vec<f64> = (0..500_u32)
            .map(|k| f64::from(10 * (k + k / 300)) / 3e3)
            .collect();
        let lost: Vec<f64> = lost.iter().map(|own| (own * 1e3).round() / 1e3).collect();
        let one_of_fifty: Vec<f64> = (0..500_u32).map(|k| f64::from(k + k / 49) / 1e3).collect();
        for time in [
            one_of_fifty,
            even,
            two,
            lost,
            vec![],
            vec![1.0],
            vec![0.1, 0.2],
            vec![f64::MAX, f64::INFINITY],
        ] {
            assert_eq!(Rounded::of(&time), None);
        }
    }
}
