//! Numbers as they are typed on a command line, with their ranges.

use std::str::FromStr;

use quell_shapers::Mode;

/// `F,XI`: a mode by its natural frequency in Hz and its damping ratio.
pub fn mode(text: &str) -> Result<Mode, String> {
    let form = || format!("{text:?} is not F,XI, such as 8.12,0.084 (Hz and a damping ratio)");
    let (frequency, damping_ratio) = text.split_once(',').ok_or_else(form)?;
    let number = |text: &str| text.trim().parse::<f64>().map_err(|_| form());
    let [hertz, xi] = [number(frequency)?, number(damping_ratio)?];
    // As they were typed: 1e308 has 309 digits.
    if !within_largest(hertz) {
        let typed = frequency.trim();
        return Err(format!(
            "a natural frequency of {typed} Hz is not a number from 1e-9 to 1e9"
        ));
    }
    if !(0.0..1.0).contains(&xi) {
        let typed = damping_ratio.trim();
        return Err(format!("damping ratio {typed} is not in [0, 1)"));
    }
    Mode::from_hertz(hertz, xi).map_err(|error| error.to_string())
}

/// A finite number.
pub fn finite(text: &str) -> Result<f64, String> {
    checked(text, f64::is_finite, "a finite number")
}

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    let holds = |value: f64| value.is_finite() && value > 0.0;
    checked(text, holds, "a finite number above 0")
}

/// The largest angle, limit or size in the unit of its option: no joint turns so far or so fast, none carries so much,
/// and planners take it.
const LARGEST: f64 = 1e9;

fn within_largest(value: f64) -> bool {
    (1.0 / LARGEST..=LARGEST).contains(&value)
}

/// An angle, deg.
pub fn angle(text: &str) -> Result<f64, String> {
    checked(
        text,
        |value| value.abs() <= LARGEST,
        "a number of degrees within +-1e9",
    )
}

/// A limit of a motion, deg/s, deg/s^2 or deg/s^3: a joint with a smaller one does not move. Or a deviation, mm.
pub fn limit(text: &str) -> Result<f64, String> {
    checked(text, within_largest, "a number from 1e-9 to 1e9")
}

/// A load, kg, or a noise, um.
pub fn size(text: &str) -> Result<f64, String> {
    let holds = |value: f64| (0.0..=LARGEST).contains(&value);
    checked(text, holds, "a number from 0 to 1e9")
}

/// A share of the unshaped vibration, percent: a move that need not be shaped leaves all of it.
pub fn residual(text: &str) -> Result<f64, String> {
    let holds = |value: f64| value > 0.0 && value <= 100.0;
    checked(text, holds, "a percentage above 0, up to 100")
}

/// An error of a frequency, percent of it: the frequency stays above 0.
pub fn frequency_error(text: &str) -> Result<f64, String> {
    let holds = |value: f64| value > -100.0 && value <= LARGEST;
    checked(text, holds, "a percentage above -100, up to 1e9")
}

/// A finite number, 0 or more.
pub fn not_negative(text: &str) -> Result<f64, String> {
    let holds = |value: f64| value.is_finite() && value >= 0.0;
    checked(text, holds, "a finite number, 0 or more")
}

/// A percentage below 100, so that a reduction by it leaves something.
pub fn below_100_percent(text: &str) -> Result<f64, String> {
    let holds = |value: f64| (0.0..100.0).contains(&value);
    checked(text, holds, "a percentage from 0 to below 100")
}

/// A count of 1 or more.
pub fn count<T: FromStr + Default + PartialEq>(text: &str) -> Result<T, String> {
    let value = text.trim().parse::<T>().ok();
    let counts = value.filter(|value| *value != T::default());
    counts.ok_or_else(|| "it is not a whole number, 1 or more".into())
}

fn checked(text: &str, holds: impl Fn(f64) -> bool, rule: &str) -> Result<f64, String> {
    let value = text.trim().parse::<f64>();
    let value = value.ok().filter(|value| holds(*value));
    value.ok_or_else(|| format!("it is not {rule}"))
}
