//! A proposal as the text of manifests.

use super::super::role::Role;
use super::super::stamp::TimeUnit;
use super::clock::Clock;
use super::column::Column;
use super::columns::Channel;
use super::content::Content;
use super::read::{Read, Test, read};
use super::toml_text::{layout, line, quoted};
use super::{GUESSED, Guess, NO_RATE, Proposal, Proposed, joint, manifest_name, response, wraps};
use crate::Wrap;
use std::collections::BTreeSet;
use std::fmt::Write;
use std::path::Path;

/// The proposal for the files of `path`, which is one of them or their folder.
pub fn proposal(path: &Path, contents: &[Content]) -> Proposal {
    let files: Vec<Read> = contents.iter().map(read).collect();
    let mut open = Vec::new();
    for file in &files {
        let place = match contents.len() {
            1 => String::new(),
            _ => format!("{}: ", name(file.content)),
        };
        let sentences = file.open();
        open.extend(
            sentences
                .into_iter()
                .map(|sentence| place.clone() + &sentence),
        );
    }
    let lacking = response::lacking(files.iter().map(|file| (file.content, &file.channels)));
    if open.is_empty() {
        open.extend(lacking);
    }
    let mut manifests = Vec::new();
    if are_one_run(&files) {
        let title = match path.is_dir() {
            true => path
                .file_name()
                .map(|name| name.to_string_lossy().into_owned()),
            false => None,
        };
        let title = title.unwrap_or_else(|| files[0].content.stem());
        manifests.push(manifest(manifest_name(true, ""), &title, &files, None));
    } else {
        let mut all = Vec::new();
        for file in &files {
            let stem = file.content.stem();
            let tests = file.several();
            if tests.is_empty() {
                all.push((stem.clone(), file, None));
            }
            for (called, test) in tests {
                all.push((format!("{stem}_{called}"), file, Some(test)));
            }
        }
        for (number, (stem, file, test)) in all.iter().enumerate() {
            let name = manifest_name(number == 0 && files.len() == 1, stem);
            let one = std::slice::from_ref(*file);
            manifests.push(manifest(name, stem, one, test.as_ref()));
        }
    }
    let found = files.iter().flat_map(|file| &file.channels.found);
    let joints = joint::distinct(found.filter_map(|channel| channel.joint.as_ref()));
    Proposal {
        manifests,
        open,
        joints,
        taken: files.iter().filter_map(wraps::taken).collect(),
    }
}

/// Whether the files are channels of one run: they have no role in common, and none has several tests.
fn are_one_run(files: &[Read]) -> bool {
    let mut roles = BTreeSet::new();
    let mut found = files.iter().flat_map(|file| &file.channels.found);
    found.all(|channel| roles.insert((channel.role.value.name(), &channel.joint)))
        && files.iter().all(|file| file.several().is_empty())
}

/// The text of one manifest.
fn manifest(name: String, title: &str, files: &[Read], test: Option<&Test>) -> Proposed {
    let mut text =
        String::from("# Proposed by `quell inspect`. Look at what is guessed, and correct it.\n");
    let _ = writeln!(text, "name = {}", quoted(title));
    let payload = files.iter().find_map(|file| file.payload(test));
    if let Some((column, value)) = &payload {
        let said = line(&column.title);
        let _ = writeln!(
            text,
            "payload = {}  # by the column {said:?}",
            quoted(value)
        );
    }
    if let Some(Test::Rows(rows)) = test {
        let _ = writeln!(
            text,
            "rows = [{}, {}]{GUESSED}the time begins again with each test",
            rows.start, rows.end
        );
    }
    let shared = files
        .iter()
        .all(|file| file.content.layout == files[0].content.layout);
    if shared {
        text += &layout("[csv]", "\n", &files[0].content.layout, files[0].only(test));
    }
    for file in files {
        for found in &file.channels.found {
            text += &channel(file, found);
            if !shared {
                text += &layout("[channel.csv]", "", &file.content.layout, file.only(test));
            }
        }
        if file.channels.found.is_empty() {
            text += &to_fill_in(file);
        }
        let unused: Vec<_> = file
            .channels
            .unused
            .iter()
            .map(|i| &file.content.columns[*i])
            .filter(|own| {
                payload
                    .as_ref()
                    .is_none_or(|(used, _)| !std::ptr::eq(*used, *own))
            })
            .map(Column::told)
            .collect();
        if !unused.is_empty() {
            let _ = writeln!(
                text,
                "\n# Columns of {} that are not used: {}",
                self::name(file.content),
                line(&unused.join(", "))
            );
        }
    }
    Proposed { name, text }
}

/// `[[channel]]`
fn channel(file: &Read, channel: &Channel) -> String {
    let called: Vec<_> = channel
        .columns
        .iter()
        .map(|i| quoted(&file.content.columns[*i].called))
        .collect();
    let titles: Vec<_> = channel
        .columns
        .iter()
        .map(|i| file.content.columns[*i].title.as_str())
        .collect();
    let mut text = String::from("\n[[channel]]\n");
    text += &key("role", &quoted(channel.role.value.name()), &channel.role);
    if let Some(joint) = &channel.joint {
        let _ = writeln!(text, "joint = {}  # in its name", quoted(joint));
    }
    let _ = writeln!(text, "file = {}", quoted(&name(file.content)));
    match &file.clock {
        Clock::Stamps { column, unit, .. } => {
            let column = &file.content.columns[*column];
            let _ = writeln!(text, "time = {}", quoted(&column.called));
            let plain =
                unit.value == TimeUnit::Seconds && column.numbers.first().is_none_or(|t| *t < 1e8);
            if !(plain && unit.why.is_none() && column.durations.is_none()) {
                text += &key("time_unit", &quoted(unit.value.name()), unit);
            }
            if let Some(wrap) = &column.wrap {
                text += &period("time_wrap", wrap, wraps::of_time(wrap));
            }
        }
        Clock::Rate(rate) => {
            let _ = writeln!(
                text,
                "rate_hz = {rate}  # the last line of the file says it"
            );
        }
        Clock::Told(step) => {
            let (rate, key) = (round(step.seconds.recip()), line(&step.key));
            let _ = writeln!(text, "rate_hz = {rate}  # {key} above the table says it");
        }
        Clock::Split(split) => {
            let (rate, why) = (round(split.rate_hz), split.words(file.content));
            let _ = writeln!(text, "rate_hz = {rate}{GUESSED}{}", line(&why));
        }
        Clock::None | Clock::Counted(_) => {
            let _ = writeln!(
                text,
                "{NO_RATE}  # samples a second: nothing in the file says it"
            );
        }
    }
    let comment = match called
        .iter()
        .zip(&titles)
        .any(|(called, title)| *called != quoted(title))
    {
        true => format!("  # {}", line(&titles.join(", "))),
        false => String::new(),
    };
    let _ = match called.as_slice() {
        [one] => writeln!(text, "column = {one}{comment}"),
        several => writeln!(text, "columns = [{}]{comment}", several.join(", ")),
    };
    text += &key("unit", &quoted(&channel.unit.value), &channel.unit);
    if let Some(counts) = channel.per_revolution {
        let _ = writeln!(
            text,
            "scale = {}  # {counts} counts a revolution, by its name",
            counts.recip()
        );
    }
    if let Some(wrap) = &channel.wrap {
        text += &period("wrap", wrap, wraps::words(wrap));
    }
    text
}

/// A block for each column that cannot be named, as comments: role and unit are to be filled in.
fn to_fill_in(file: &Read) -> String {
    let mut text = String::from(
        "\n# The names of the columns do not tell what they mean. Fill in role and unit, and take the marks away. A role is\n\
         # tip_acceleration, deformation, link_position, motor_position, torque or another one of the reference.\n",
    );
    for index in file.channels.asked(file.content) {
        let role = Role::Deformation;
        let block = Channel {
            role: Guess::known(role),
            joint: None,
            columns: vec![index],
            unit: Guess::known(String::new()),
            per_revolution: None,
            wrap: None,
        };
        let block = channel(file, &block).replacen(role.name(), "", 1);
        text += &block.replace('\n', "\n# ");
        text.truncate(text.len() - "# ".len());
    }
    text
}

fn key<T>(key: &str, value: &str, guess: &Guess<T>) -> String {
    match &guess.why {
        Some(why) => format!("{key} = {value}{GUESSED}{}\n", line(why)),
        None => format!("{key} = {value}\n"),
    }
}

/// The line of a counter that begins again.
fn period(name: &str, wrap: &Wrap, why: String) -> String {
    key(name, &wrap.period.to_string(), &Guess::guessed((), why))
}

/// A rate to a millionth of a hertz.
fn round(rate_hz: f64) -> f64 {
    (1e6 * rate_hz).round() / 1e6
}

fn name(content: &Content) -> String {
    content
        .path
        .file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

#[cfg(test)]
mod tests {
    use super::super::propose;

    #[test]
    fn a_known_force_beside_that_of_a_loop_is_of_the_same_run() {
        let rows: String = (0..300)
            .map(|k| format!("{},{},{}\n", 1e-3 * f64::from(k), k % 9, k / 150))
            .collect();
        let folder = tempfile::tempdir().unwrap();
        for (file, names) in [
            ("position.csv", "time_s,motor_position_m,link_position_m"),
            ("forces.csv", "time_s,force_N,extra_force_N"),
        ] {
            std::fs::write(folder.path().join(file), format!("{names}\n{rows}")).unwrap();
        }
        let told = propose(folder.path()).unwrap();
        assert_eq!((told.manifests.len(), told.open.len()), (1, 0));
        let words = [
            "role = \"force\"",
            "role = \"known_force\"",
            "column = \"extra_force_N\"",
        ];
        assert!(
            words.iter().all(|own| told.manifests[0].text.contains(own)),
            "{told:?}"
        );
    }
}
