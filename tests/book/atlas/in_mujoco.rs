//! What the atlas writes for MuJoCo does there what the effect does here.

use super::arm::{arms, position, stamps};
use super::elements::plain;
use super::mujoco::{Form, form};
use crate::python::python;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Largest difference between what the effect changes there and here, over what it changes. Numbers are written with
/// three digits, MuJoCo's dry friction creeps a little, and the peaks that a saturation cuts off depend on the steps.
const LARGEST: f64 = 0.1;

#[test]
fn mujoco_moves_as_the_atlas_says() {
    let folder = tempfile::tempdir().unwrap();
    let write =
        |name: String, text: String| std::fs::write(folder.path().join(name), text).unwrap();
    let column = |values: &[f64]| {
        values.iter().fold(String::new(), |mut text, value| {
            let _ = writeln!(text, "{value:e}");
            text
        })
    };
    let arms = arms();
    let moves: Vec<f64> = stamps().into_iter().map(position).collect();
    write("motion.csv".into(), column(&moves));
    let mut compared = Vec::new();
    for own in super::entries(&arms) {
        let name = own.term.effect.name;
        let (mjcf, is_same) = match form(own.arm, &own.term) {
            Form::Same(mjcf) => (mjcf, true),
            Form::Like(mjcf, _) => (mjcf, false),
            Form::None(_) => continue,
        };
        write(format!("{name}.xml"), mjcf.whole());
        write(format!("{name}.plain"), plain(own.arm).whole());
        if is_same {
            write(format!("{name}.csv"), column(own.seen.change.as_slice()));
            compared.push(name);
        }
    }
    let script = ["atlas.py".as_ref(), folder.path().as_os_str()];
    let Some(said) = python("mujoco", "requirements.txt", &script) else {
        return;
    };
    let errors: BTreeMap<String, f64> = serde_json::from_slice(&said).unwrap();
    assert!(
        compared.iter().all(|name| errors.contains_key(*name)),
        "{errors:?}"
    );
    let wrong: Vec<_> = errors.iter().filter(|own| *own.1 > LARGEST).collect();
    assert!(wrong.is_empty(), "{wrong:?} of {errors:?}");
}
