#![doc = include_str!("../README.md")]

mod atlas;
mod case;
mod findings;
mod follows;
mod happened;
mod head;
mod law;
mod motion;
mod next;
mod page;
mod place;
mod ranking;
mod record;
mod score;
mod shares;
mod shown;
#[cfg(test)]
mod tests;
mod text;
mod words;

pub use case::Case;
pub use page::{page, page_of};
pub use score::{judgement_lines, score_line};
pub use shown::Shown;
pub use text::text;
