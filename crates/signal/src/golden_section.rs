//! The least value of a function of one variable.

/// Where a function is least between two ends, and its value: after `sections` steps the place is known to `0.618^sections`
/// of their distance. Of several minima one is found.
///
/// Source: J. Kiefer, Sequential minimax search for a maximum, Proc. American Mathematical Society 4 (1953).
pub fn golden_section(
    mut of: impl FnMut(f64) -> f64,
    [mut from, mut until]: [f64; 2],
    sections: usize,
) -> (f64, f64) {
    let share = 0.5 * (5.0_f64.sqrt() - 1.0);
    let place = |from: f64, until: f64| {
        [
            until - share * (until - from),
            from + share * (until - from),
        ]
    };
    let [mut a, mut b] = place(from, until);
    let [mut at_a, mut at_b] = [of(a), of(b)];
    for _ in 0..sections {
        if at_a < at_b {
            (until, b, at_b) = (b, a, at_a);
            a = place(from, until)[0];
            at_a = of(a);
        } else {
            (from, a, at_a) = (a, b, at_b);
            b = place(from, until)[1];
            at_b = of(b);
        }
    }
    if at_a < at_b { (a, at_a) } else { (b, at_b) }
}
