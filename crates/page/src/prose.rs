//! Sentences, broken into lines where a reader expects it.

use maud::{Markup, html};

/// A sentence in which a percent sign stays beside its number, and an option such as `--mode` on one line: a browser
/// breaks a line after a hyphen, which leaves `--` alone.
pub(super) fn prose(text: &str) -> Markup {
    let is_option = |word: &str| word.starts_with("--") && word.len() > 2;
    html! {
        @for (index, word) in beside(text).split(' ').enumerate() {
            @if index > 0 { " " }
            @if is_option(word) { span.option { (word) } } @else { (word) }
        }
    }
}

fn beside(text: &str) -> String {
    let mut told = String::with_capacity(text.len() + 1);
    for (index, part) in text.split(" %").enumerate() {
        if index > 0 {
            let is_number = told.ends_with(|letter: char| letter.is_ascii_digit());
            told.push_str(if is_number { "\u{a0}%" } else { " %" });
        }
        told.push_str(part);
    }
    told
}

#[cfg(test)]
mod tests {
    use super::prose;

    #[test]
    fn a_percent_sign_and_an_option_are_not_broken() {
        let told = prose("5 % or <less> %, with --mode F,XI -- or").into_string();
        assert_eq!(
            told,
            "5\u{a0}% or &lt;less&gt; %, with <span class=\"option\">--mode</span> F,XI -- or"
        );
    }
}
