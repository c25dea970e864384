//! Stations in a row, for where in a machine something sits.

use maud::{Markup, html};

/// Boxes from left to right with arrows between them, some of them marked; boxes beside the row come
/// after it and have no arrow.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Chain {
    title: String,
    stations: Vec<Station>,
}

#[derive(Clone, Debug, PartialEq)]
struct Station {
    name: String,
    words: String,
    marks: Vec<String>,
    doubts: Vec<String>,
    beside: bool,
}

impl Chain {
    /// An empty row.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// Adds a station with a few words on what it is.
    pub fn station(self, name: impl Into<String>, words: impl Into<String>) -> Self {
        self.push(name.into(), words.into(), false)
    }

    /// Adds a station that is not a part of the row.
    pub fn beside(self, name: impl Into<String>, words: impl Into<String>) -> Self {
        self.push(name.into(), words.into(), true)
    }

    /// Marks the last station as the one to look at, and says why; each reason has its line.
    pub fn marked(mut self, why: impl Into<String>) -> Self {
        if let Some(station) = self.stations.last_mut() {
            station.marks.push(why.into());
        }
        self
    }

    /// Marks the last station as one that may be meant, and says why: paler than what is sure.
    pub fn perhaps(mut self, why: impl Into<String>) -> Self {
        if let Some(station) = self.stations.last_mut() {
            station.doubts.push(why.into());
        }
        self
    }

    fn push(mut self, name: String, words: String, beside: bool) -> Self {
        self.stations.push(Station {
            name,
            words,
            marks: Vec::new(),
            doubts: Vec::new(),
            beside,
        });
        self
    }

    pub(super) fn render(&self) -> Markup {
        html! {
            figure.chart style="margin-inline:0" {
                figcaption { (self.title) }
                ol.chain {
                    @for beside in [false, true] {
                        @for station in self.stations.iter().filter(|station| station.beside == beside) { (station.render()) }
                    }
                }
            }
        }
    }
}

impl Station {
    fn render(&self) -> Markup {
        let marked = match (self.marks.is_empty(), self.doubts.is_empty()) {
            (false, _) => Some("mark"),
            (true, false) => Some("perhaps"),
            (true, true) => None,
        };
        let classes: Vec<&str> = marked
            .into_iter()
            .chain(self.beside.then_some("beside"))
            .collect();
        let class = (!classes.is_empty()).then(|| classes.join(" "));
        html! {
            li class=[class] {
                b { (self.name) }
                span { (self.words) }
                @for why in &self.marks { strong { (why) } }
                @for why in &self.doubts { em { (why) } }
            }
        }
    }
}
