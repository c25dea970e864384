//! Shares as bars.

use quell_page::Bars;

/// Bars of shares, the largest first, and their names.
pub fn percentages(title: &str, mut shares: Vec<(String, f64)>) -> Option<(Bars, Vec<String>)> {
    shares.sort_by(|a, b| b.1.total_cmp(&a.1));
    let (names, values): (Vec<String>, Vec<f64>) = shares.into_iter().unzip();
    let rounded = |share: &f64| (1000.0 * share).round() / 10.0;
    let values: Vec<_> = values.iter().map(rounded).collect();
    let bars = Bars::new(title, "%", names.clone()).series("share", &values);
    (!names.is_empty()).then_some((bars, names))
}
