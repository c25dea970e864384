//! Stamps that are readings of a counter which begins again: what it counts to, and stamps that go on.

use super::wraps::Wrap;

/// Bits of counters of time: 15 of the realtime tick of Dynamixel's drives (register 120 of the control table of the X series), 16 and 32
/// of microcontrollers' timers (`millis()` and `micros()` of Arduino have 32), 24 of the sensor time of Bosch's BMI160.
const BITS: [i32; 4] = [15, 16, 24, 32];
/// What a stamp may have been divided by, as a count of microseconds that is written in seconds.
const DIVISORS: [f64; 3] = [1.0, 1e3, 1e6];
/// The share of files with several tests of which one may be taken for a counter.
const BY_CHANCE: f64 = 0.01;

impl Wrap {
    /// The counter whose readings these stamps are; `None` where none falls, or a fall may be the start of a test. NaN is a stamp
    /// that is missing.
    ///
    /// At each fall the stamps go on by one median interval `T`, to the nearest number of them, if the period `P` of the counter is added.
    /// A test that ends anywhere is followed so by chance with the probability `T / P`; so `n` falls and `m` counters are
    /// believed where `m (T / P)^n < 1 %`. Tests begin alike, and may last `P`: a stamp behind a fall that equals the first one
    /// tells nothing.
    ///
    /// # Example
    /// ```
    /// use quell_recording::Wrap;
    /// let micros = |k: u64| ((4_294_000_123 + 1_000 * k) % (1 << 32)) as f64;
    /// let stamps: Vec<f64> = (0..2_000).map(micros).collect();
    /// let told = Wrap::of_stamps(&stamps).map(|own| (own.period, own.jumps, own.first));
    /// assert_eq!(told, Some((4_294_967_296.0, 1, 968)));
    /// ```
    pub fn of_stamps(stamps: &[f64]) -> Option<Self> {
        let there: Vec<usize> = (0..stamps.len()).filter(|k| !stamps[*k].is_nan()).collect();
        let step = |pair: &[usize]| stamps[pair[1]] - stamps[pair[0]];
        let pairs = || there.windows(2).map(|pair| (pair[1], step(pair)));
        let falls: Vec<(usize, f64)> = pairs().filter(|own| own.1 < 0.0).collect();
        let starts = stamps[*there.first()?];
        let first = falls.first()?.0;
        if falls.iter().any(|own| stamps[own.0] == starts) {
            return None;
        }
        let grown = pairs().map(|own| own.1).filter(|step| *step > 0.0);
        let interval = super::health::median(grown.collect());
        let able = || {
            BITS.iter()
                .flat_map(|bits| DIVISORS.map(|divisor| 2_f64.powi(*bits) / divisor))
        };
        let goes_on = |period: &f64| {
            let jumps = i32::try_from(falls.len()).unwrap_or(i32::MAX);
            let chance = able().count() as f64 * (interval / period).powi(jumps);
            let one = |fall: &(usize, f64)| ((fall.1 + period) / interval).round() == 1.0;
            chance < BY_CHANCE && falls.iter().all(one)
        };
        Some(Self {
            period: able().find(goes_on)?,
            jumps: falls.len(),
            first,
        })
    }
}

/// Adds a period to all that follows a fall of more than half of it. A stamp that is late by some samples stays so. Unlike a position
/// (`wraps::unwrap`) time only grows: a gap of more than half a period is no step back.
pub(super) fn go_on(stamps: &mut [f64], period: f64) {
    let (mut turns, mut before) = (0.0, f64::NEG_INFINITY);
    for stamp in stamps.iter_mut().filter(|stamp| !stamp.is_nan()) {
        if before - *stamp > 0.5 * period {
            turns += 1.0;
        }
        before = *stamp;
        *stamp += turns * period;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Stamps of a counter of so many bits, in units of `1 / divisor`, at a period with a jitter of a tenth.
    fn read(bits: u32, divisor: f64, period: u64, samples: u64) -> Vec<f64> {
        let count = |k: u64| {
            (1 << bits) - 300 * period + period / 2 + k * period + (k * k % 7) * period / 70
        };
        let read = |k| (count(k) % (1 << bits)) as f64 / divisor;
        (0..samples).map(read).collect()
    }

    #[test]
    fn a_counter_of_time_is_found_by_its_period_and_goes_on() {
        for (bits, divisor, period) in [
            (32, 1.0, 1_000),
            (32, 1e6, 313),
            (32, 1e3, 2_500),
            (24, 1.0, 40),
            (16, 1.0, 5),
            (15, 1.0, 8),
        ] {
            let mut stamps = read(bits, divisor, period, 2_000);
            stamps[700] = f64::NAN;
            let found = Wrap::of_stamps(&stamps).unwrap();
            assert_eq!(
                (found.period, found.first),
                (f64::from(bits).exp2() / divisor, 300)
            );
            go_on(&mut stamps, found.period);
            let there: Vec<f64> = stamps.into_iter().filter(|own| !own.is_nan()).collect();
            let mut steps = there.windows(2).map(|pair| pair[1] - pair[0]);
            assert!(steps.all(|step| step > 0.0 && step * divisor < 2.5 * period as f64));
        }
        // A fast counter begins again often, and one fall alone would not tell it.
        let fast: Vec<f64> = (0..400_u32)
            .map(|k| f64::from((60_001 + 997 * k) % 65_536))
            .collect();
        assert_eq!(Wrap::of_stamps(&fast).map(|own| own.period), Some(65_536.0));
        assert_eq!(Wrap::of_stamps(&fast[..20]), None);
    }

    #[test]
    fn what_begins_again_otherwise_is_no_counter_of_time() {
        let tests = |k: u32| f64::from(k % 3_000) / 1e3;
        // Tests of as many samples as a counter has steps begin alike.
        let long = |k: u32| f64::from(k % 65_536);
        let late = |k: u32| f64::from(if k == 90_000 { k - 3 } else { k });
        for stamps in [tests, long, late].map(|of| (0..140_000).map(of).collect::<Vec<f64>>()) {
            assert_eq!(Wrap::of_stamps(&stamps), None);
        }
        assert_eq!(Wrap::of_stamps(&[]), None);
        assert_eq!(Wrap::of_stamps(&[f64::NAN, 3.0, 2.0]), None);
        let mut late = [1.0, 2.0, 3.0, 2.5, 4.0];
        go_on(&mut late, 65_536.0);
        assert_eq!(late, [1.0, 2.0, 3.0, 2.5, 4.0]);
    }

    #[test]
    fn a_recording_over_the_end_of_a_counter_is_one() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("run.csv");
        let row = |k: u32| {
            format!(
                "{},{:.4}\n",
                4_294_000_000_u32.wrapping_add(1_000 * k),
                f64::from(k % 25)
            )
        };
        let rows: String = (0..3_000).map(row).collect();
        std::fs::write(&file, format!("time_us,accel_g\n{rows}")).unwrap();
        let time = &crate::Recording::from_path(&file).unwrap().channels[0].time;
        let near = |k: usize| (time[k] - 4294.0 - 1e-3 * k as f64).abs() < 1e-9;
        assert!(time.len() == 3_000 && (0..3_000).all(near));
        // Its first stamps would else be seconds since 1970.
        std::fs::write(&file, format!("time,accel_g\n{rows}")).unwrap();
        let told = crate::propose(&file).unwrap();
        assert_eq!(told.manifests.len(), 1);
        assert!(
            told.manifests[0].text.contains("time_unit = \"us\""),
            "{told:?}"
        );
        // What does not fit the key is refused at its line.
        let manifest = |keys: &str| {
            let head = "name = \"x\"\n[[channel]]\nrole = \"tip_acceleration\"\nfile = \"run.csv\"\ncolumn = \"accel_g\"\nunit = \"g\"\n";
            let path = folder.path().join("own.toml");
            std::fs::write(&path, format!("{head}{keys}")).unwrap();
            crate::Recording::from_path(&path).unwrap_err().to_string()
        };
        for (keys, words) in [
            ("time = \"time_us\"\ntime_wrap = -1", "-1 is not above 0"),
            (
                "rate_hz = 1000\ntime_wrap = 65536",
                "rate_hz stands in their place",
            ),
            (
                "time = \"time_us\"\ntime_unit = \"iso\"\ntime_wrap = 65536",
                "no numbers of a counter",
            ),
        ] {
            let told = manifest(keys);
            assert!(told.contains(words) && told.contains("time_wrap"), "{told}");
        }
    }
}
