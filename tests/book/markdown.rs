//! What a Markdown file holds: links, anchors of its headings, and blocks of code.

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};
use std::ops::Range;

/// A block of code.
pub struct Block {
    /// The words behind the fence, as `toml` and `model`.
    pub words: Vec<String>,
    /// Its text.
    pub text: String,
    /// Where its text is in the file.
    pub range: Range<usize>,
    /// Its first line, from 1.
    pub line: usize,
}

impl Block {
    pub fn is(&self, word: &str) -> bool {
        self.words.iter().any(|held| held == word)
    }
}

/// A link or a picture.
pub struct Link {
    pub to: String,
    pub line: usize,
}

/// What was found in a file.
#[derive(Default)]
pub struct Page {
    pub links: Vec<Link>,
    pub anchors: Vec<String>,
    pub blocks: Vec<Block>,
}

fn line(text: &str, offset: usize) -> usize {
    1 + text[..offset].matches('\n').count()
}

/// Reads a file.
pub fn read(text: &str) -> Page {
    let mut page = Page::default();
    let (mut heading, mut fence) = (None::<String>, None::<Block>);
    let parser = Parser::new_ext(text, Options::ENABLE_TABLES).into_offset_iter();
    for (event, range) in parser {
        match event {
            Event::Start(Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. }) => {
                page.links.push(Link {
                    to: dest_url.to_string(),
                    line: line(text, range.start),
                });
            }
            Event::Start(Tag::Heading { .. }) => heading = Some(String::new()),
            Event::End(TagEnd::Heading(_)) => {
                let slug = slug(&heading.take().unwrap_or_default());
                page.anchors.push(slug);
            }
            Event::Start(Tag::CodeBlock(CodeBlockKind::Fenced(info))) => {
                let words = info.split([',', ' ']).filter(|word| !word.is_empty());
                fence = Some(Block {
                    words: words.map(str::to_string).collect(),
                    text: String::new(),
                    range: range.clone(),
                    line: line(text, range.start),
                });
            }
            Event::End(TagEnd::CodeBlock) => page.blocks.extend(fence.take()),
            Event::Text(words) => match (&mut fence, &mut heading) {
                (Some(block), _) => {
                    if block.text.is_empty() {
                        block.range = range.clone();
                    }
                    block.range.end = range.end;
                    block.text.push_str(&words);
                }
                (None, Some(heading)) => heading.push_str(&words),
                (None, None) => {}
            },
            Event::Code(words) => {
                if let Some(heading) = &mut heading {
                    heading.push_str(&words);
                }
            }
            _ => {}
        }
    }
    page
}

/// The anchor of a heading, as mdBook and GitHub make it.
pub fn slug(heading: &str) -> String {
    let letters = heading.chars().filter_map(|letter| match letter {
        _ if letter.is_alphanumeric() || letter == '_' || letter == '-' => {
            Some(letter.to_ascii_lowercase())
        }
        _ if letter.is_whitespace() => Some('-'),
        _ => None,
    });
    letters.collect()
}
