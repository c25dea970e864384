//! Text in pictures: SVG breaks no lines, and the reader's font is not known here.

/// At most this wide is a character, in parts of the font's size: the advances of DejaVu Sans Bold, rounded up. Browsers on Linux
/// take it for `sans-serif`; Arial and Helvetica, which others take, are narrower.
fn advance(character: char) -> f64 {
    match character {
        ' ' | '\u{a0}' | '.' | ',' | '/' | '\'' | 'i' | 'j' | 'l' | 'I' | 'J' => 0.38,
        '-' | ':' | ';' | '(' | ')' | 'f' | 'r' | 't' => 0.5,
        'a'..='z' if !matches!(character, 'm' | 'w') => 0.72,
        '0'..='9' => 0.7,
        'A'..='Z' if !matches!(character, 'M' | 'W') => 0.86,
        _ => 1.11,
    }
}

/// How wide a text is at most.
pub fn width(text: &str, size: f64) -> f64 {
    text.chars().map(advance).sum::<f64>() * size
}

/// The fewest lines of whole words that are no wider than the room. No-break spaces hold words together.
pub fn lines(text: &str, size: f64, room: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split(' ') {
        assert!(
            width(word, size) <= room,
            "\"{word}\" is wider than {room} at size {size}"
        );
        match lines.last_mut() {
            Some(line) if width(&format!("{line} {word}"), size) <= room => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.into()),
        }
    }
    lines
}
