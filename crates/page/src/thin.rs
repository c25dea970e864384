//! Long series thinned for drawing, so that the drawn line does not change.

/// Stretches of the abscissa that keep four samples each: twice the width of a page in pixels.
pub(super) const STRETCHES: usize = 1500;

/// Indices of the samples to draw: of each stretch the first, the last, the smallest and the
/// largest, and every sample if there are no more than that anyway.
///
/// A line through them covers the same pixels as the line through all, as long as a stretch is
/// no wider than a pixel. `x` ascends; what is not finite in `y` is kept where it interrupts.
///
/// Source: U. Jugel, Z. Jerzak, G. Hackenbroich, V. Markl, "M4: A Visualization-Oriented Time
/// Series Data Aggregation", Proc. VLDB Endowment 7(10), 2014.
pub(super) fn thinned(x: &[f64], y: &[f64], logarithmic: bool) -> Vec<usize> {
    if x.len() <= 4 * STRETCHES {
        return (0..x.len()).collect();
    }
    let place = |index: usize| if logarithmic { x[index].ln() } else { x[index] };
    let (start, length) = (place(0), place(x.len() - 1) - place(0));
    let stretch = |index: usize| {
        ((place(index) - start) / length * STRETCHES as f64).min(STRETCHES as f64 - 1.0) as usize
    };
    let mut kept = Vec::with_capacity(4 * STRETCHES);
    let mut first = 0;
    while first < x.len() {
        let number = stretch(first);
        let count = x[first..]
            .iter()
            .zip(first..)
            .take_while(|&(_, i)| stretch(i) == number)
            .count();
        keep_four(y, first, first + count.max(1), &mut kept);
        first += count.max(1);
    }
    kept
}

fn keep_four(y: &[f64], first: usize, end: usize, kept: &mut Vec<usize>) {
    let finite = || (first..end).filter(|&index| y[index].is_finite());
    let smallest = finite().min_by(|&a, &b| y[a].total_cmp(&y[b]));
    let largest = finite().max_by(|&a, &b| y[a].total_cmp(&y[b]));
    let gap = (first..end).find(|&index| !y[index].is_finite());
    let mut four: Vec<_> = [Some(first), smallest, largest, gap, Some(end - 1)]
        .into_iter()
        .flatten()
        .collect();
    four.sort_unstable();
    four.dedup();
    kept.extend(four);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_ends_and_gaps_survive() {
        let count = 100_000;
        let x: Vec<_> = (0..count).map(f64::from).collect();
        let mut y: Vec<_> = x.iter().map(|t| (0.01 * t).sin()).collect();
        (y[54_321], y[70_001], y[12_345]) = (7.0, -9.0, f64::NAN);
        let kept = thinned(&x, &y, false);
        assert!(kept.len() <= 4 * STRETCHES + 1 && kept.is_sorted());
        for index in [0, 54_321, 70_001, 12_345, x.len() - 1] {
            assert!(kept.contains(&index), "{index}");
        }
    }

    #[test]
    fn short_series_are_left_alone() {
        assert_eq!(thinned(&[1.0, 2.0, 3.0], &[0.0; 3], false), [0, 1, 2]);
    }
}
