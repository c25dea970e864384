//! The layout of a CSV file from its first lines: separator, decimal mark, comments, header.

use super::super::layout::Layout;
use super::cells::{is_marked, is_number, split, unmarked};
use super::preamble::{self, is_property};
use super::titles::{is_units, joined, named, of_block, repeated};

/// Most lines that are read.
const LOOKED_AT: usize = 300;
/// Least share of numbers in the rows of a numeric column.
const MOST: f64 = 0.9;
/// Separators in order of preference, each with a decimal mark.
const FORMS: [(char, char); 8] = [
    (',', '.'),
    (';', '.'),
    (';', ','),
    ('\t', '.'),
    ('\t', ','),
    ('|', '.'),
    (' ', '.'),
    (' ', ','),
];

/// A layout, and the names above a row of units.
pub struct Form {
    /// The form.
    pub layout: Layout,
    /// Names of the columns, if the layout has no header because a row of units stands below it, or one name stands twice.
    pub names: Option<Vec<String>>,
    /// The step of the samples, if a line above the table tells it.
    pub step: Option<preamble::Step>,
}

/// The layout of a text; `None` without rows of numbers.
pub fn of(text: &str) -> Option<Form> {
    let lines: Vec<&str> = text.lines().take(LOOKED_AT).collect();
    let plain = |line: &&&str| !line.trim().is_empty() && !is_marked(line);
    let rows: Vec<&str> = lines.iter().filter(plain).copied().collect();
    // White space is a separator only where tabs are none: a preamble has cells of its own between tabs.
    let by_tabs = FORMS
        .iter()
        .any(|&(mark, decimal)| mark == '\t' && columns(&rows, mark, decimal) > 0);
    let score = |&(delimiter, decimal): &(char, char)| match delimiter == ' ' && by_tabs {
        true => 0,
        false => columns(&rows, delimiter, decimal),
    };
    // The first of equals is taken.
    let (delimiter, decimal) = FORMS.into_iter().rev().max_by_key(score)?;
    if columns(&rows, delimiter, decimal) == 0 {
        return None;
    }
    let mut layout = Layout {
        decimal: (decimal == ',').then_some(','),
        ..Layout::default()
    };
    let count = usual(rows.iter().map(|line| split(line, delimiter).len()));
    let first = first_row(&lines, &rows, (delimiter, decimal))?;
    let marked = |line: &&str| is_marked(line);
    let cells = |line: &str| split(unmarked(line), delimiter).len();
    let mut names = None;
    let mut above = (0..first)
        .rev()
        .filter(|&line| !lines[line].trim().is_empty())
        .peekable();
    // Properties may stand between the names and the numbers.
    let mut are_between = false;
    while above
        .next_if(|&line| is_property(lines[line], delimiter))
        .is_some()
    {
        are_between = true;
    }
    let header = above.next().filter(|&line| cells(lines[line]) == count);
    match header {
        None => layout.header = Some(false),
        Some(line) if is_units(lines[line], delimiter) => {
            // Names, then units: the columns are called by their numbers, with both as title.
            let over = above.next().filter(|&line| cells(lines[line]) == count);
            names = over.map(|over| joined(lines[over], lines[line], delimiter));
            layout.header = Some(false);
            layout.skip = Some(first);
        }
        Some(line) if (0..line).any(|l| !lines[l].trim().is_empty() && !marked(&lines[l])) => {
            layout.skip = Some(line);
        }
        Some(_) => {}
    }
    if let Some(line) = header.filter(|_| names.is_none()) {
        let over = (0..line).rev().map(|over| lines[over]);
        let over = over.filter(|over| cells(over) == count && !marked(over));
        names = of_block(lines[line], over, delimiter)
            .or_else(|| repeated(lines[line], delimiter))
            .or_else(|| are_between.then(|| named(lines[line], delimiter)));
        if names.is_some() {
            layout.header = Some(false);
            layout.skip = Some(first);
        }
    }
    // Without a header the first row of numbers tells the separator, which may have as many decimal commas.
    let top = match layout.header {
        Some(false) => lines[first],
        _ => rows[0],
    };
    layout.delimiter = (delimiter != layout.delimiter_of(top)).then_some(delimiter);
    let commented = lines.iter().enumerate().find(|(line, text)| {
        marked(text) && Some(*line) != header && layout.skip.is_none_or(|skip| *line >= skip)
    });
    // A `#` before the names is left out without being told.
    let named = header.map(|line| lines[line]);
    let named = named.filter(|line| marked(line) && !line.trim_start().starts_with('#'));
    let remark = named.or(commented.map(|(_, line)| *line));
    layout.comment = remark.and_then(|line| line.trim_start().chars().next());
    // RepRapFirmware ends its files with this.
    if text
        .trim_end()
        .lines()
        .last()
        .is_some_and(|line| line.starts_with("Rate "))
    {
        layout.comment = Some('R');
    }
    let step = preamble::step(&lines[..first], delimiter);
    Some(Form {
        layout,
        names,
        step,
    })
}

/// The first line of the table. Lines above it may contain numbers, too, `Writer_Version 2` or `X0 0.0 0.0`: a row has a
/// number, or nothing, in each column of numbers, and another one below it. A row above that is one but for some cells is of
/// the table as well: these are bad cells.
fn first_row(lines: &[&str], rows: &[&str], (delimiter, decimal): (char, char)) -> Option<usize> {
    let columns = numeric(rows, delimiter, decimal);
    let numbers = |line: &str| {
        let cells = split(line, delimiter);
        let of = cells
            .iter()
            .zip(&columns)
            .filter(|(_, is_numeric)| **is_numeric);
        let good = of
            .clone()
            .filter(|(cell, _)| is_number(cell, decimal))
            .count();
        let blank = of.filter(|(cell, _)| cell.is_empty()).count();
        (cells.len() == columns.len() && good > 0).then_some(good + blank)
    };
    let all = columns.iter().filter(|is_numeric| **is_numeric).count();
    let is_plain = |line: &&&str| rows.contains(line);
    let is_row = |line: &str| numbers(line) == Some(all) && !is_property(line, delimiter);
    let goes_on = |&line: &usize| {
        let below = lines[line + 1..].iter().find(is_plain);
        is_row(lines[line]) && below.is_none_or(|below| numbers(below).is_some())
    };
    let mut first = (0..lines.len()).find(goes_on)?;
    let mut above = (0..first).rev().filter(|&line| is_plain(&&lines[line]));
    while let Some(line) = above.next().filter(|&line| {
        let good = numbers(lines[line]);
        good.is_some_and(|good| 2 * good >= all) && !is_property(lines[line], delimiter)
    }) {
        first = line;
    }
    Some(first)
}

/// Rows times columns of numbers, by this separator and decimal mark.
fn columns(rows: &[&str], delimiter: char, decimal: char) -> usize {
    let numeric = numeric(rows, delimiter, decimal);
    let of_count = rows
        .iter()
        .filter(|line| split(line, delimiter).len() == numeric.len());
    of_count.count() * numeric.iter().filter(|is_numeric| **is_numeric).count()
}

/// Whether each column is one of numbers, by this separator and decimal mark.
fn numeric(rows: &[&str], delimiter: char, decimal: char) -> Vec<bool> {
    let cells: Vec<Vec<&str>> = rows.iter().map(|line| split(line, delimiter)).collect();
    let count = usual(cells.iter().map(Vec::len));
    let of_count: Vec<_> = cells.iter().filter(|row| row.len() == count).collect();
    let column = |column: usize| {
        let good = of_count
            .iter()
            .filter(|row| is_number(row[column], decimal));
        let blank = of_count.iter().filter(|row| row[column].is_empty());
        let good = good.count();
        let rows = of_count.len().saturating_sub(1).max(1);
        good > 0 && (good + blank.count()) as f64 >= MOST * rows as f64
    };
    (0..count).map(column).collect()
}

/// The most frequent number.
fn usual(counts: impl Iterator<Item = usize>) -> usize {
    let mut counts: Vec<usize> = counts.collect();
    counts.sort_unstable();
    let groups = counts.chunk_by(|a, b| a == b);
    groups
        .max_by_key(|group| group.len())
        .map_or(0, |group| group[0])
}
