//! Colours and dashes of curves.

use maud::{Markup, html};

/// Colours that the style sheet defines, `--c0` to `--c9`.
pub(super) const COLOURS: usize = 10;

/// The dash of each colour, an index of [`BORDERS`]: few colours are told apart by everyone, so that those of one dash are few.
const DASHES: [usize; COLOURS] = [0, 0, 0, 0, 1, 1, 1, 2, 2, 2];

/// Dashes as the script draws them, by their name as the style of a border.
const BORDERS: [&str; 3] = ["solid", "dashed", "dotted"];

/// The dash of a slot. A slot beyond the colours has one of them again, with another dash.
pub(super) fn dash(slot: usize) -> usize {
    (DASHES[slot % COLOURS] + slot / COLOURS) % BORDERS.len()
}

/// A small square in the colour of a bar.
pub(super) fn swatch(slot: usize) -> Markup {
    html! { span.swatch style=(format!("background:var(--c{})", slot % COLOURS)) {} }
}

/// A short line as a curve is drawn.
pub(super) fn line(slot: usize) -> Markup {
    let border = BORDERS[dash(slot)];
    html! { span.swatch.line style=(format!("border-top:.15rem {border} var(--c{})", slot % COLOURS)) {} }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Linear RGB as seen without one kind of cone, and with all. Source: Machado, Oliveira, Fernandes, A
    /// physiologically-based model for simulation of color vision deficiency, IEEE TVCG 15 (2009), severity 1.
    const SEEN: [[[f64; 3]; 3]; 4] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ],
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ],
        [
            [1.255528, -0.076749, -0.178779],
            [-0.078411, 0.930809, 0.147602],
            [0.004733, 0.691367, 0.303900],
        ],
    ];

    /// From linear RGB to the cones of Oklab, and from their cube roots to its coordinates. Source: Ottosson, A perceptual
    /// color space for image processing (2020).
    const CONES: [[f64; 3]; 3] = [
        [0.4122214708, 0.5363325363, 0.0514459929],
        [0.2119034982, 0.6806995451, 0.1073969566],
        [0.0883024619, 0.2817188376, 0.6299787005],
    ];
    const OKLAB: [[f64; 3]; 3] = [
        [0.2104542553, 0.7936177850, -0.0040720468],
        [1.9779984951, -2.4285922050, 0.4505937099],
        [0.0259040371, 0.7827717662, -0.8086757660],
    ];

    /// Least distances in Oklab, in which 0.02 is just seen between two patches side by side: of curves with the same
    /// dash, thin and apart, and of any two.
    const SAME_DASH: f64 = 0.1;
    const ANY: f64 = 0.04;

    /// Least contrast of what is no text, WCAG 2.2, 1.4.11.
    const CONTRAST: f64 = 3.0;

    fn times(matrix: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
        matrix.map(|row| row.iter().zip(v).map(|(m, v)| m * v).sum())
    }

    fn linear(hex: &str) -> [f64; 3] {
        [1, 3, 5].map(|at| {
            let value = f64::from(u8::from_str_radix(&hex[at..at + 2], 16).unwrap()) / 255.0;
            match value <= 0.04045 {
                true => value / 12.92,
                false => ((value + 0.055) / 1.055).powf(2.4),
            }
        })
    }

    fn distance(a: &str, b: &str) -> f64 {
        let apart = |seen| {
            let [a, b] = [a, b].map(|hex| {
                let cones = times(&CONES, times(seen, linear(hex)));
                times(&OKLAB, cones.map(|cone| cone.max(0.0).cbrt()))
            });
            a.iter()
                .zip(b)
                .map(|(a, b)| (a - b).powi(2))
                .sum::<f64>()
                .sqrt()
        };
        SEEN.iter().map(apart).fold(f64::INFINITY, f64::min)
    }

    fn contrast(a: &str, b: &str) -> f64 {
        let [a, b] = [a, b].map(|hex| {
            let [r, g, b] = linear(hex);
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        });
        (a / b).max(b / a)
    }

    /// The values of a variable of the style sheet: on light, on dark.
    fn values(name: &str) -> Vec<&'static str> {
        let before = format!("--{name}: ");
        let places = crate::STYLE.match_indices(&before);
        places
            .map(|(at, _)| &crate::STYLE[at + before.len()..][..7])
            .collect()
    }

    #[test]
    fn no_two_slots_share_colour_and_dash() {
        let slots = 0..COLOURS * BORDERS.len();
        let pairs: BTreeSet<_> = slots
            .clone()
            .map(|slot| (slot % COLOURS, dash(slot)))
            .collect();
        assert_eq!(pairs.len(), slots.len());
    }

    #[test]
    fn colours_are_told_apart_and_seen() {
        let cards = values("card");
        for (theme, card) in cards.iter().enumerate() {
            let colours: Vec<_> = (0..COLOURS)
                .map(|slot| values(&format!("c{slot}"))[theme])
                .collect();
            for a in 0..COLOURS {
                let seen = contrast(colours[a], card);
                assert!(seen >= CONTRAST, "{} on {card}: {seen}", colours[a]);
                for b in 0..a {
                    let least = if dash(a) == dash(b) { SAME_DASH } else { ANY };
                    let apart = distance(colours[a], colours[b]);
                    assert!(apart >= least, "{} {}: {apart}", colours[a], colours[b]);
                }
            }
        }
        assert_eq!(cards.len(), 2);
    }
}
