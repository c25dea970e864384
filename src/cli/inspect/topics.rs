//! The content of an MCAP file: its topics, and the roles that it gives them.

use crate::page::{columns, fixed};
use crate::recording::{Cut, Found, McapFile, Topic};
use serde_json::{Map, Value, json};

/// The topics, the roles of each joint, and necessary remarks on the file, as text.
pub fn page(file: &McapFile) -> String {
    let topics = columns(
        ["topic", "type", "messages", "rate_hz"],
        file.topics().iter().map(topic_row),
    );
    let joints = file.joints();
    let of = |joint: &String| {
        let roles = file.roles(joint);
        let row = |found: Found| {
            let fields = found.fields.join(", ");
            [joint.clone(), found.role.to_string(), found.topic, fields]
        };
        roles.into_iter().map(row).collect::<Vec<_>>()
    };
    let rows: Vec<_> = joints.iter().flat_map(of).collect();
    let roles = match rows.is_empty() {
        true => fields(file),
        false => columns(["joint", "role", "topic", "field"], rows) + &unread_words(file),
    };
    let remarks: String = file.remarks().iter().map(|r| format!("- {r}\n")).collect();
    let several = match &*joints {
        [first, _, ..] => format!(
            "Several joints: name one behind the file, as in {}#{first}\n",
            file.path().display()
        ),
        _ => String::new(),
    };
    format!("{topics}\n{roles}{several}{remarks}\n")
}

/// Topics with numbers whose names do not say what they measure, in a file where other topics do.
pub fn unread(file: &McapFile) -> Vec<&Topic> {
    let joints = file.joints();
    let read: Vec<Found> = joints.iter().flat_map(|joint| file.roles(joint)).collect();
    let is_read = |topic: &&Topic| read.iter().any(|found| found.topic == topic.name);
    let is_own = |topic: &&Topic| topic.name.starts_with("/quell/");
    let others = file
        .topics()
        .iter()
        .filter(|topic| !is_own(topic) && !is_read(topic));
    others.filter(|topic| !topic.fields().is_empty()).collect()
}

/// Names them, with the channel of a manifest that reads the first.
fn unread_words(file: &McapFile) -> String {
    let topics = unread(file);
    let Some(first) = topics.first() else {
        return String::new();
    };
    let fields = first.fields();
    let position = fields
        .iter()
        .position(|field| field.starts_with("position"));
    let mut field = fields[position.unwrap_or(0)].replace("[]", "");
    let joint = first.names.first();
    if let Some(joint) = joint.filter(|_| position.is_some()) {
        field.push_str(&format!("[{joint}]"));
    }
    let of_joint = joint.map_or_else(String::new, |joint| format!("    joint = \"{joint}\"\n"));
    let file = file
        .path()
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    let names: Vec<&str> = topics.iter().map(|topic| topic.name.as_str()).collect();
    format!(
        "\nNot read, as the name does not say what is measured: {}\nA recording.toml says it, channel by channel:\n\n    \
         [[channel]]\n    role = \"link_position\"  # or what it measures\n{of_joint}    file = \"{file}\"\n    \
         topic = \"{}\"\n    field = \"{field}\"\n    unit = \"rad\"\n\n",
        names.join(", "),
        first.name
    )
}

/// The fields that a manifest can name, if no topic gives its role.
fn fields(file: &McapFile) -> String {
    let line = |topic: &Topic| format!("  {}: {}\n", topic.name, topic.fields().join(", "));
    let lines: String = file.topics().iter().map(line).collect();
    format!("No topic is known to have a role. A manifest can name these fields:\n{lines}")
}

fn topic_row(topic: &Topic) -> [String; 4] {
    [
        topic.name.clone(),
        topic.kind.clone(),
        topic.messages.to_string(),
        topic.rate_hz().map_or("-".into(), |rate| fixed(rate, 2)),
    ]
}

/// The same as the keys of a document.
pub fn document(file: &McapFile) -> Map<String, Value> {
    let topics = file.topics().iter().map(|topic| {
        json!({
            "topic": topic.name,
            "type": topic.kind,
            "messages": topic.messages,
            "rate_hz": topic.rate_hz(),
            "names": topic.names,
            "fields": topic.fields(),
        })
    });
    let joints = file.joints().into_iter().map(|joint| {
        let roles = file.roles(&joint).into_iter().map(|found| {
            json!({"role": found.role.name(), "topic": found.topic, "fields": found.fields})
        });
        json!({"joint": joint, "roles": roles.collect::<Vec<_>>()})
    });
    let cut = file.cut();
    let cut = cut.map(|Cut { at, length }| json!({"at_byte": at, "of": length}));
    Map::from_iter([
        ("topics".into(), topics.collect()),
        ("joints".into(), joints.collect()),
        ("cut".into(), json!(cut)),
    ])
}
