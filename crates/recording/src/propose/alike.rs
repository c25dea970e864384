//! Columns that are asked for: those without a known name, and those whose names are another one's, or nearly.

use super::columns::{Channel, Channels, MOST_ASKED};
use super::content::Content;

impl Channels {
    /// The columns to ask for where none can be named: all but further clocks and counters, texts, and columns of one value, if
    /// there are others.
    pub fn asked<'a>(&'a self, content: &'a Content) -> impl Iterator<Item = usize> + 'a {
        let counts = |index: &usize| {
            let column = &content.columns[*index];
            !column.is_measured() || column.distinct.len() < 2
        };
        let all_count = self.unused.iter().all(counts);
        let rest = self.unused.iter().copied();
        rest.filter(move |index| all_count || !counts(index))
            .take(MOST_ASKED)
    }

    /// Sentences on columns in use, those of the clock among them, whose name another column has, too, with other numbers.
    pub(super) fn doubled(
        &self,
        content: &Content,
        of_clock: impl Iterator<Item = usize>,
    ) -> Vec<String> {
        let used = self.found.iter().flat_map(|found| found.columns.clone());
        let used: Vec<usize> = used.chain(of_clock).collect();
        let all = &content.columns;
        let twin = |own: usize| {
            let is_twin = |other: &usize| {
                let same = all[own].numbers.iter().zip(&all[*other].numbers);
                let mut same = same.map(|(a, b)| a == b || a.is_nan() && b.is_nan());
                all[*other].title == all[own].title && !same.all(|same| same)
            };
            let other = (0..all.len()).find(|other| *other != own && is_twin(other))?;
            let [first, second] = [own.min(other), own.max(other)].map(|index| index + 1);
            Some(format!(
                "which of the columns {first} and {second} is meant, both are called {:?}: say it in the manifest, where columns \
                 are called by their numbers",
                all[own].title
            ))
        };
        let mut told: Vec<String> = used.into_iter().filter_map(twin).collect();
        told.dedup();
        told
    }

    /// Sentences on columns in use beside others whose names differ by a number only, as of several accelerometers.
    pub(super) fn counted(&self, content: &Content) -> Vec<String> {
        let stem = |index: usize| {
            let name = &content.columns[index].name;
            Some((name.numbered()?.0, &name.unit))
        };
        let one = |found: &Channel| {
            let own = stem(found.columns[0])?;
            let is_like = |other: &&usize| {
                let column = &content.columns[**other];
                column.has_numbers() && stem(**other).is_some_and(|other| other == own)
            };
            let others: Vec<&str> = self
                .unused
                .iter()
                .filter(is_like)
                .map(|&other| content.columns[other].title.as_str())
                .collect();
            (!others.is_empty()).then(|| {
                format!(
                    "which column is the {}, of {}, {}: a recording has one, and the proposal takes the first",
                    found.role.value,
                    content.columns[found.columns[0]].title,
                    others.join(", ")
                )
            })
        };
        self.found.iter().filter_map(one).collect()
    }
}
