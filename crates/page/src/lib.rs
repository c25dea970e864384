#![doc = include_str!("../README.md")]

mod bars;
mod chain;
mod chart;
mod colour;
mod columns;
mod figure;
mod html;
mod page;
mod prose;
mod series;
mod table;
mod thin;

pub use bars::Bars;
pub use chain::Chain;
pub use chart::Chart;
pub use columns::columns;
pub use figure::Figure;
pub use html::{decimals_beside, digits, fixed, number, significant};
pub use page::{Page, ReportError, STYLE, UPLOT_SCRIPT, UPLOT_STYLE, Verdict};
pub use table::{Cell, Table};
