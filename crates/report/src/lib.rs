//! One self-contained HTML page.
//!
//! A [`Page`] begins with what matters: its title, a verdict in one sentence, the key figures.
//! Tables, [`Chart`]s, [`Bars`] and [`Chain`]s follow in the order in which they are added. The page asks
//! nothing of the network (its content security policy forbids it), follows the reader's light or
//! dark scheme, fits a phone and prints.
//!
//! A curve keeps its colour over the whole page, by its name.
//!
//! # Example
//! ```
//! use quell_report::{Chart, Figure, Page, Table, Verdict};
//!
//! let (t, y) = ([0.0, 0.1, 0.2], [0.0, 0.74, 0.43]);
//! let html = Page::new("Joint 1 moves by 30 degrees")
//!     .verdict(Verdict::Good, "The adapted shaper leaves 0.6 % of the vibration.")
//!     .figure(Figure::new("residual vibration", 0.0044, "mm").note("0.74 mm unshaped"))
//!     .table(Table::new("The moves").text_column("move").column("residual", "mm").row(["unshaped".into(), 0.74.into()]))
//!     .chart(Chart::lines("Deformation", "time", "s", "deformation", "mm").series("unshaped", &t, &y))
//!     .render();
//! assert!(html.contains("0.0044"));
//! ```

mod bars;
mod chain;
mod chart;
mod figure;
mod html;
mod page;
mod series;
mod table;
mod thin;

pub use bars::Bars;
pub use chain::Chain;
pub use chart::Chart;
pub use figure::Figure;
pub use html::{fixed, number};
pub use page::{Page, ReportError, STYLE, UPLOT_SCRIPT, UPLOT_STYLE, Verdict};
pub use table::{Cell, Table};
