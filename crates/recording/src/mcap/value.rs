//! A message by its definition: its fields as values, and the path to one number in it.

use super::cdr::{Damage, Decoder};
use super::definition::{Count, Field, Kind, Layout, Number};

/// The type of a field.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'a> {
    Number(f64),
    Text(&'a str),
    Record(Vec<Value<'a>>),
    Numbers(Vec<f64>),
    Many(Vec<Value<'a>>),
    /// Not requested.
    Skipped,
}

/// The way to one number of a message, such as `position[0]`, `position[joint_1]` or `point.x`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Path {
    steps: Vec<Step>,
}

#[derive(Clone, Debug, PartialEq)]
enum Step {
    Field(usize),
    Index(usize),
    /// The element with this name in a sequence of names, which is the field of this index.
    Name(usize, String),
}

/// Fields with the names of the elements in the sequences beside them, as in `sensor_msgs/JointState`,
/// `trajectory_msgs/JointTrajectory` and `control_msgs/DynamicJointState`.
const NAMES: [&str; 3] = ["name", "joint_names", "names"];

impl Path {
    /// # Errors
    /// A sentence, where the message has no such number.
    pub(super) fn parse(text: &str, layout: &Layout) -> Result<Self, String> {
        let (mut steps, mut record) = (Vec::new(), Some(0));
        let mut is_number = false;
        for part in text.split('.') {
            let (name, brackets) = match part.strip_suffix(']').and_then(|p| p.split_once('[')) {
                Some((name, inside)) => (name, Some(inside)),
                None => (part, None),
            };
            let fields = record.map(|record: usize| &layout.records[record]);
            let fields =
                fields.ok_or_else(|| format!("there is nothing in a number: \"{part}\""))?;
            let index = fields.iter().position(|field| field.name == name);
            let index = index.ok_or_else(|| {
                let numbers = layout.numbers().join(", ");
                format!("there is no field \"{name}\"; its numbers are: {numbers}")
            })?;
            steps.push(Step::Field(index));
            steps.extend(element(&fields[index], brackets, fields)?);
            is_number = matches!(fields[index].kind, Kind::Number(_));
            record = match fields[index].kind {
                Kind::Record(inner) => Some(inner),
                _ => None,
            };
        }
        match is_number {
            true => Ok(Self { steps }),
            false => Err(format!(
                "it is no number; the numbers are: {}",
                layout.numbers().join(", ")
            )),
        }
    }

    /// The number; `None` if this message does not have the element of that name.
    ///
    /// # Errors
    /// A sentence, where a sequence ends before the element.
    pub(super) fn pick(&self, message: &Value) -> Result<Option<f64>, String> {
        let (mut value, mut beside): (_, &[Value]) = (message, &[]);
        for step in &self.steps {
            let index = match (step, value) {
                (Step::Field(index), Value::Record(fields)) => {
                    beside = fields;
                    value = fields.get(*index).unwrap_or(&Value::Skipped);
                    continue;
                }
                (Step::Field(_), _) => break,
                (Step::Index(index), _) => *index,
                (Step::Name(names, name), _) => match position(beside.get(*names), name) {
                    Some(index) if index < value.len() => index,
                    _ => return Ok(None),
                },
            };
            let short = || format!("it has {} elements in this message", value.len());
            match value {
                Value::Numbers(numbers) => {
                    return numbers.get(index).map(|n| Some(*n)).ok_or_else(short);
                }
                Value::Many(many) => value = many.get(index).ok_or_else(short)?,
                _ => break,
            }
        }
        match value {
            Value::Number(number) => Ok(Some(*number)),
            _ => Err("it is no number".into()),
        }
    }

    /// Indices of the message's fields that must be read for this path.
    pub(super) fn roots(&self) -> impl Iterator<Item = usize> {
        self.steps.iter().take(2).filter_map(|step| match step {
            Step::Field(index) | Step::Name(index, _) => Some(*index),
            Step::Index(_) => None,
        })
    }
}

/// The step into a field's brackets, if it has any.
fn element(
    field: &Field,
    brackets: Option<&str>,
    beside: &[Field],
) -> Result<Option<Step>, String> {
    let name = &field.name;
    let Some(inside) = brackets else {
        return match field.count {
            Count::One => Ok(None),
            _ => Err(format!("\"{name}\" holds many: say which, as in {name}[0]")),
        };
    };
    if field.count == Count::One {
        return Err(format!("\"{name}\" holds one value, it takes no brackets"));
    }
    if let Ok(index) = inside.parse() {
        return Ok(Some(Step::Index(index)));
    }
    match beside.iter().position(is_names) {
        Some(names) => Ok(Some(Step::Name(names, inside.into()))),
        None => Err(format!(
            "\"{inside}\" is no number, and beside \"{name}\" there are no names"
        )),
    }
}

fn position(names: Option<&Value>, name: &str) -> Option<usize> {
    match names {
        Some(Value::Many(names)) => names.iter().position(|n| *n == Value::Text(name)),
        _ => None,
    }
}

impl Value<'_> {
    fn len(&self) -> usize {
        match self {
            Self::Numbers(numbers) => numbers.len(),
            Self::Many(many) => many.len(),
            _ => 1,
        }
    }
}

/// Reads the `wanted` fields of a message, in their places; the others are skipped.
///
/// # Errors
/// [`Damage`] where the bytes are not as the definition says.
pub(super) fn message<'a>(
    layout: &Layout,
    bytes: &'a [u8],
    wanted: &[usize],
) -> Result<Value<'a>, Damage> {
    let mut from = Decoder::new(bytes)?;
    // What follows the last field that is wanted need not be looked at.
    let last = wanted.iter().copied().max().unwrap_or(0);
    let fields = layout.records[0].iter().enumerate().take(last + 1);
    let values = fields.map(|(index, field)| {
        let keep = wanted.contains(&index);
        read(layout, field, &mut from, keep)
    });
    Ok(Value::Record(values.collect::<Result<_, _>>()?))
}

fn read<'a>(
    layout: &Layout,
    field: &Field,
    from: &mut Decoder<'a>,
    keep: bool,
) -> Result<Value<'a>, Damage> {
    let count = match field.count {
        Count::One => return one(layout, &field.kind, from, keep),
        Count::Array(count) => count,
        Count::Sequence => from.length()?,
    };
    // No element is smaller, so that no length in a damaged file takes more memory than the file has.
    let least = match field.kind {
        Kind::Number(number) => number.size(),
        Kind::Text => 4,
        _ => 1,
    };
    if count.saturating_mul(least) > from.left() {
        let left = from.left();
        let what = format!(
            "\"{}\" has {count} elements, {left} bytes are there",
            field.name
        );
        return Err(from.damage(what));
    }
    if let Kind::Number(number) = field.kind {
        return numbers(number, count, from, keep);
    }
    let mut many = Vec::new();
    for _ in 0..count {
        let value = one(layout, &field.kind, from, keep)?;
        if keep {
            many.push(value);
        }
    }
    Ok(Value::Many(many))
}

fn numbers<'a>(
    number: Number,
    count: usize,
    from: &mut Decoder,
    keep: bool,
) -> Result<Value<'a>, Damage> {
    if keep {
        let numbers = (0..count).map(|_| number.read(from));
        return Ok(Value::Numbers(numbers.collect::<Result<_, _>>()?));
    }
    if count > 0 {
        number.read(from)?;
        from.bytes((count - 1) * number.size())?;
    }
    Ok(Value::Skipped)
}

fn one<'a>(
    layout: &Layout,
    kind: &Kind,
    from: &mut Decoder<'a>,
    keep: bool,
) -> Result<Value<'a>, Damage> {
    match kind {
        Kind::Number(number) => Ok(Value::Number(number.read(from)?)),
        Kind::Text => Ok(Value::Text(from.string()?)),
        Kind::Unread(name) => Err(from.damage(format!("the type {name} is not read"))),
        Kind::Record(index) => {
            let fields = &layout.records[*index];
            if fields.is_empty() {
                // A structure without members has a byte that stands for one.
                from.bytes(1)?;
            }
            let values = fields.iter().map(|field| read(layout, field, from, keep));
            let values = values.collect::<Result<_, _>>()?;
            Ok(if keep {
                Value::Record(values)
            } else {
                Value::Skipped
            })
        }
    }
}

/// The names that stand beside a message's values, as in a joint state; empty where there are none.
pub(super) fn names(layout: &Layout, bytes: &[u8]) -> Vec<String> {
    let field = layout.records[0].iter().position(is_names);
    let value = field.and_then(|field| {
        let Ok(Value::Record(mut fields)) = message(layout, bytes, &[field]) else {
            return None;
        };
        fields.pop()
    });
    match value {
        Some(Value::Many(names)) => names
            .into_iter()
            .filter_map(|name| match name {
                Value::Text(text) => Some(text.to_owned()),
                _ => None,
            })
            .collect(),
        _ => Vec::new(),
    }
}

/// Whether a field has the names of what stands in the sequences beside it.
fn is_names(field: &Field) -> bool {
    NAMES.contains(&&*field.name) && field.kind == Kind::Text && field.count != Count::One
}
