//! What keeps a file from being one table of numbers, so that no other question about it has a meaning.

use super::column::{Bad, Column};
use super::columns::Channels;
use super::content::Content;
use super::roles;

/// Sentences on that, without a full stop; none for a file that can be read.
pub fn of(content: &Content, channels: &Channels) -> Vec<String> {
    let all = [
        restarted(content),
        grouped(content),
        listed(content),
        hexadecimal(content, channels),
        told_in_turn(content, channels),
    ];
    all.into_iter().flatten().take(1).collect()
}

/// On the first line that repeats the header: the logger was started again there.
fn restarted(content: &Content) -> Option<String> {
    let repeats = |column: &&Column| {
        let bad = column.bad.as_ref().filter(|_| column.is_mostly_numeric());
        bad.is_some_and(|bad| column.is_called(&bad.text))
    };
    let column = content.columns.iter().find(repeats)?;
    let place = &column.bad.as_ref()?.place;
    Some(format!(
        "{place} repeats the header: the logger was started again there; make a file of each part"
    ))
}

/// On rows that are of several sensors in turn, with their names in a column: the values below each other are of none.
fn told_in_turn(content: &Content, channels: &Channels) -> Option<String> {
    let (column, names) = in_turn(content, channels)?;
    let (called, first) = (&column.called, &names[0]);
    Some(format!(
        "the rows are of several sensors in turn, {:?} has {}: write a [[channel]] for each that you mean, with \
         csv = {{ only = {{ {called:?} = {first:?} }} }}",
        column.title,
        names.join(", ")
    ))
}

/// The column with the names of sensors whose rows stand in turn, and these.
pub fn in_turn<'a>(content: &'a Content, channels: &Channels) -> Option<(&'a Column, Vec<String>)> {
    let mut columns = content.columns.iter();
    let names = columns.find_map(|column| Some((column, column.in_turn()?)));
    names.filter(|_| channels.found.len() <= 1)
}

/// On the first number with a separator of thousands.
fn grouped(content: &Content) -> Option<String> {
    let of = |column: &Column| Some(told(column, column.grouped.as_ref()?));
    let mut all = content.columns.iter().filter_map(of);
    let first = all.next()?;
    Some(format!(
        "{first} has a separator of thousands{}: write the numbers without it, in the program that exports them or by a \
         replacement in the file",
        more(all.count())
    ))
}

/// On the first column whose cells are lists.
fn listed(content: &Content) -> Option<String> {
    let is_list = |column: &&Column| {
        let cell = column.first.as_str();
        column.texts == column.numbers.len() && cell.starts_with('[') && cell.ends_with(']')
    };
    let column = content.columns.iter().find(is_list)?;
    let (title, first) = (&column.title, &column.first);
    Some(format!(
        "the cells of {title:?} are lists, the first {first}: make a column of each element, called {:?} and so on, or give the \
         Parquet file if it is from one",
        format!("{title}[0]")
    ))
}

/// On the first column of hexadecimal numbers that may be meant; a word of status beside the channels is none.
fn hexadecimal(content: &Content, channels: &Channels) -> Option<String> {
    let is_meant = |index| channels.found.is_empty() || roles::role(content, index).is_some();
    let of = |(index, column): (usize, &Column)| {
        let column = is_meant(index).then_some(column)?;
        let bad = column.bad.as_ref().filter(|bad| bad.is_hexadecimal())?;
        Some(told(column, bad))
    };
    let mut all = content.columns.iter().enumerate().filter_map(of);
    let first = all.next()?;
    Some(format!(
        "{first} is hexadecimal{}: write the numbers as decimal ones, with their sign, in the program that exports them or by \
         a replacement in the file",
        more(all.count())
    ))
}

/// A cell with its place.
fn told(column: &Column, bad: &Bad) -> String {
    let (text, place, title) = (&bad.text, &bad.place, &column.title);
    format!("{text:?} in {place} of {title:?}")
}

/// How many columns are like the first.
fn more(others: usize) -> String {
    match others {
        0 => String::new(),
        1 => ", and another column like it".into(),
        n => format!(", and {n} more columns like it"),
    }
}
