//! The pages of the atlas that a report includes, for readers without the book.

use super::case::Case;
use super::words;
use quell_diagnosis::Finding;
use quell_page::Page;

/// One article for each effect; the tests of the book write it.
const ARTICLES: &str = include_str!("../assets/atlas.html");

/// Content of an article.
const INSIDE: &str = "equation, fingerprint, what it is mistaken for, what to do";

/// The article on an effect, as HTML; `None` for a learned law.
pub fn article(effect: &str) -> Option<&'static str> {
    let begins = format!("<article id=\"{effect}\">");
    let (_, rest) = ARTICLES.split_once(&begins)?;
    Some(rest.split_once("</article>")?.0)
}

/// The folded pages of all effects that a finding may be; for a learned law that of the named law that stays
/// inside its band.
pub fn pages(page: Page, case: &Case, finding: &Finding) -> Page {
    let nearest = finding
        .learned()
        .and_then(|learned| learned.nearest.as_ref());
    let nearest = nearest.filter(|nearest| nearest.is_inside());
    let named = nearest.map_or(&finding.effect, |nearest| &nearest.effect);
    let names = std::iter::once(named).chain(&finding.alternatives);
    names.fold(page, |page, name| match article(name) {
        Some(article) => {
            let title = words::capital(&case.title(name));
            page.fold(format!("{title}: {INSIDE}"), article)
        }
        None => page,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use quell_model::effects::EFFECTS;

    #[test]
    fn every_effect_of_the_catalogue_is_in_the_atlas() {
        let missing = EFFECTS
            .iter()
            .filter(|effect| article(effect.name).is_none());
        let missing: Vec<_> = missing.map(|effect| effect.name).collect();
        assert!(missing.is_empty(), "{missing:?}");
        assert!(article("learned_spring").is_none());
    }
}
