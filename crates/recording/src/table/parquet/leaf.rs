//! Columns of a file by its schema: name and form.

use parquet::basic::{ConvertedType, LogicalType, Repetition, Type as Physical};
use parquet::schema::types::{ColumnDescriptor, Type};

/// Column of the file: a number, or a list of numbers, in each row.
pub struct Leaf {
    /// Name; for lists without the `[0]` of an element.
    pub name: String,
    /// Index in the file.
    pub index: usize,
    /// Definition level of a value that is not null.
    pub there: i16,
    /// Least definition level of an element of a list, which may be null; `None` without lists. One level below, the list is
    /// empty; further below, it is null.
    pub element: Option<i16>,
    /// Whether integers are unsigned.
    pub is_unsigned: bool,
    /// Why it cannot be read, where it holds no numbers.
    pub refused: Option<String>,
}

impl Leaf {
    /// Column of a schema.
    pub fn of(index: usize, column: &ColumnDescriptor, schema: &Type) -> Self {
        let path = column.path().parts();
        let (name, element, inside) = located(path, schema);
        let refused = match column.max_rep_level() {
            0 => other_than_numbers(column),
            1 if inside => Some("each row holds a list of groups".into()),
            1 => other_than_numbers(column),
            _ => Some("each row holds a list of lists".into()),
        };
        Self {
            name,
            index,
            there: column.max_def_level(),
            element,
            is_unsigned: is_unsigned(column),
            refused,
        }
    }

    /// Whether a column of the text is made from this one.
    pub fn is_meant(&self, column: &str) -> bool {
        let name = match self.element {
            Some(_) => column
                .strip_suffix(']')
                .and_then(|column| column.rsplit_once('['))
                .map_or(column, |(name, _)| name),
            None => column,
        };
        name == self.name
    }
}

/// Name, least level of an element of a list, and whether the elements are groups.
///
/// A list is encoded as `name.list.element`; the name leaves out the last two.
fn located(path: &[String], schema: &Type) -> (String, Option<i16>, bool) {
    let (mut node, mut name, mut level) = (schema, Vec::new(), 0);
    let (mut element, mut inside) = (None, false);
    for (depth, part) in path.iter().enumerate() {
        let fields = if node.is_group() {
            node.get_fields()
        } else {
            &[]
        };
        let Some(next) = fields.iter().find(|field| field.name() == part) else {
            break;
        };
        node = next;
        let info = node.get_basic_info();
        let repetition = match info.has_repetition() {
            true => info.repetition(),
            false => Repetition::REQUIRED,
        };
        level += i16::from(repetition != Repetition::REQUIRED);
        let repeated = repetition == Repetition::REPEATED;
        if repeated && element.is_none() {
            element = Some(level);
            inside = node.is_group() && node.get_fields().len() != 1 || path.len() > depth + 2;
        }
        if element.is_none() || (repeated && depth == 0) {
            name.push(part.as_str());
        }
    }
    (name.join("."), element, inside)
}

/// Why a column cannot be read: it holds no numbers of 32 or 64 bits.
fn other_than_numbers(column: &ColumnDescriptor) -> Option<String> {
    let physical = column.physical_type();
    let no_number = match (column.logical_type_ref(), column.converted_type()) {
        (Some(LogicalType::Date), _) | (_, ConvertedType::DATE) => Some("dates"),
        (Some(LogicalType::Decimal(_)), _) | (_, ConvertedType::DECIMAL) => Some("decimals"),
        _ => match physical {
            Physical::BOOLEAN | Physical::INT32 | Physical::INT64 => None,
            Physical::FLOAT | Physical::DOUBLE => None,
            Physical::INT96 => Some("times of 96 bits"),
            Physical::BYTE_ARRAY => Some("texts or bytes"),
            Physical::FIXED_LEN_BYTE_ARRAY => Some("bytes"),
        },
    };
    no_number.map(|what| format!("it holds {what} ({physical}), not numbers of 32 or 64 bits"))
}

fn is_unsigned(column: &ColumnDescriptor) -> bool {
    use ConvertedType::{UINT_8, UINT_16, UINT_32, UINT_64};
    let logical =
        matches!(column.logical_type_ref(), Some(LogicalType::Integer(int)) if !int.is_signed);
    logical || [UINT_8, UINT_16, UINT_32, UINT_64].contains(&column.converted_type())
}
