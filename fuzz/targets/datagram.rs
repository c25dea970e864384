//! Datagrams of a robot, one a line, as the link takes them: signature, number, values, stamps, guard.
#![no_main]

use libfuzzer_sys::fuzz_target;
use quell::service::contract::Measured;
use quell::service::guard::{Bounds, CommandedMotion, Guard};
use quell::service::link::datagram::{FromRobot, LONGEST};
use quell::service::link::{ClockOffset, Order, Sequence};
use quell::service::signature::{Key, Replay};
use quell_trajectories::Limits;

/// The largest magnitude that the reader lets through.
const LARGEST: f64 = 1e12;

const BOUNDS: Bounds = Bounds {
    limits: Limits {
        velocity: 2.6,
        acceleration: 10.0,
        jerk: 80.0,
    },
    radius: 1.7,
    deformation: 0.1,
    resolution: 1e-6,
};

fuzz_target!(|bytes: &[u8]| {
    let key = Key::new("a key of the fuzzer").expect("a key");
    let (mut replay, mut guard) = (Replay::default(), Guard::new(BOUNDS));
    let (mut sequence, mut offset) = (Sequence::default(), ClockOffset::default());
    for (number, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
        assert!(!key.has_signed(line));
        let Some(datagram) = FromRobot::parse(line) else {
            continue;
        };
        signed(&key, line);
        if let Some(number) = datagram.seq {
            replay.admits(number);
            assert!(!replay.admits(number), "{number} is taken twice");
        }
        let received = number as f64 * 0.004;
        if sequence.take(datagram.t) == Order::Restarted {
            offset.restart();
        }
        offset.take(datagram.t, received);
        assert!(offset.offset().is_some_and(f64::is_finite));
        for (quantity, value) in datagram.quantities() {
            assert!(value.iter().all(|value| value.is_nan() || value.abs() <= LARGEST));
            let measured = Measured {
                received,
                stamp: datagram.t,
                joint: 0,
                quantity,
                value,
                refused: false,
            };
            guard.admits(&measured, CommandedMotion::default());
        }
    }
});

/// A text that ends with a brace can be signed; it is known then, and no longer where a byte differs.
fn signed(key: &Key, line: &[u8]) {
    let mut buffer = [0; LONGEST + 128];
    let object = line.trim_ascii_end();
    let Some(part) = buffer.get_mut(..object.len()) else {
        return;
    };
    part.copy_from_slice(object);
    let Some(length) = key.sign(&mut buffer, object.len()) else {
        return;
    };
    assert!(key.has_signed(&buffer[..length]));
    assert!(FromRobot::parse(&buffer[..length]).is_some());
    buffer[length / 2] ^= 1;
    assert!(!key.has_signed(&buffer[..length]));
}
