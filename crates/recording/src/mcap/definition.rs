//! The definition of a message as in a `.msg` file of ROS 2, with the definitions of its parts.
//!
//! Source: ROS 2 documentation, "About ROS 2 interfaces", field types, names and constants; MCAP registry,
//! `ros2msg`: definitions are told apart by a line of 80 `=` and one `MSG: package/Type`.

use super::cdr::{Damage, Decoder};
use std::collections::HashMap;

/// Greatest depth of nested records; deeper ones would contain themselves.
const DEPTH: usize = 32;
/// Most names in a message to the user.
const SHOWN: usize = 40;

/// The type of one element of a field.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Kind {
    Number(Number),
    Text,
    /// Index into [`Layout::records`].
    Record(usize),
    /// A type that cannot be read, by its name.
    Unread(String),
}

/// The numbers of CDR.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Number {
    Bool,
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

/// Number of elements of a field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Count {
    One,
    /// An array; its length is not in the message.
    Array(usize),
    Sequence,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) struct Field {
    pub name: String,
    pub kind: Kind,
    pub count: Count,
}

/// The fields of a message; the first record is the message itself.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub records: Vec<Vec<Field>>,
}

impl Number {
    /// By its name in a `.msg` file.
    fn from_name(name: &str) -> Option<Self> {
        Some(match name {
            "bool" => Self::Bool,
            "int8" => Self::I8,
            "uint8" | "byte" | "char" => Self::U8,
            "int16" => Self::I16,
            "uint16" => Self::U16,
            "int32" => Self::I32,
            "uint32" => Self::U32,
            "int64" => Self::I64,
            "uint64" => Self::U64,
            "float32" => Self::F32,
            "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes, which are its alignment as well.
    pub(super) fn size(self) -> usize {
        match self {
            Self::Bool | Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    pub(super) fn read(self, from: &mut Decoder) -> Result<f64, Damage> {
        Ok(match self {
            Self::Bool => f64::from(u8::from(from.number::<1>()? != [0])),
            Self::I8 => i8::from_le_bytes(from.number()?).into(),
            Self::U8 => u8::from_le_bytes(from.number()?).into(),
            Self::I16 => i16::from_le_bytes(from.number()?).into(),
            Self::U16 => u16::from_le_bytes(from.number()?).into(),
            Self::I32 => i32::from_le_bytes(from.number()?).into(),
            Self::U32 => u32::from_le_bytes(from.number()?).into(),
            Self::I64 => i64::from_le_bytes(from.number()?) as f64,
            Self::U64 => u64::from_le_bytes(from.number()?) as f64,
            Self::F32 => f32::from_le_bytes(from.number()?).into(),
            Self::F64 => f64::from_le_bytes(from.number()?),
        })
    }
}

impl Layout {
    /// Reads the text of a `ros2msg` schema of the type `package/msg/Type`.
    ///
    /// # Errors
    /// A sentence with the line, counted from 1.
    pub(super) fn parse(name: &str, text: &str) -> Result<Self, String> {
        let mut layout = Self {
            records: Vec::new(),
        };
        let sections = sections(&short(name), text);
        let indices: HashMap<_, _> = (0..).zip(&sections).map(|(i, s)| (&*s.name, i)).collect();
        for section in &sections {
            let mut fields = Vec::new();
            for (number, line) in &section.lines {
                let field = field(line, &section.name, &indices);
                let at = |reason| format!("line {number} of the definition of {name}: {reason}");
                fields.extend(field.map_err(at)?);
            }
            layout.records.push(fields);
        }
        match layout.is_deep() {
            true => Err(format!("the definition of {name} holds itself")),
            false => Ok(layout),
        }
    }

    /// Whether records are nested deeper than `DEPTH`, as if one contains itself.
    fn is_deep(&self) -> bool {
        let mut heights = vec![0; self.records.len()];
        for _ in 0..=DEPTH {
            let height = |fields: &Vec<Field>| {
                let inner = fields.iter().map(|field| match field.kind {
                    Kind::Record(inner) => heights[inner],
                    _ => 0,
                });
                1 + inner.max().unwrap_or(0)
            };
            heights = self.records.iter().map(height).collect();
        }
        heights.iter().any(|height| *height > DEPTH)
    }

    /// Names of the fields with numbers, `[]` for sequences, for a message to the user.
    pub(super) fn numbers(&self) -> Vec<String> {
        let mut names = Vec::new();
        self.collect(0, "", &self.hold_numbers(), &mut names);
        names
    }

    /// For each record, whether it contains a number at any depth.
    fn hold_numbers(&self) -> Vec<bool> {
        let mut known = vec![false; self.records.len()];
        for _ in 0..=DEPTH {
            let holds = |field: &Field| match field.kind {
                Kind::Number(_) => true,
                Kind::Record(inner) => known[inner],
                _ => false,
            };
            let records = self.records.iter();
            known = records.map(|fields| fields.iter().any(holds)).collect();
        }
        known
    }

    /// Visits only records with numbers: two records in each record, 32 deep, would be 2^32.
    fn collect(&self, record: usize, prefix: &str, holds: &[bool], names: &mut Vec<String>) {
        for field in &self.records[record] {
            if names.len() >= SHOWN {
                return;
            }
            let brackets = if field.count == Count::One { "" } else { "[]" };
            let name = format!("{prefix}{}{brackets}", field.name);
            match field.kind {
                Kind::Number(_) => names.push(name),
                Kind::Record(inner) if holds[inner] => {
                    self.collect(inner, &format!("{name}."), holds, names);
                }
                _ => {}
            }
        }
    }
}

/// The definition of one type.
struct Section<'a> {
    /// `package/Type`.
    name: String,
    /// Number and text of its lines.
    lines: Vec<(usize, &'a str)>,
}

/// `package/Type` of `package/msg/Type`.
fn short(name: &str) -> String {
    name.replacen("/msg/", "/", 1)
}

fn sections<'a>(name: &str, text: &'a str) -> Vec<Section<'a>> {
    let new = |name: &str| Section {
        name: short(name),
        lines: Vec::new(),
    };
    let mut sections = vec![new(name)];
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim();
        if let Some(name) = line.strip_prefix("MSG:") {
            sections.push(new(name.trim()));
        } else if let Some(section) = sections.last_mut()
            && !line.is_empty()
            && !line.starts_with("===")
        {
            section.lines.push((number, line));
        }
    }
    for time in ["Time", "Duration"] {
        let name = format!("builtin_interfaces/{time}");
        if sections.iter().all(|section| section.name != name) {
            sections.push(Section {
                name,
                lines: vec![(0, "int32 sec"), (0, "uint32 nanosec")],
            });
        }
    }
    sections
}

/// The field that a line declares; `None` for a constant.
fn field(
    line: &str,
    section: &str,
    indices: &HashMap<&str, usize>,
) -> Result<Option<Field>, String> {
    let (kind, rest) = line
        .split_once(char::is_whitespace)
        .ok_or_else(|| format!("\"{line}\" is no field"))?;
    let rest = rest.trim_start();
    let end = rest.find([' ', '\t', '"', '\'']).unwrap_or(rest.len());
    let (name, after) = rest.split_at(end);
    // A default value may hold anything; the sign of a constant comes first.
    if name.contains('=') || after.trim_start().starts_with('=') {
        return Ok(None);
    }
    let (element, count) = match kind
        .strip_suffix(']')
        .and_then(|kind| kind.rsplit_once('['))
    {
        None => (kind, Count::One),
        Some((element, length)) if length.is_empty() || length.starts_with("<=") => {
            (element, Count::Sequence)
        }
        Some((element, length)) => match length.parse() {
            Ok(length) if length > 0 => (element, Count::Array(length)),
            _ => return Err(format!("\"{kind}\" has no length above 0")),
        },
    };
    Ok(Some(Field {
        name: name.into(),
        kind: self::kind(element, section, indices)?,
        count,
    }))
}

fn kind(name: &str, section: &str, indices: &HashMap<&str, usize>) -> Result<Kind, String> {
    let name = name.split("<=").next().unwrap_or(name);
    if let Some(number) = Number::from_name(name) {
        return Ok(Kind::Number(number));
    }
    let package = section.split('/').next().unwrap_or_default();
    let full = match name {
        "string" => return Ok(Kind::Text),
        "wstring" => return Ok(Kind::Unread(name.into())),
        "time" | "duration" => {
            let (first, rest) = name.split_at(1);
            format!("builtin_interfaces/{}{rest}", first.to_uppercase())
        }
        "Header" => "std_msgs/Header".into(),
        _ if name.contains('/') => short(name),
        _ => format!("{package}/{name}"),
    };
    match indices.get(full.as_str()) {
        Some(&index) => Ok(Kind::Record(index)),
        None => Err(format!("the type \"{name}\" is not defined")),
    }
}
