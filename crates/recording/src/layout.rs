//! The form of a CSV file, where it is not a plain one.

use serde::Deserialize;
use std::collections::BTreeMap;

/// `[csv]`: how a CSV file is written, where it is not a header with rows of numbers. For Parquet only `missing` and `only` apply.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layout {
    /// Separator of the cells: `,`, `;`, a tab, `|`, or a space for any number of them; where absent the one that the
    /// header has most of.
    pub delimiter: Option<char>,
    /// Decimal mark, `.` or `,`; a point where absent.
    pub decimal: Option<char>,
    /// Lines that begin with it are left out. Of them the last above the numbers may be the header.
    pub comment: Option<char>,
    /// Lines above the header that are left out; 0 where absent.
    pub skip: Option<usize>,
    /// Whether there is a header; without one the columns are called `1`, `2`, `3`. True where absent.
    pub header: Option<bool>,
    /// Cells that say that there is no sample, such as `["", "NaN"]`; where absent there is none.
    pub missing: Option<Vec<String>>,
    /// Only rows with these cells, such as `{ test = "3" }`, where a file has several tests.
    pub only: Option<BTreeMap<String, String>>,
}

/// Possible separators of a file. Of equals the last wins, so that a header without any counts as
/// comma-separated.
pub(super) const DELIMITERS: [char; 5] = ['|', ' ', '\t', ';', ','];

impl Layout {
    /// The separator: the given one, else the most frequent one of tab, `;` and `,` in the header.
    pub(super) fn delimiter_of(&self, header: &str) -> char {
        let count = |delimiter: &char| header.matches(*delimiter).count();
        let usual = DELIMITERS.into_iter().skip(2).max_by_key(count);
        self.delimiter.or(usual).unwrap_or(',')
    }

    /// Whether a cell marks a missing sample.
    pub(super) fn is_missing(&self, cell: &str) -> bool {
        let cells = self.missing.as_deref().unwrap_or_default();
        cells.iter().any(|missing| missing == cell)
    }

    /// A cell as a number, with its decimal mark.
    pub(super) fn number(&self, cell: &str) -> Option<f64> {
        match self.decimal {
            Some(',') => cell.replace(',', ".").parse().ok(),
            _ => cell.parse().ok(),
        }
    }

    /// Whether a cell is a number but for separators of thousands, as `1,234.5`, `1.234,5`, `1'234` and `1 234`.
    pub(super) fn is_grouped(&self, cell: &str) -> bool {
        let decimal = self.decimal.unwrap_or('.');
        let is_mark =
            |letter: char| ",.'\u{2019} \u{a0}\u{202f}".contains(letter) && letter != decimal;
        let (whole, _) = cell.split_once(decimal).unwrap_or((cell, ""));
        let whole = whole.trim_start_matches(['-', '+']);
        let Some(mark) = whole.chars().find(|letter| is_mark(*letter)) else {
            return false;
        };
        let mut groups = whole.split(mark);
        let first = groups.next().map_or(0, str::len);
        let parted = (1..=3).contains(&first) && groups.all(|group| group.len() == 3);
        parted && self.number(&cell.replace(mark, "")).is_some()
    }

    /// The line with the names, counted from 0, and whether it is a comment; `None` without a header.
    pub(super) fn header_line(&self, text: &str) -> Option<usize> {
        if self.header == Some(false) {
            return None;
        }
        let lines = text.lines().enumerate().skip(self.skip.unwrap_or(0));
        let mut above = None;
        for (number, line) in lines.filter(|(_, line)| !line.trim().is_empty()) {
            if self.is_comment(line) {
                above = Some(number);
                continue;
            }
            // Numbers below a comment: the comment contains the names.
            return match above {
                Some(comment) if self.is_numbers(line) => Some(comment),
                _ => Some(number),
            };
        }
        above
    }

    /// Whether a line is left out.
    pub(super) fn is_comment(&self, line: &str) -> bool {
        let line = line.trim_start();
        self.comment.is_some_and(|mark| line.starts_with(mark))
    }

    /// Whether a line contains only numbers and missing cells.
    pub(super) fn is_numbers(&self, line: &str) -> bool {
        let delimiter = self.delimiter_of(line);
        let mut cells = line.split(delimiter).map(str::trim).peekable();
        let holds = |cell: &str| cell.is_empty() || self.number(cell).is_some();
        !line.trim().is_empty() && cells.all(holds)
    }
}
