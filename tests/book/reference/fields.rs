//! The fields of a struct, with type and sentence, from its source.

use super::super::root;
use super::{plain, table};
use quote::ToTokens;
use syn::{Attribute, Fields, Item, Lit, Meta, Type};

/// Sources in which structs are looked up, read once.
pub struct Sources(Vec<Item>);

impl Sources {
    pub fn of(files: &[&str]) -> Self {
        let read = |file: &&str| {
            let text = std::fs::read_to_string(root().join(file)).unwrap();
            syn::parse_file(&text).unwrap().items
        };
        Self(files.iter().flat_map(read).collect())
    }

    /// A struct's sentence and the table of its fields. What may be left out says so.
    pub fn fields(&self, name: &str) -> String {
        let found = self.0.iter().find_map(|item| match item {
            Item::Struct(held) if held.ident == name => Some(held),
            _ => None,
        });
        let held = found.unwrap_or_else(|| panic!("no struct {name}"));
        let Fields::Named(fields) = &held.fields else {
            panic!("{name} has no names");
        };
        let rows = fields.named.iter().map(|field| {
            let name =
                renamed(&field.attrs).unwrap_or_else(|| field.ident.as_ref().unwrap().to_string());
            let (kind, optional) = kind(&field.ty);
            let optional = optional || says(&field.attrs, "default");
            let needed = if optional { "" } else { "yes" };
            [
                format!("`{name}`"),
                kind,
                needed.into(),
                sentence(&field.attrs),
            ]
        });
        let keys = table(["key", "type", "always", "what"], rows);
        format!("{}\n\n{keys}", sentence(&held.attrs))
    }

    /// The sentences of the constants of a type, in their order.
    pub fn constants(&self, of: &str) -> Vec<String> {
        let held = self.0.iter().filter_map(|item| match item {
            Item::Const(held) if held.ty.to_token_stream().to_string() == of => Some(held),
            _ => None,
        });
        held.map(|held| plain(&lines(&held.attrs).join("\n")))
            .collect()
    }

    /// The variants of an enum as they stand in files.
    pub fn variants(&self, name: &str) -> String {
        let found = self.0.iter().find_map(|item| match item {
            Item::Enum(held) if held.ident == name => Some(held),
            _ => None,
        });
        let held = found.unwrap_or_else(|| panic!("no enum {name}"));
        let rows = held.variants.iter().map(|variant| {
            [
                format!("`{}`", snake(&variant.ident.to_string())),
                sentence(&variant.attrs),
            ]
        });
        format!(
            "{}\n\n{}",
            sentence(&held.attrs),
            table(["name", "what"], rows)
        )
    }
}

fn snake(name: &str) -> String {
    let mut snake = String::new();
    for letter in name.chars() {
        if letter.is_uppercase() && !snake.is_empty() {
            snake.push('_');
        }
        snake.push(letter.to_ascii_lowercase());
    }
    snake
}

fn sentence(attributes: &[Attribute]) -> String {
    plain(&lines(attributes).join(" "))
}

fn lines(attributes: &[Attribute]) -> Vec<String> {
    let lines = attributes
        .iter()
        .filter_map(|attribute| match &attribute.meta {
            Meta::NameValue(pair) if pair.path.is_ident("doc") => match &pair.value {
                syn::Expr::Lit(value) => match &value.lit {
                    Lit::Str(text) => Some(text.value().trim().to_string()),
                    _ => None,
                },
                _ => None,
            },
            _ => None,
        });
    lines.collect()
}

/// The tokens of serde's attribute.
fn serde(attributes: &[Attribute]) -> String {
    let all = attributes
        .iter()
        .filter(|attribute| attribute.path().is_ident("serde"));
    all.map(|attribute| attribute.meta.to_token_stream().to_string())
        .collect()
}

fn says(attributes: &[Attribute], word: &str) -> bool {
    serde(attributes).contains(word)
}

fn renamed(attributes: &[Attribute]) -> Option<String> {
    let text = serde(attributes);
    let rest = text.split_once("rename = \"")?.1;
    Some(rest.split_once('"')?.0.to_string())
}

/// A type in words, and whether the field may be left out.
fn kind(of: &Type) -> (String, bool) {
    let text = of.to_token_stream().to_string().replace(' ', "");
    let optional = text.starts_with("Option<");
    let inner = ["Option<", "Spanned<", "Box<"];
    let mut bare = text.as_str();
    while let Some(start) = inner.iter().find(|start| bare.starts_with(**start)) {
        bare = &bare[start.len()..bare.len() - 1];
    }
    (words(bare), optional)
}

fn words(bare: &str) -> String {
    if let Some(inner) = bare.strip_prefix("Vec<") {
        return format!("list of {}", words(inner.trim_end_matches('>')));
    }
    if let Some((inner, count)) = bare
        .strip_prefix('[')
        .and_then(|rest| rest.trim_end_matches(']').split_once(';'))
    {
        return match words(inner).strip_suffix("number") {
            Some(before) => format!("{count} {before}numbers"),
            None => format!("{count} of {}", words(inner)),
        };
    }
    match bare {
        "f64" => "number".into(),
        "usize" | "u64" | "u32" => "whole number".into(),
        "bool" => "true or false".into(),
        "char" => "one letter".into(),
        "String" | "PathBuf" => "text".into(),
        "Rows" => "2 whole numbers".into(),
        other => match other.strip_prefix("BTreeMap<String,") {
            Some(inner) => format!("table of {} by name", words(inner.trim_end_matches('>'))),
            None => {
                let name = other.trim_end_matches("Keys");
                match name {
                    // As the page calls the entry of a manifest.
                    "Entry" => "[Channel](#channel)".into(),
                    "Layout" => "[Csv](#csv)".into(),
                    "Damping" => "`across_joint` or `to_ground`".into(),
                    name => format!("[{name}](#{})", name.to_lowercase()),
                }
            }
        },
    }
}
