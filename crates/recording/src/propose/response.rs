//! Whether the columns that were named show what vibrates.

use super::super::role::Role;
use super::columns::{Channels, MOST_ASKED};
use super::content::Content;

/// A sentence for files of which only the motor side was recognised while there are other columns of numbers; `None`
/// for all others.
pub fn lacking<'a>(
    files: impl Iterator<Item = (&'a Content, &'a Channels)> + Clone,
) -> Option<String> {
    let mut found = files.clone().flat_map(|(_, channels)| &channels.found);
    let is_motor = |role: Role| matches!(role, Role::MotorPosition | Role::MotorVelocity);
    let has_any = files
        .clone()
        .any(|(_, channels)| !channels.found.is_empty());
    if !has_any || !found.all(|channel| is_motor(channel.role.value)) {
        return None;
    }
    let titles = files.flat_map(|(content, channels)| {
        let rest = channels.unused.iter().map(|&index| &content.columns[index]);
        rest.filter(|column| column.is_measured())
            .map(|column| column.title.as_str())
            .filter(|title| !title.is_empty())
    });
    let titles: Vec<&str> = titles.take(MOST_ASKED).collect();
    (!titles.is_empty()).then(|| {
        format!(
            "which column shows what vibrates, of {}: add a [[channel]] block for it to the manifest, with a role as \
             link_position, deformation or tip_acceleration",
            titles.join(", ")
        )
    })
}
