//! Bar charts, for a few named values.

use super::colour::{COLOURS, swatch};
use super::html::number;
use super::prose::prose;
use maud::{Markup, html};

/// Horizontal bars from zero, each with its value beside it; several series stand below each other.
///
/// Values below zero or not finite get no bar, only their number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bars {
    title: String,
    unit: String,
    categories: Vec<String>,
    series: Vec<(String, Vec<f64>)>,
    level: Option<(f64, String)>,
    marked: Vec<usize>,
    limit: Option<f64>,
    note: Option<String>,
}

impl Bars {
    /// Bars for these categories, with the unit of the values ("" if they have none).
    pub fn new(
        title: impl Into<String>,
        unit: impl Into<String>,
        categories: impl IntoIterator<Item = impl Into<String>>,
    ) -> Self {
        Self {
            title: title.into(),
            unit: unit.into(),
            categories: categories.into_iter().map(Into::into).collect(),
            ..Self::default()
        }
    }

    /// One value for each category.
    pub fn series(mut self, name: impl Into<String>, values: &[f64]) -> Self {
        self.series.push((name.into(), values.to_vec()));
        self
    }

    /// Marks the bars of the category at this place as the ones to look at.
    pub fn marked(mut self, category: usize) -> Self {
        self.marked.push(category);
        self
    }

    /// The value at which bars are cut off, so that one of them does not hide the others.
    pub fn up_to(mut self, limit: f64) -> Self {
        self.limit = Some(limit);
        self
    }

    /// A dashed line across all bars, as of a limit, with a few words.
    pub fn level(mut self, value: f64, label: impl Into<String>) -> Self {
        self.level = Some((value, label.into()));
        self
    }

    /// A sentence below the bars.
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.note = Some(note.into());
        self
    }

    /// Names that take colours; a single series leaves them to its categories.
    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        let several = self.series.len() > 1;
        self.series
            .iter()
            .filter(move |_| several)
            .map(|(name, _)| name.as_str())
    }

    /// Width of a bar in percent of its track; the longest leaves room for its number.
    fn percent(&self, value: f64) -> f64 {
        let values = self.series.iter().flat_map(|(_, values)| values).copied();
        let level = self.level.as_ref().map(|level| level.0);
        let largest = values
            .chain(level)
            .filter(|value| value.is_finite())
            .fold(0.0, f64::max);
        let largest = self.limit.map_or(largest, |limit| largest.min(limit));
        let share = if largest > 0.0 { value / largest } else { 0.0 };
        if share.is_finite() {
            75.0 * share.clamp(0.0, 1.0)
        } else {
            0.0
        }
    }

    pub(super) fn render(&self, colour: &dyn Fn(&str) -> Option<usize>) -> Markup {
        html! {
            figure.chart style="margin-inline:0" {
                figcaption { (self.title) }
                div.bars {
                    @for category in 0..self.categories.len() { (self.row(category, colour)) }
                }
                (self.keys(colour))
                @if let Some(note) = &self.note { p.note { (prose(note)) } }
            }
        }
    }

    /// The colour of a bar's owner. Categories have colours where all of them do: one alone would look like a message.
    fn owned(&self, owner: &str, colour: &dyn Fn(&str) -> Option<usize>) -> Option<usize> {
        let all = || self.categories.iter().all(|name| colour(name).is_some());
        colour(owner).filter(|_| self.series.len() > 1 || all())
    }

    fn row(&self, category: usize, colour: &dyn Fn(&str) -> Option<usize>) -> Markup {
        let name = &self.categories[category];
        let marked = self.marked.contains(&category);
        let plain = if marked { "plain" } else { "quiet" };
        let bar = |(series, values): &(String, Vec<f64>)| {
            let value = values.get(category).copied().unwrap_or(f64::NAN);
            let owner = if self.series.len() > 1 { series } else { name };
            let colour = self
                .owned(owner, colour)
                .map_or(plain.into(), |slot| format!("c{}", slot % COLOURS));
            let style = format!(
                "width:{:.2}%;background:var(--{colour})",
                self.percent(value)
            );
            html! {
                div.bar {
                    i style=(style) {}
                    span { (number(value)) " " (self.unit) }
                }
            }
        };
        html! {
            div.name.marked[marked] { (name) }
            div.track {
                @for series in &self.series { (bar(series)) }
                @if let Some((value, _)) = &self.level {
                    hr style=(format!("left:{:.2}%", self.percent(*value)));
                }
            }
        }
    }

    fn keys(&self, colour: &dyn Fn(&str) -> Option<usize>) -> Markup {
        html! {
            @if self.names().next().is_some() || self.level.is_some() {
                div.keys {
                    @for name in self.names() {
                        span { (swatch(colour(name).unwrap_or(0))) (name) }
                    }
                    @if let Some((value, label)) = &self.level {
                        span { span.dash {} (label) ": " (number(*value)) " " (self.unit) }
                    }
                }
            }
        }
    }
}
