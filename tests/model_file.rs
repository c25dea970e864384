//! Model files: what is read, what is written, what is refused and where.

use quell::effects::{EFFECTS, Effect, LEARNED, ParameterRole, Place};
use quell::model::{KINDS, Model, Value};
use quell::recording::Role;

fn read(text: &str) -> Model {
    Model::from_toml(text, "model.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn same(a: &Model, b: &Model) -> bool {
    let effects = |model: &Model| -> Vec<(&'static str, Place, Vec<Value>)> {
        let effects = model.effects.iter();
        effects
            .map(|e| (e.effect.name, e.place, e.parameters.clone()))
            .collect()
    };
    (a.kind.name, a.kind.keys[0].name) == (b.kind.name, b.kind.keys[0].name)
        && (&a.values, &a.given, a.hold) == (&b.values, &b.given, b.hold)
        && effects(a) == effects(b)
}

#[test]
fn every_kind_with_every_effect_is_written_and_read_back_to_the_bit() {
    for kind in KINDS {
        let mut text = format!("kind = \"{}\"\ninput_hold = \"linear\"\n", kind.name);
        for (index, key) in kind.keys.iter().enumerate() {
            // A value with a full mantissa, inside every range.
            let value = (key.range.0 + 1e-3).max(0.1_f64.sqrt()).min(key.range.1);
            text += &match index % 3 {
                0 => format!("{} = {value:?}\n", key.name),
                1 => format!("{} = {{ value = {value:?}, std = 0.1 }}\n", key.name),
                _ => format!(
                    "{} = {{ value = {value:?}, bounds = [{:?}, {:?}], fixed = true }}\n",
                    key.name,
                    0.5 * value,
                    3.0 * value
                ),
            };
        }
        let has = |place| {
            let mut inputs = kind.inputs.iter();
            inputs.any(|&input| (kind.places)(input).contains(&place))
        };
        for effect in EFFECTS.iter().chain(LEARNED) {
            for place in effect.places.iter().filter(|place| has(**place)) {
                text += &format!(
                    "[[effect]]\nname = \"{}\"\nplace = \"{}\"\n[effect.parameters]\n",
                    effect.name,
                    place.name()
                );
                if effect.is_learned() {
                    text += &learned(effect);
                    continue;
                }
                for parameter in effect.parameters {
                    text += &format!("{} = {{ value = 0.1, std = 1e-17 }}\n", parameter.name);
                }
            }
        }
        let model = read(&text);
        assert_eq!(model.kind.keys[0].name, kind.keys[0].name);
        let written = model.to_toml();
        assert!(same(&model, &read(&written)), "{written}");
        assert_eq!(written, read(&written).to_toml());
    }
}

/// The parameters of a learned law.
fn learned(effect: &Effect) -> String {
    let ordinates = effect.parameters.iter();
    let ordinates = ordinates.filter(|p| p.role == ParameterRole::Ordinate);
    let value = |(k, _)| match k % 3 {
        0 => format!("{:?}", 0.1 * k as f64),
        1 => format!("{{ value = {:?}, std = 0.5 }}", (k as f64).sqrt()),
        _ => "{ value = 1, fixed = true }".to_string(),
    };
    let values: Vec<String> = ordinates.enumerate().map(value).collect();
    let from = if effect.name == "learned_friction" {
        -0.1
    } else {
        0.1
    };
    format!(
        "from = {from}\nto = 0.3\nvalues = [{}]\n",
        values.join(", ")
    )
}

#[test]
fn a_learned_law_is_a_table_of_its_values() {
    let text = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8\ndamping_ratio = 0.05\n[[effect]]\n\
                name = \"learned_spring\"\n[effect.parameters]\nfrom = -0.01\nto = 0.02\n\
                values = [-3, -2, -1, -0.5, 0, 0, 0, 0.5, 1, 2, 3, 5e-1]\n";
    let model = read(text);
    let values: Vec<f64> = model.terms()[0].values.clone();
    assert_eq!(values[..3], [-3.0, -2.0, -1.0]);
    assert_eq!(values[11..], [0.5, -0.01, 0.02]);
    // What was visited is no unknown.
    let fixed = model.effects[0].parameters.iter().map(|p| p.fixed);
    assert_eq!(fixed.filter(|fixed| *fixed).count(), 2);
    let written = model.to_toml();
    let line =
        "values = [-3.0, -2.0, -1.0, -0.5, 0.0, 0.0, 0.0, 0.5, 1.0, 2.0, 3.0, 0.5]  # position\n";
    assert!(written.contains(line), "{written}");
    assert!(
        written.contains("from = -0.01  # position\nto = 0.02"),
        "{written}"
    );
    assert!(same(&model, &read(&written)));
}

#[test]
fn a_plain_file_is_read() {
    let model = read(
        "kind = \"rigid_axis\"\nmass = 95\nviscous = 0\n[[effect]]\nname = \"coulomb_friction\"\n\
         parameters = { friction = 20.4 }\n",
    );
    assert_eq!(model.value("mass"), Some(95.0));
    assert_eq!(model.given("force_gain"), None);
    assert_eq!(model.value("force_gain"), Some(1.0));
    // Viscous friction is switched off, and so is no unknown.
    assert_eq!(model.given("viscous"), None);
    // A rigid axis has no transmission: the drive is the only place left.
    assert_eq!(model.effects[0].place, Place::Drive);
    assert!(!(model.kind.takes)(
        &[95.0, 0.0, 1.0, 0.0, 0.0, 1.0, 0.0],
        Role::CommandPosition
    ));
}

#[test]
fn the_keys_tell_which_oscillator_is_meant() {
    let spring = read("kind = \"oscillator\"\nstiffness = 3.0\n");
    assert_eq!(spring.kind.inputs[0], Role::LinkPosition);
    let mass = read("kind = \"oscillator\"\nnatural_frequency_hz = 68\ndamping_ratio = 0.05\n");
    assert_eq!(mass.kind.outputs[0], Role::LinkPosition);
}

#[test]
fn what_is_wrong_is_refused_with_file_line_and_key() {
    let joint = "kind = \"flexible_joint\"\nnatural_frequency_hz = 8\ndamping_ratio = 0.05\n";
    let effect = "[[effect]]\nname = \"coulomb_friction\"\nplace = \"transmission\"\n";
    let friction = format!("{effect}[effect.parameters]\nfriction");
    let law = |name: &str, from: &str, list: &str| {
        format!(
            "{joint}[[effect]]\nname = \"{name}\"\nplace = \"transmission\"\n[effect.parameters]\n\
             from = {from}\nto = 1\nvalues = [{list}]"
        )
    };
    let spring = |from: &str, list: &str| law("learned_spring", from, list);
    #[rustfmt::skip]
    let cases: &[(String, &[&str])] = &[
        ("kind = ".into(), &["m.toml:1:8: kind = : there is no value behind ="]),
        ("kind = \"oscillator".into(), &["m.toml:1:19: kind = \"oscillator: the closing \" is missing"]),
        (String::new(), &["m.toml:1: kind: is missing"]),
        ("kind = 3".into(), &["m.toml:1: kind: a string is wanted, not a value of type integer"]),
        ("\nkind = \"flexible_joynt\"".into(), &["m.toml:2: kind:", "did you mean \"flexible_joint\"?"]),
        ("kind = \"xyz\"".into(), &["known: flexible_joint, rigid_axis"]),
        ("kind = \"flexible_joint\"".into(), &["m.toml:1: natural_frequency_hz: is missing; flexible_joint needs natural_frequency_hz = a number, damping_ratio"]),
        ("kind = \"oscillator\"\nstifness = 1".into(), &["m.toml:2: stifness: is no key here"]),
        (format!("{joint}dampng_ratio = 3"), &["m.toml:4: dampng_ratio: is no key here; did you mean \"damping_ratio\"?"]),
        (format!("{joint}lever_arm_m = \"1\""), &["m.toml:4: lever_arm_m: a number is wanted"]),
        (format!("{joint}lever_arm_m = -1"), &["m.toml:4: lever_arm_m: -1.0 is not within"]),
        (format!("{joint}lever_arm_m = nan"), &["m.toml:4: lever_arm_m: NaN is not within"]),
        (format!("{joint}lever_arm_m = {{ value = 1, sdt = 2 }}"), &["m.toml:4: sdt:", "\"std\""]),
        (format!("{joint}lever_arm_m = {{ value = 1, std = 0 }}"), &["m.toml:4: std: 0.0 is not"]),
        (format!("{joint}lever_arm_m = {{ value = 1, bounds = [2, 3] }}"), &["m.toml:4: bounds: [2.0, 3.0]"]),
        (format!("{joint}lever_arm_m = {{ value = 1, bounds = [1] }}"), &["array of two numbers"]),
        (format!("{joint}lever_arm_m = {{ std = 1 }}"), &["m.toml:4: value: is missing"]),
        (format!("{joint}input_hold = \"zeroorder\""), &["m.toml:4: input_hold:", "\"zero_order\"?"]),
        (format!("{joint}[effect]\nname = 3"), &["effect: [[effect]]"]),
        (format!("{joint}[[effect]]\nname = \"coulomb_frcition\""), &["m.toml:5: name:", "\"coulomb_friction\"?"]),
        (format!("{joint}[[effect]]\nplace = \"link\""), &["m.toml:4: name: is missing"]),
        (format!("{joint}{effect}"), &["m.toml:5: parameters: is missing"]),
        (format!("{joint}{effect}sise = 3"), &["m.toml:7: sise: is no key here"]),
        (joint.to_owned() + &effect.replace("transmission", "sensor"), &["m.toml:6: place: \"sensor\" is no place of coulomb_friction"]),
        (joint.to_owned() + &effect.replace("transmission", "tansmission"), &["m.toml:6: place:", "\"transmission\"?"]),
        (format!("{joint}{friction} = -1"), &["m.toml:8: friction: -1.0 is not within 0.0"]),
        (format!("{joint}{friction} = inf"), &["m.toml:8: friction: inf is not within"]),
        (spring("0", "1, 2"), &["m.toml:10: values: 2 values; learned_spring has 12"]),
        (spring("1", "0,0,0,0,0,0,0,0,0,0,0,0"), &["m.toml:9: to: 1.0 is not above 1.0, where it begins"]),
        (spring("-inf", "0,0,0,0,0,0,0,0,0,0,0,0"), &["m.toml:8: from: -inf is not within"]),
        (spring("0", "0,0,0,0,0,0,0,0,0,0,0,nan"), &["m.toml:10: values: value 12, column 33: NaN is not within"]),
        (spring("0", "0,0,0,0,0,0,0,0,0,0,0,\n \"x\""), &["m.toml:11: values: value 12, column 2: a number is wanted"]),
        (spring("0", "0,0,0,0,0,0,0,0,0,0,0,0]\nstd = [3"), &["m.toml:11: std: is no key here"]),
        (spring("0", "]\nvalue = [").replace("values", "walues"), &["m.toml:5: values: is missing"]),
        (law("learned_friction", "0.5", "0,0,0,0,0,0,0,0,0,0,0,0"), &["m.toml:8: from: 0.5 is not within"]),
        (law("learned_friction", "-1", "0,0,0,0,0,0,0,0,0,0,0,-1"), &["value 12, column 33: -1.0 is not within 0.0"]),
        (format!("{joint}{friction}s = 1"), &["m.toml:5: friction: is missing"]),
    ];
    for (text, wanted) in cases {
        let error = Model::from_toml(text, "m.toml")
            .err()
            .map(|e| e.to_string());
        let error = error.unwrap_or_else(|| panic!("accepted:\n{text}"));
        for words in *wanted {
            assert!(
                error.contains(words),
                "{words:?} not in {error:?} of\n{text}"
            );
        }
    }
}
