//! Numbers that stand for a missing sample, such as -9999.

/// Ends of the range of integers, of 16 and 32 bits.
const ENDS: [f64; 4] = [-32768.0, 32767.0, -2_147_483_648.0, 2_147_483_647.0];

/// The number of a column that stands for a missing sample: it is all nines or the end of a range of integers, it recurs, and
/// it is further from any other value than those are from each other.
pub fn of(numbers: &[f64]) -> Option<f64> {
    let values = || numbers.iter().copied().filter(|own| own.is_finite());
    let ends = [
        values().fold(f64::INFINITY, f64::min),
        values().fold(f64::NEG_INFINITY, f64::max),
    ];
    ends.into_iter().find(|&mark| {
        let others = || values().filter(|own| *own != mark);
        let low = others().fold(f64::INFINITY, f64::min);
        let high = others().fold(f64::NEG_INFINITY, f64::max);
        let nearest = (low - mark).max(mark - high);
        let recurs = values().filter(|own| *own == mark).count() > 1;
        is_mark(mark) && recurs && high > low && nearest > high - low
    })
}

/// Whether a number is all nines, from 999 on, or the end of a range of integers.
fn is_mark(value: f64) -> bool {
    let digits = format!("{}", value.abs());
    let is_nines = digits.len() >= 3 && digits.bytes().all(|digit| digit == b'9');
    is_nines || ENDS.contains(&value)
}
