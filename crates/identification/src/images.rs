//! Faster modes that look like one in samples.

/// The three lowest frequencies above half of a rate, Hz, that look like `hertz` in so many samples a second: `k rate - hertz` and
/// `k rate + hertz` of whole `k`. `hertz` is above 0 and at most half the rate.
///
/// Source: C. E. Shannon, Communication in the presence of noise, Proc. IRE 37 (1949).
///
/// # Example
/// ```
/// assert_eq!(quell_identification::images(20.0, 100.0), [80.0, 120.0, 180.0]);
/// ```
pub fn images(hertz: f64, rate: f64) -> [f64; 3] {
    [rate - hertz, rate + hertz, 2.0 * rate - hertz]
}

#[cfg(test)]
mod tests {
    use crate::IdentificationError;

    #[test]
    fn a_mode_above_half_the_rate_is_told_with_more_than_its_nearest_image() {
        let told = IdentificationError::Above {
            hertz: 20.0,
            searched: [0.5, 20.0],
            rate: 100.0,
        };
        let words = "80.0 Hz looks the same, and so do 120.0 and 180.0 Hz and further ones";
        assert!(told.to_string().contains(words), "{told}");
    }
}
