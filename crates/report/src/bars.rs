//! Bar charts, for a few named values.

use super::html::{escape, number};
use super::page::COLOURS;
use super::table::swatch;

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

    pub(super) fn render(&self, colour: &dyn Fn(&str) -> Option<usize>) -> String {
        let rows: String = (0..self.categories.len())
            .map(|k| self.row(k, colour))
            .collect();
        let title = escape(&self.title);
        let note = self
            .note
            .as_ref()
            .map(|note| format!("<p class=\"note\">{}</p>", escape(note)));
        format!(
            "<figure class=\"chart\" style=\"margin-inline:0\"><figcaption>{title}</figcaption>\
             <div class=\"bars\">{rows}</div>{}{}</figure>\n",
            self.keys(colour),
            note.unwrap_or_default(),
        )
    }

    fn row(&self, category: usize, colour: &dyn Fn(&str) -> Option<usize>) -> String {
        let name = &self.categories[category];
        let (plain, class) = match self.marked.contains(&category) {
            true => ("plain", "name marked"),
            false => ("quiet", "name"),
        };
        let bar = |(series, values): &(String, Vec<f64>)| {
            let value = values.get(category).copied().unwrap_or(f64::NAN);
            let owner = if self.series.len() > 1 { series } else { name };
            format!(
                "<div class=\"bar\"><i style=\"width:{:.2}%;background:var(--{})\"></i>\
                 <span>{} {}</span></div>",
                self.percent(value),
                colour(owner).map_or(plain.into(), |slot| format!("c{}", slot % COLOURS)),
                number(value),
                escape(&self.unit),
            )
        };
        let bars: String = self.series.iter().map(bar).collect();
        let level = self
            .level
            .as_ref()
            .map(|(value, _)| format!("<hr style=\"left:{:.2}%\">", self.percent(*value)));
        format!(
            "<div class=\"{class}\">{}</div><div class=\"track\">{bars}{}</div>",
            escape(name),
            level.unwrap_or_default(),
        )
    }

    fn keys(&self, colour: &dyn Fn(&str) -> Option<usize>) -> String {
        let series = self.names().map(|name| {
            format!(
                "<span>{}{}</span>",
                swatch(colour(name).unwrap_or(0)),
                escape(name)
            )
        });
        let level = self.level.as_ref().map(|(value, label)| {
            let value = number(*value);
            let text = format!("{}: {value} {}", escape(label), escape(&self.unit));
            format!("<span><span class=\"dash\"></span>{text}</span>")
        });
        let keys: String = series.chain(level).collect();
        if keys.is_empty() {
            keys
        } else {
            format!("<div class=\"keys\">{keys}</div>")
        }
    }
}
