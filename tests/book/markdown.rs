//! What a Markdown file holds: links, anchors of its headings, and blocks of code.

use pulldown_cmark::{CodeBlockKind, Event, Options, Parser, Tag, TagEnd};

/// A block of code.
pub struct Block {
    /// The words behind the fence, as `toml` and `model`.
    pub words: Vec<String>,
    /// Its text.
    pub text: String,
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
    let mut reader = Reader {
        text,
        page: Page::default(),
        heading: None,
        fence: None,
    };
    for (event, range) in Parser::new_ext(text, Options::ENABLE_TABLES).into_offset_iter() {
        reader.take(event, range.start);
    }
    reader.page
}

/// What has been read, and what is open.
struct Reader<'a> {
    text: &'a str,
    page: Page,
    heading: Option<String>,
    fence: Option<Block>,
}

impl Reader<'_> {
    fn take(&mut self, event: Event, at: usize) {
        match event {
            Event::Start(tag) => self.start(tag, at),
            Event::End(TagEnd::Heading(_)) => {
                let heading = self.heading.take().unwrap_or_default();
                self.page.anchors.push(slug(&heading));
            }
            Event::End(TagEnd::CodeBlock) => self.page.blocks.extend(self.fence.take()),
            Event::Text(words) => self.words(&words),
            Event::Code(words) => {
                if let Some(heading) = &mut self.heading {
                    heading.push_str(&words);
                }
            }
            _ => {}
        }
    }

    fn start(&mut self, tag: Tag, at: usize) {
        let line = line(self.text, at);
        match tag {
            Tag::Link { dest_url, .. } | Tag::Image { dest_url, .. } => {
                let to = dest_url.to_string();
                self.page.links.push(Link { to, line });
            }
            Tag::Heading { .. } => self.heading = Some(String::new()),
            Tag::CodeBlock(kind) => {
                let info = match &kind {
                    CodeBlockKind::Fenced(info) => info,
                    CodeBlockKind::Indented => "",
                };
                let words = info.split([',', ' ']).filter(|word| !word.is_empty());
                let words = words.map(str::to_string).collect();
                self.fence = Some(Block {
                    words,
                    text: String::new(),
                    line,
                });
            }
            _ => {}
        }
    }

    fn words(&mut self, words: &str) {
        match (&mut self.fence, &mut self.heading) {
            (Some(block), _) => block.text.push_str(words),
            (None, Some(heading)) => heading.push_str(words),
            (None, None) => {}
        }
    }
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
