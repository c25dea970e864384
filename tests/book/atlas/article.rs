//! A page of the atlas as reports carry it: HTML with its picture inside, and no link.

use pulldown_cmark::{Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

/// Colours of a picture, and those of the page that stand for them.
const COLOURS: [(&str, &str); 5] = [
    ("#333", "var(--ink)"),
    ("#fff", "var(--card)"),
    ("#999", "var(--quiet)"),
    ("#ddd", "var(--line)"),
    ("#0072b2", "var(--c0)"),
];

/// The page of an effect of this name, without its title.
pub fn article(name: &str, markdown: &str, svg: &str) -> String {
    let mut hidden = false;
    let events = Parser::new_ext(markdown, Options::ENABLE_TABLES);
    let events = events.filter_map(|event| match event {
        Event::Start(Tag::Image { .. }) => {
            hidden = true;
            Some(Event::InlineHtml(drawn(svg).into()))
        }
        Event::Start(Tag::Heading {
            level: HeadingLevel::H1,
            ..
        }) => {
            hidden = true;
            None
        }
        Event::End(TagEnd::Image | TagEnd::Heading(HeadingLevel::H1)) => {
            hidden = false;
            None
        }
        event => carried(event).filter(|_| !hidden),
    });
    let mut page = String::new();
    html::push_html(&mut page, events);
    format!(
        "<article id=\"{name}\">\n{page}<p class=\"note\">In the book: <code>docs/src/atlas/{name}.md</code></p>\n</article>\n"
    )
}

/// What a report has of it: the text of a link, headings of its own, no comments.
fn carried(event: Event) -> Option<Event> {
    Some(match event {
        Event::Start(Tag::Link { .. }) | Event::End(TagEnd::Link) | Event::Html(_) => return None,
        Event::Start(Tag::Heading { .. }) => Event::Html("<h3>".into()),
        Event::End(TagEnd::Heading(_)) => Event::Html("</h3>\n".into()),
        event => event,
    })
}

fn drawn(svg: &str) -> String {
    let mut svg = svg.trim_end().to_string();
    for (own, page) in COLOURS {
        svg = svg.replace(&format!("\"{own}\""), &format!("\"{page}\""));
    }
    svg
}
