//! The cells of a line, and what marks a comment.

/// Marks of comments of one letter; two strokes are one, too, while one begins a path.
const MARKS: [char; 2] = ['#', '%'];
const STROKES: &str = "//";

/// Whether a line is a comment.
pub fn is_marked(line: &str) -> bool {
    let line = line.trim_start();
    line.starts_with(MARKS) || line.starts_with(STROKES)
}

/// A header without the mark of a comment.
pub fn unmarked(line: &str) -> &str {
    let line = line.trim_start();
    match line.starts_with(STROKES) {
        true => line.trim_start_matches('/'),
        false => line.trim_start_matches(MARKS),
    }
}

/// The cells of a line.
pub fn split(line: &str, delimiter: char) -> Vec<&str> {
    match delimiter {
        ' ' => line.split_whitespace().collect(),
        // A separator within quotes is none.
        _ => {
            let mut quoted = false;
            let is_end = |letter: char| {
                quoted ^= letter == '"';
                letter == delimiter && !quoted
            };
            let cells = line.split(is_end);
            cells.map(|cell| cell.trim().trim_matches('"')).collect()
        }
    }
}

/// Whether a cell is a number by this decimal mark.
pub fn is_number(cell: &str, decimal: char) -> bool {
    match decimal {
        ',' => !cell.contains('.') && cell.replace(',', ".").parse::<f64>().is_ok(),
        _ => cell.parse::<f64>().is_ok(),
    }
}
