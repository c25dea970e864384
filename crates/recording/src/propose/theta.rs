//! The two positions of a joint in the letters of robotics.

use super::content::Content;

/// Whether a column is a joint's `q` beside its `theta`: the link's position and the motor's, as in M. Spong, Modeling and
/// Control of Elastic Joint Robots, ASME J. Dynamic Systems, Measurement and Control 109 (1987), and the works after it.
pub fn is_link_of_theta(content: &Content, index: usize) -> bool {
    let own = &content.columns[index].name;
    let [word] = own.words.as_slice() else {
        return false;
    };
    let is_beside = |number: &str| {
        let theta = format!("theta{number}");
        let mut all = content.columns.iter().map(|column| &column.name);
        all.any(|name| name.words == [theta.as_str()] && name.unit == own.unit)
    };
    word.strip_prefix('q')
        .is_some_and(|number| number.bytes().all(|b| b.is_ascii_digit()) && is_beside(number))
}
