//! The text of a CSV file and its lines.

use crate::error::{Problem, RecordingError, from_io};
use crate::layout::Layout;
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

/// The first two bytes of a gzip stream (RFC 1952).
const GZIP: [u8; 2] = [0x1f, 0x8b];

/// The first line with numbers of a file without a header.
pub fn first_row(text: &str, layout: &Layout) -> Option<usize> {
    let mut lines = text.lines().enumerate().skip(layout.skip.unwrap_or(0));
    let is_row = |line: &str| !line.trim().is_empty() && !layout.is_comment(line);
    lines
        .find(|(_, line)| is_row(line))
        .map(|(number, _)| number)
}

/// Start of a line, counted from 0; the end where there are fewer lines.
pub fn line_start(text: &str, line: usize) -> usize {
    let ends = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
    match line {
        0 => 0,
        line => ends
            .map(|(at, _)| at + 1)
            .nth(line - 1)
            .unwrap_or(text.len()),
    }
}

/// A text with single spaces between its cells.
pub fn single_spaces(text: &str) -> String {
    let mut spaced = String::with_capacity(text.len());
    for line in text.lines() {
        for (column, cell) in line.split_whitespace().enumerate() {
            if column > 0 {
                spaced.push(' ');
            }
            spaced.push_str(cell);
        }
        spaced.push('\n');
    }
    spaced
}

/// The text of a file, unpacked, without a byte order mark.
pub fn text(path: &Path) -> Result<String, RecordingError> {
    let bytes = bytes(path).map_err(|problem| problem.in_file(path))?;
    if let Some(format) = crate::foreign::of(path, &bytes) {
        return Err(Problem::Foreign(format).in_file(path));
    }
    if let Some(text) = utf_16(&bytes) {
        return text.ok_or_else(|| Problem::NotUtf8.in_file(path));
    }
    let mut text = String::from_utf8(bytes).or_else(|error| {
        let valid = &error.as_bytes()[..error.utf8_error().valid_up_to()];
        let refused = Problem::NotUtf8.at_line(path, 1 + count_line_ends(valid));
        latin_1(error.as_bytes()).ok_or(refused)
    })?;
    if let Some(marked) = text.strip_prefix('\u{feff}') {
        text.drain(..text.len() - marked.len());
    }
    Ok(match is_of_serial_monitor(&text) {
        true => without_arrows(&text),
        false => text,
    })
}

/// What stands between the time of day and what was printed, in a text from the serial monitor of Arduino.
const ARROW: &str = " -> ";

/// Whether each line is what the serial monitor of Arduino shows with its time stamps: `10:00:00.000 -> 0.31,9.81`.
fn is_of_serial_monitor(text: &str) -> bool {
    let is_stamp = |stamp: &str| {
        let parts: Vec<&str> = stamp.split([':', '.']).collect();
        let is_number = |part: &&str| part.bytes().all(|byte| byte.is_ascii_digit());
        parts.len() == 4 && parts.iter().all(is_number)
    };
    let is_one = |line: &str| line.split_once(ARROW).is_some_and(|own| is_stamp(own.0));
    let mut lines = text
        .lines()
        .filter(|line| !line.trim().is_empty())
        .peekable();
    lines.peek().is_some() && lines.all(is_one)
}

/// The same with the separator of what was printed in the place of each arrow.
fn without_arrows(text: &str) -> String {
    let marks = ['\t', ';', ',', ' '];
    let first = text.lines().find_map(|line| line.split_once(ARROW));
    let has = |mark: &char| first.is_some_and(|own| own.1.trim().contains(*mark));
    let mark = marks.into_iter().find(has).unwrap_or(',');
    text.replace(ARROW, &mark.to_string())
}

/// The text of bytes in UTF-16, by its byte order mark, without it; the inner `None` where they are no text.
fn utf_16(bytes: &[u8]) -> Option<Option<String>> {
    let unit: fn([u8; 2]) -> u16 = match bytes {
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => return None,
    };
    let pairs = bytes[2..].chunks_exact(2);
    let is_whole = pairs.remainder().is_empty();
    let units: Vec<u16> = pairs.map(|pair| unit([pair[0], pair[1]])).collect();
    Some(String::from_utf16(&units).ok().filter(|_| is_whole))
}

/// The text of bytes in ISO 8859-1, as written by older tools; `None` for bytes that do not occur in text.
fn latin_1(bytes: &[u8]) -> Option<String> {
    let is_text = |byte: &u8| matches!(byte, b'\t' | b'\n' | b'\r' | 0x20..=0x7e | 0xa0..=0xff);
    let all = bytes.iter().all(is_text);
    all.then(|| bytes.iter().map(|byte| char::from(*byte)).collect())
}

fn bytes(path: &Path) -> Result<Vec<u8>, Problem> {
    let mut bytes = Vec::new();
    let mut file = File::open(path).map_err(|error| from_io(&error))?;
    file.read_to_end(&mut bytes)
        .map_err(|error| from_io(&error))?;
    let is_named_gzip = path.extension().is_some_and(|extension| extension == "gz");
    if bytes.is_empty() || !(is_named_gzip || bytes.starts_with(&GZIP)) {
        return Ok(bytes);
    }
    let mut text = Vec::new();
    match MultiGzDecoder::new(bytes.as_slice()).read_to_end(&mut text) {
        Ok(_) => Ok(text),
        Err(error) if error.kind() == io::ErrorKind::UnexpectedEof => {
            Err(Problem::Gzip("it ends early, the file is cut off".into()))
        }
        Err(error) => Err(Problem::Gzip(error.to_string())),
    }
}

/// Number of line ends in some bytes.
pub fn count_line_ends(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte == b'\n').count()
}
