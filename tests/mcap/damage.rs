//! Files that are cut, changed, or never finished.

use super::{created, save, whole, write};
use proptest::prelude::*;
use quell::recording::health::{health, remarks};
use quell::recording::{McapFile, Recording, Role};
use std::sync::OnceLock;
use tempfile::TempDir;

#[test]
fn a_file_that_is_cut_is_read_up_to_the_cut() {
    let folder = TempDir::new().unwrap();
    let all = Recording::from_path(save(&folder, whole())).unwrap();
    let full = &all.channel(Role::CommandPosition).unwrap().time;
    let mut state = 1_u64;
    for _ in 0..50 {
        // A step of Knuth's MMIX generator.
        state = state
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        let cut = (state >> 33) as usize % whole().len();
        let path = save(&folder, &whole()[..cut]);
        // What is lost is one chunk, of a quarter of a second.
        let least = cut as f64 / whole().len() as f64 * 3.0 - 0.3;
        let part = match Recording::from_path(&path) {
            Ok(part) => part,
            Err(error) => {
                assert!(least < 0.0, "{cut}: {error}");
                continue;
            }
        };
        let part = &part.channel(Role::CommandPosition).unwrap().time;
        assert_eq!(part[..], full[..part.len()], "{cut}");
        assert!(
            part[part.len() - 1] >= least,
            "{cut}: {} s",
            part[part.len() - 1]
        );
        // A cut in the index behind the messages costs nothing, and need not be known.
        if part.len() < full.len() {
            let file = McapFile::open(&path).unwrap();
            assert_eq!(file.cut().unwrap().length, cut);
        }
    }
}

#[test]
fn a_writer_that_is_killed_leaves_what_it_flushed() {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("live.mcap");
    let mut writer = created(&path, &["hip"]);
    write(&mut writer, 1500).unwrap();
    // What another process finds on the disk, nothing finished.
    let seen = save(&folder, &std::fs::read(&path).unwrap());
    let time = &Recording::from_path(&seen).unwrap().channels[0].time;
    assert!(time[time.len() - 1] >= 1.2, "{}", time[time.len() - 1]);
    writer.flush().unwrap();
    let seen = save(&folder, &std::fs::read(&path).unwrap());
    assert_eq!(
        Recording::from_path(&seen).unwrap().channels[0].time.len(),
        1500
    );
}

#[test]
fn a_length_that_lies_takes_no_memory() {
    for place in (8..bare().len().min(6000) - 8).step_by(11) {
        for lie in [u64::MAX, 0x7fff_ffff, 0x7fff_ffff_7fff_ffff] {
            let mut bytes = bare().to_vec();
            bytes[place..place + 8].copy_from_slice(&lie.to_le_bytes());
            let used = allocation_counter::measure(|| look(&bytes));
            // A few copies of the file, its numbers and the text of an error.
            let most = 64 * bytes.len() as u64;
            assert!(
                used.bytes_max < most,
                "byte {place}: {} of {most}",
                used.bytes_max
            );
        }
    }
}

/// A file that defines one message and announces so many topics of it, none of which has any.
fn announced(definition: &str, topics: usize) -> Vec<u8> {
    let options = mcap::WriteOptions::new().compression(None);
    let mut out = options.create(std::io::Cursor::new(Vec::new())).unwrap();
    let schema = out.add_schema("far/msg/T0", "ros2msg", definition.as_bytes());
    let schema = schema.unwrap();
    for topic in 0..topics {
        let name = format!("/{topic}");
        out.add_channel(schema, &name, "cdr", &Default::default())
            .unwrap();
    }
    out.finish().unwrap();
    out.into_inner().into_inner()
}

#[test]
fn records_of_two_records_each_are_not_all_visited() {
    // The deepest holds no number: 2^31 ways lead to nothing.
    let mut definition = String::from("far/T1 left\nfar/T1 right\nint8 here\n");
    for depth in 1..31 {
        let next = depth + 1;
        definition += &format!("MSG: far/T{depth}\nfar/T{next} left\nfar/T{next} right\n");
    }
    definition += "MSG: far/T31\nstring text\n";
    let folder = TempDir::new().unwrap();
    let file = McapFile::open(&save(&folder, &announced(&definition, 1))).unwrap();
    assert_eq!(file.topics()[0].fields(), ["here"]);
}

#[test]
fn topics_of_one_type_share_its_definition() {
    let definition: String = (0..2000)
        .map(|field| format!("int8 field_{field}\n"))
        .collect();
    let bytes = announced(&definition, 2000);
    let used = allocation_counter::measure(|| look(&bytes));
    let most = 64 * bytes.len() as u64;
    assert!(used.bytes_max < most, "{} of {most}", used.bytes_max);
}

/// A file without compression and sums, so that changed bytes reach definitions and messages.
fn bare() -> &'static [u8] {
    static BYTES: OnceLock<Vec<u8>> = OnceLock::new();
    BYTES.get_or_init(|| {
        let options = mcap::WriteOptions::new()
            .compression(None)
            .calculate_chunk_crcs(false)
            .chunk_size(Some(2048));
        let mut out = options.create(std::io::Cursor::new(Vec::new())).unwrap();
        for message in mcap::MessageStream::new(whole()).unwrap().take(60) {
            out.write(&message.unwrap()).unwrap();
        }
        out.finish().unwrap();
        out.into_inner().into_inner()
    })
}

/// Reads a file as a recording and looks at it as `quell inspect` does.
fn look(bytes: &[u8]) {
    let folder = TempDir::new().unwrap();
    let path = save(&folder, bytes);
    let Ok(file) = McapFile::open(&path) else {
        return;
    };
    for joint in file.joints() {
        if let Ok(recording) = file.recording(Some(&joint)) {
            for channel in &recording.channels {
                assert!(channel.time.windows(2).all(|pair| pair[0] < pair[1]));
                remarks(channel, &health(channel));
            }
        }
    }
}

/// Mends a file, and holds what comes of it against what the reader of the format's own library wants.
fn whole_again(bytes: &[u8]) {
    let folder = TempDir::new().unwrap();
    let mended = McapFile::mended(&save(&folder, bytes)).unwrap();
    let messages = mcap::MessageStream::new(&mended.bytes).unwrap();
    let messages = messages.map(Result::unwrap).count() as u64;
    let summary = mcap::Summary::read(&mended.bytes).unwrap().unwrap();
    assert_eq!(messages, mended.messages);
    assert_eq!(summary.stats.unwrap().message_count, messages);
}

#[test]
fn a_file_that_is_mended_has_every_message_of_the_one_that_was_cut() {
    let folder = TempDir::new().unwrap();
    for cut in [
        whole().len() / 3,
        whole().len() / 2,
        whole().len() - 1,
        whole().len(),
    ] {
        let cut = &whole()[..cut];
        whole_again(cut);
        let path = save(&folder, cut);
        let mended = McapFile::mended(&path).unwrap();
        assert_eq!(mended.damage, None);
        let before = Recording::from_path(&path).unwrap();
        let after = McapFile::of(&path, mended.bytes).unwrap().recording(None);
        assert_eq!(after.unwrap(), before);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn no_bytes_make_it_panic(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        length in (any::<prop::sample::Index>(), any::<u64>()),
        cut in any::<prop::sample::Index>(),
        is_cut: bool,
        is_bare: bool,
        noise in proptest::collection::vec(any::<u8>(), 0..99),
    ) {
        let mut bytes = match is_bare {
            true => bare().to_vec(),
            false => whole()[..20_000.min(whole().len())].to_vec(),
        };
        for (place, byte) in changes {
            let place = place.index(bytes.len());
            bytes[place] = byte;
        }
        // A length that is far beyond what is there.
        let place = length.0.index(bytes.len() - 8);
        if length.1 % 2 == 0 {
            bytes[place..place + 8].copy_from_slice(&(u64::MAX >> (length.1 % 33)).to_le_bytes());
        }
        if is_cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        look(&bytes);
        whole_again(&bytes);
        look(&noise);
        look(&[mcap::MAGIC, &noise].concat());
    }
}
