//! The keys of a TOML text with their places, which errors of a file name.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// A key and its value in a text.
pub struct TomlKey {
    /// The key with its tables, as `joint[1].damping_ratio`; tables of a list are counted from 1.
    pub path: String,
    /// Whether the value is a table.
    pub is_table: bool,
    /// The key's bytes.
    pub key: Range<usize>,
    /// The value's bytes.
    pub value: Range<usize>,
}

/// All keys of a text. Of a text that is no TOML these are the keys that can be made out.
pub fn toml_keys(text: &str) -> Vec<TomlKey> {
    let mut keys = Vec::new();
    let (table, _) = DeTable::parse_recoverable(text);
    table_keys("", table.get_ref(), &mut keys);
    keys
}

/// The line of a key, counted from 1, by its path.
pub fn toml_line(text: &str, path: &str) -> Option<usize> {
    let keys = toml_keys(text);
    let key = keys.iter().find(|key| key.path == path)?;
    Some(line(text, key.key.start))
}

/// The line of a byte, counted from 1.
pub fn line(text: &str, byte: usize) -> usize {
    let before = text.as_bytes().get(..byte).unwrap_or(text.as_bytes());
    1 + before.iter().filter(|&&byte| byte == b'\n').count()
}

/// The column of a byte in its line, in characters counted from 1.
pub fn column(text: &str, byte: usize) -> usize {
    let before = text.get(..byte).unwrap_or(text);
    1 + before.chars().rev().take_while(|own| *own != '\n').count()
}

fn table_keys(above: &str, table: &DeTable, keys: &mut Vec<TomlKey>) {
    for (key, value) in table {
        let name: &str = key.get_ref();
        let path = match above {
            "" => name.to_owned(),
            _ => format!("{above}.{name}"),
        };
        value_keys(path, key.span(), value, keys);
    }
}

fn value_keys(path: String, key: Range<usize>, value: &Spanned<DeValue>, keys: &mut Vec<TomlKey>) {
    match value.get_ref() {
        DeValue::Table(table) => table_keys(&path, table, keys),
        DeValue::Array(array) => {
            let tables = array.iter().enumerate();
            for (index, one) in tables.filter(|(_, one)| one.get_ref().is_table()) {
                value_keys(format!("{path}[{}]", index + 1), one.span(), one, keys);
            }
        }
        _ => {}
    }
    keys.push(TomlKey {
        path,
        is_table: value.get_ref().is_table(),
        key,
        value: value.span(),
    });
}
