//! The page: what matters first, then the evidence.

use std::path::{Path, PathBuf};

use maud::{DOCTYPE, Markup, PreEscaped, html};
use thiserror::Error;

use super::colour::COLOURS;
use super::prose::prose;
use super::{Bars, Chain, Chart, Figure, Table};

/// The script of uPlot, which draws the charts.
pub const UPLOT_SCRIPT: &str = include_str!("../assets/uplot-1.6.32/uPlot.iife.min.js");
/// The style sheet of uPlot.
pub const UPLOT_STYLE: &str = include_str!("../assets/uplot-1.6.32/uPlot.min.css");
const UPLOT_LICENCE: &str = include_str!("../assets/uplot-1.6.32/LICENSE");
const SCRIPT: &str = include_str!("../assets/report.js");
const PLACED: &str = include_str!("../assets/placed.js");
const ROWS: &str = include_str!("../assets/rows.js");
const RULED: &str = include_str!("../assets/ruled.js");
const LISTED: &str = include_str!("../assets/listed.js");
const FRAME: &str = include_str!("../assets/frame.js");
/// The style sheet of every page.
pub const STYLE: &str = include_str!("../assets/report.css");

/// Forbids every request: the page has all it needs.
const POLICY: &str = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; \
                      base-uri 'none'; form-action 'none'";

/// Why a page could not be written.
#[derive(Debug, Error)]
#[error("cannot write the report {}: {source}", path.display())]
pub struct ReportError {
    /// The file.
    pub path: PathBuf,
    /// The system's error.
    pub source: std::io::Error,
}

/// How the verdict is meant; shown by a sign and a colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The goal is met.
    Good,
    /// The goal is missed, or something needs attention.
    Bad,
    /// A finding that is neither.
    Plain,
}

impl Verdict {
    /// Its class and its sign.
    fn shown(self) -> (&'static str, &'static str) {
        match self {
            Self::Good => ("good", "\u{2713}"),
            Self::Bad => ("bad", "!"),
            Self::Plain => ("plain", "\u{2192}"),
        }
    }
}

#[derive(Clone, Debug, PartialEq)]
enum Block {
    Heading(String),
    Text(String),
    Table(Table),
    Chart(Chart),
    Bars(Bars),
    Chain(Chain),
    Fold(String, &'static str),
}

/// A report; see the [module](super).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Page {
    title: String,
    subtitle: String,
    verdict: Option<(Verdict, String)>,
    figures: Vec<Figure>,
    blocks: Vec<Block>,
    footnotes: Vec<String>,
    curves: Vec<String>,
}

impl Page {
    /// An empty page.
    pub fn new(title: impl Into<String>) -> Self {
        Self {
            title: title.into(),
            ..Self::default()
        }
    }

    /// A quiet line below the title: of what, with what.
    pub fn subtitle(mut self, subtitle: impl Into<String>) -> Self {
        self.subtitle = subtitle.into();
        self
    }

    /// The answer in one sentence, at the top.
    pub fn verdict(mut self, verdict: Verdict, sentence: impl Into<String>) -> Self {
        self.verdict = Some((verdict, sentence.into()));
        self
    }

    /// Adds a key figure below the verdict; four to six read best.
    pub fn figure(mut self, figure: Figure) -> Self {
        self.figures.push(figure);
        self
    }

    /// Adds key figures below the verdict.
    pub fn figures(mut self, figures: impl IntoIterator<Item = Figure>) -> Self {
        self.figures.extend(figures);
        self
    }

    /// Names of curves that take the first colours, so that they have the same on every page of a kind.
    pub fn curves(mut self, names: impl IntoIterator<Item = impl Into<String>>) -> Self {
        self.curves.extend(names.into_iter().map(Into::into));
        self
    }

    /// Begins a section.
    pub fn heading(self, heading: impl Into<String>) -> Self {
        self.push(Block::Heading(heading.into()))
    }

    /// Adds a paragraph.
    pub fn text(self, text: impl Into<String>) -> Self {
        self.push(Block::Text(text.into()))
    }

    /// Adds a table.
    pub fn table(self, table: Table) -> Self {
        self.push(Block::Table(table))
    }

    /// Adds a chart.
    pub fn chart(self, chart: Chart) -> Self {
        self.push(Block::Chart(chart))
    }

    /// Adds a bar chart.
    pub fn bars(self, bars: Bars) -> Self {
        self.push(Block::Bars(bars))
    }

    /// Adds a row of stations.
    pub fn chain(self, chain: Chain) -> Self {
        self.push(Block::Chain(chain))
    }

    /// Adds what is read on demand: one line that opens on HTML of the program's own. It is not escaped.
    pub fn fold(self, line: impl Into<String>, html: &'static str) -> Self {
        self.push(Block::Fold(line.into(), html))
    }

    /// Adds a line at the foot of the page: the command, the seed, the files it came from.
    pub fn footnote(mut self, footnote: impl Into<String>) -> Self {
        self.footnotes.push(footnote.into());
        self
    }

    /// Writes the page to a file.
    ///
    /// # Errors
    /// [`ReportError`] with the file's name and what the system said.
    pub fn write(&self, path: impl AsRef<Path>) -> Result<(), ReportError> {
        let path = path.as_ref();
        std::fs::write(path, self.render()).map_err(|source| ReportError {
            path: path.into(),
            source,
        })
    }

    /// The page as HTML, complete in itself.
    pub fn render(&self) -> String {
        let colours = self.colours();
        let slot = |name: &str| {
            colours
                .iter()
                .find(|known| known.0 == name)
                .map(|known| known.1)
        };
        let page = html! {
            (DOCTYPE)
            html lang="en" {
                head {
                    meta charset="utf-8";
                    meta http-equiv="Content-Security-Policy" content=(POLICY);
                    meta name="viewport" content="width=device-width, initial-scale=1";
                    title { (self.title) }
                    style { (PreEscaped(UPLOT_STYLE)) "\n" (PreEscaped(STYLE)) }
                }
                body {
                    main {
                        (self.render_head())
                        (self.render_blocks(&slot))
                        (self.render_foot())
                    }
                    (self.render_curves(&|name| slot(name).unwrap_or(0)))
                    script { (PreEscaped(FRAME)) (PreEscaped(LISTED)) }
                }
            }
        };
        page.into_string()
    }

    fn push(mut self, block: Block) -> Self {
        self.blocks.push(block);
        self
    }

    fn charts(&self) -> Vec<&Chart> {
        let mut charts = Vec::new();
        for block in &self.blocks {
            if let Block::Chart(chart) = block {
                charts.push(chart);
            }
        }
        charts
    }

    /// Names that appear together in each chart.
    fn companies(&self) -> impl Iterator<Item = Vec<&str>> {
        self.blocks.iter().map(|block| match block {
            Block::Chart(chart) => chart.names().collect(),
            Block::Bars(bars) => bars.names().collect(),
            _ => Vec::new(),
        })
    }

    /// The colour of each curve's name: one of its own while there are any, then one that no curve
    /// in the same chart has, then any (the script changes the dashes).
    fn colours(&self) -> Vec<(&str, usize)> {
        let mut colours: Vec<(&str, usize)> = Vec::new();
        let first = self.curves.iter().map(String::as_str);
        for name in first.chain(self.companies().flatten()) {
            if colours.iter().any(|(known, _)| *known == name) {
                continue;
            }
            let taken_beside = |slot: usize| {
                let holder = |other: &&str| colours.contains(&(*other, slot));
                self.companies()
                    .any(|names| names.contains(&name) && names.iter().any(holder))
            };
            let own = Some(colours.len()).filter(|&slot| slot < COLOURS);
            let free = || (0..COLOURS).find(|&slot| !taken_beside(slot));
            let slot = own.or_else(free).unwrap_or(colours.len());
            colours.push((name, slot));
        }
        colours
    }

    fn render_head(&self) -> Markup {
        html! {
            h1 { (self.title) }
            @if !self.subtitle.is_empty() { p.subtitle { (self.subtitle) } }
            @if let Some((verdict, sentence)) = &self.verdict {
                @let (class, sign) = verdict.shown();
                p class={"verdict " (class)} {
                    b aria-hidden="true" { (sign) }
                    span { (prose(sentence)) }
                }
            }
            @if !self.figures.is_empty() {
                dl.figures { @for figure in &self.figures { (figure.render()) } }
            }
        }
    }

    fn render_blocks(&self, slot: &dyn Fn(&str) -> Option<usize>) -> Markup {
        let mut plots = 0..;
        let mut render = |block: &Block| match block {
            Block::Heading(heading) => html! { h2 { (heading) } },
            Block::Text(text) => html! { p { (prose(text)) } },
            Block::Table(table) => table.render(slot),
            Block::Bars(bars) => bars.render(slot),
            Block::Chain(chain) => chain.render(),
            Block::Chart(chart) => chart.render(plots.next().unwrap_or(0)),
            Block::Fold(line, html) => {
                html! { details.fold { summary { (line) } (PreEscaped(*html)) } }
            }
        };
        html! { @for block in &self.blocks { (render(block)) "\n" } }
    }

    /// The curves' data, and the scripts that draw them.
    fn render_curves(&self, slot: &dyn Fn(&str) -> usize) -> Markup {
        let curves: Vec<_> = self.charts().iter().map(|chart| chart.json(slot)).collect();
        let licence = format!("<!--\nuPlot 1.6.32\n{UPLOT_LICENCE}\n-->");
        html! {
            @if !curves.is_empty() {
                noscript { p.note { "The curves need JavaScript." } }
                script type="application/json" id="curves" {
                    // Each has its `<` spelled out.
                    "[" (PreEscaped(curves.join(","))) "]"
                }
                (PreEscaped(licence))
                script { (PreEscaped(UPLOT_SCRIPT)) }
                script { (PreEscaped(PLACED)) (PreEscaped(ROWS)) (PreEscaped(RULED)) (PreEscaped(SCRIPT)) }
            }
        }
    }

    fn render_foot(&self) -> Markup {
        html! {
            footer {
                @for footnote in &self.footnotes { p { (footnote) } }
                p { "Quell " (env!("CARGO_PKG_VERSION")) }
            }
        }
    }
}
