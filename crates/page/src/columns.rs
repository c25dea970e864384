//! Tables as plain text.

use comfy_table::{CellAlignment, Table, presets};

/// Rows under a header, as plain text in columns: the first column to the left, the others, which
/// hold figures, to the right; two spaces between columns and none at the line's end.
pub fn columns<const N: usize>(
    header: [&str; N],
    rows: impl IntoIterator<Item = [String; N]>,
) -> String {
    let mut table = Table::new();
    table
        .load_preset(presets::NOTHING)
        .set_header(header)
        .add_rows(rows);
    for column in table.column_iter_mut() {
        let first = column.index == 0;
        column.set_padding((if first { 0 } else { 2 }, 0));
        column.set_cell_alignment(if first {
            CellAlignment::Left
        } else {
            CellAlignment::Right
        });
    }
    table.trim_fmt() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_are_aligned_and_lines_are_trimmed() {
        let rows = [["zv".into(), "0.061".into()], ["zvdd".into(), "0.2".into()]];
        let expected = "shaper  time_s\nzv       0.061\nzvdd       0.2\n";
        assert_eq!(columns(["shaper", "time_s"], rows), expected);
    }
}
