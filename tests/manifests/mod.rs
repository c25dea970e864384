//! Manifests of the shared recordings. The recordings are not part of the project: they are looked
//! for in `QUELL_RECORDINGS`, else in `../shared/recordings` beside the project.

#[path = "../absent/shared.rs"]
mod beside;

use std::path::Path;
use tempfile::TempDir;

/// A folder with the named manifest as its `recording.toml`, its `file` paths made to point to the
/// shared recordings. Where those are absent, says so and gives nothing.
pub fn shared(manifest: &str) -> Option<TempDir> {
    let recordings = beside::shared("QUELL_RECORDINGS", "recordings", "")?;
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(root.join("tests/manifests").join(manifest)).unwrap();
    let file = format!("file = \"{}/", recordings.display());
    let folder = TempDir::new().unwrap();
    std::fs::write(
        folder.path().join("recording.toml"),
        text.replace("file = \"", &file),
    )
    .unwrap();
    Some(folder)
}
