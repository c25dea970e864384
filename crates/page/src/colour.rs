//! Colours of curves.

use maud::{Markup, html};

/// Colours that the style sheet defines, `--c0` to `--c9`.
pub(super) const COLOURS: usize = 10;

/// A small square in the colour of a curve.
pub(super) fn swatch(slot: usize) -> Markup {
    html! { span.swatch style=(format!("background:var(--c{})", slot % COLOURS)) {} }
}
