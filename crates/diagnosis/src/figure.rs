//! Numbers in sentences.

/// A number with its unit, to three digits.
pub fn figure(value: f64, unit: &str) -> String {
    let size = value.abs();
    let number = match size {
        0.0 => "0".into(),
        _ if (1e-3..1e5).contains(&size) => {
            let decimals = (2 - size.log10().floor() as i32).max(0) as usize;
            let fixed = format!("{value:.decimals$}");
            match fixed.contains('.') {
                true => fixed.trim_end_matches('0').trim_end_matches('.').into(),
                false => fixed,
            }
        }
        _ => format!("{value:.2e}"),
    };
    match unit {
        "" | "1" => number,
        unit => format!("{number} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::figure;

    #[test]
    fn figures_have_three_digits() {
        assert_eq!(figure(0.0, "rad"), "0 rad");
        assert_eq!(figure(-0.123456, "rad"), "-0.123 rad");
        assert_eq!(figure(30.0, "deg"), "30 deg");
        assert_eq!(figure(12345.6, "N"), "12346 N");
        assert_eq!(figure(1.234e-6, "1"), "1.23e-6");
        assert_eq!(figure(1e300, "m"), "1.00e300 m");
    }
}
