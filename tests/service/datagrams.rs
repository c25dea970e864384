//! Datagrams that are wrong, forged or repeated: each is counted, none moves anything.

use std::net::{SocketAddr, UdpSocket};
use std::time::{Duration, Instant};

use quell::service::clock::ServiceClock;
use quell::service::contract::{LinkHealth, Measured, Phase};
use quell::service::link::{INBOX, Order, RobotLink, Sequence, UdpLink, UdpSettings};
use quell::service::signature::Key;
use quell_shapers::Setpoint;
use rand::{Rng, RngCore, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::{check, go, phase_is, udp, wait};

const GOOD: &str =
    "{\"t\":12.345,\"joint\":\"joint_1\",\"motor_position\":0.1,\"link_position\":0.1003}";

/// A link, and a socket that is its robot.
struct Bench {
    link: UdpLink,
    robot: UdpSocket,
    taken: Vec<Measured>,
    sent: u64,
}

impl Bench {
    fn new(key: Option<Key>) -> Self {
        let settings = UdpSettings {
            address: SocketAddr::from(([127, 0, 0, 1], 0)),
            robot: None,
            joints: vec!["joint_1".into()],
            watchdog: Duration::from_secs(1),
            key,
        };
        let link = UdpLink::start(settings, ServiceClock::start()).expect("a link");
        let robot = UdpSocket::bind("127.0.0.1:0").expect("a socket");
        robot
            .set_read_timeout(Some(Duration::from_secs(5)))
            .expect("a timeout");
        robot
            .connect(link.address().expect("an address"))
            .expect("a peer");
        let (taken, sent) = (Vec::new(), 0);
        Self {
            link,
            robot,
            taken,
            sent,
        }
    }

    fn send(&mut self, datagram: &[u8]) {
        self.robot.send(datagram).expect("it is sent");
        self.sent += 1;
    }

    /// Waits until the link has seen everything; takes what it hands on.
    fn drain(&mut self) -> LinkHealth {
        let since = Instant::now();
        loop {
            let counters = self.link.counters();
            let mut inbox = Vec::with_capacity(INBOX);
            self.link.receive(0.0, &mut inbox);
            let empty = inbox.is_empty();
            self.taken.append(&mut inbox);
            if counters.received == self.sent && empty {
                return counters;
            }
            assert!(since.elapsed() < Duration::from_secs(10), "{counters:?}");
            std::thread::yield_now();
        }
    }
}

/// Something that may or may not be a datagram.
fn mutated(chance: &mut ChaCha8Rng, number: u64) -> Vec<u8> {
    let good = GOOD.replace("12.345", &format!("{}", 12.0 + 0.001 * number as f64));
    let mut bytes = good.into_bytes();
    match chance.random_range(0..6) {
        0 => {
            bytes.resize(chance.random_range(0..3000), 0);
            chance.fill_bytes(&mut bytes);
        }
        1 => {
            let cut = chance.random_range(0..bytes.len());
            bytes.truncate(cut);
        }
        2 => {
            for _ in 0..chance.random_range(1..4) {
                let at = chance.random_range(0..bytes.len());
                bytes[at] = chance.random();
            }
        }
        3 => {
            let words = [
                "1e999", "-1e300", "NaN", "null", "[1,2]", "\"x\"", "{}", "1e-320", "-0",
            ];
            let word = words[chance.random_range(0..words.len())];
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let old = ["0.1003", "\"joint_1\"", "0.1,"][chance.random_range(0..3)];
            bytes = text.replacen(old, word, 1).into_bytes();
        }
        4 => {
            let (a, b) = (
                chance.random_range(0..bytes.len()),
                chance.random_range(0..bytes.len()),
            );
            let piece = bytes[a.min(b)..a.max(b)].to_vec();
            let at = chance.random_range(0..bytes.len());
            bytes.splice(at..at, piece);
        }
        _ => {}
    }
    bytes
}

#[test]
fn a_hundred_thousand_datagrams_are_each_counted() {
    let mut bench = Bench::new(None);
    let mut chance = ChaCha8Rng::seed_from_u64(7);
    let good = GOOD.as_bytes().to_vec();
    bench.send(&good);
    bench.drain();
    for round in 0..1000 {
        for number in 0..100 {
            let datagram = mutated(&mut chance, 100 * round + number);
            bench.send(&datagram);
        }
        bench.drain();
    }
    let counted = bench.drain();
    assert_eq!(counted.received, 100_001);
    assert_eq!((counted.overflowed, counted.foreign), (0, 0));
    // A reading that is no number is missing.
    let usual = |value: &f64| value.is_nan() || value.abs() <= 1e12;
    let fine = |m: &Measured| m.stamp.is_finite() && m.value.iter().all(usual);
    assert!(bench.taken.iter().all(fine));
    assert!(bench.taken.iter().any(|m| m.value[0].is_nan()));
    // Each is malformed, of another joint, out of order, twice there, or taken: with one or two values.
    let refused = counted.malformed + counted.unknown_joint + counted.doubled + counted.reordered;
    let taken = bench.taken.len() as u64;
    assert!(
        counted.malformed > 40_000 && counted.unknown_joint > 1000,
        "{counted:?}"
    );
    assert!(
        refused + taken >= 100_001 && refused + taken / 2 <= 100_001,
        "{counted:?} {taken}"
    );
}

#[test]
fn a_stamp_that_comes_late_is_reordered_and_not_lost() {
    let mut sequence = Sequence::default();
    let mut lost = 0;
    let mut take = |number: u32| {
        let order = sequence.take(5.0 + 0.001 * f64::from(number));
        if let Order::Next { lost: more } = order {
            lost += more;
        }
        order
    };
    for number in (0..2000).filter(|number| ![100, 101, 200, 300, 1200].contains(number)) {
        take(number);
        match number {
            // Two behind, and sixty.
            202 => assert_eq!(take(200), Order::Older),
            360 => assert_eq!(take(300), Order::Older),
            // Once more is no other one.
            400 => assert_eq!(take(398), Order::Older),
            // After it was given up.
            1300 => assert_eq!(take(1200), Order::Older),
            _ => {}
        }
    }
    // A pause of longer than is remembered.
    take(2500);
    for number in 2501..2700 {
        take(number);
    }
    assert_eq!(lost, 3 + 500);
}

#[test]
fn wild_datagrams_during_a_move_do_not_move_the_setpoint() {
    let data = tempfile::tempdir().expect("a folder");
    let (service, handle, robot) = udp(data.path());
    let address = service.udp_address().expect("a UDP link");
    let id = go(&handle, 1.0, None);
    let mut chance = ChaCha8Rng::seed_from_u64(11);
    for number in 0..5000 {
        // From the robot's own address; the stamps lie about its clock, too.
        robot.send(&mutated(&mut chance, number), address);
        if number % 20 == 0 {
            std::thread::sleep(Duration::from_millis(2));
        }
    }
    wait(&handle, "it rests", phase_is(Phase::Rest));
    let snapshot = handle.snapshot();
    assert!(snapshot.link.malformed > 1000, "{:?}", snapshot.link);
    assert_eq!(snapshot.joints[0].move_id, id);
    check(&robot.received.lock().expect("no panic"), &snapshot);
}

#[test]
fn with_a_key_only_what_is_signed_and_new_is_taken_and_what_goes_out_is_signed() {
    let key = Key::new("a key of the two of them").expect("a key");
    let mut bench = Bench::new(Some(key.clone()));
    let signed = |number: u64, key: &Key| {
        let text = GOOD.replacen('{', &format!("{{\"seq\":{number},"), 1);
        let mut buffer = [0; 512];
        buffer[..text.len()].copy_from_slice(text.as_bytes());
        let length = key.sign(&mut buffer, text.len()).expect("room");
        buffer[..length].to_vec()
    };
    let stranger = Key::new("a key of somebody else's").expect("a key");
    bench.send(GOOD.as_bytes());
    bench.send(&signed(4, &stranger));
    let counted = bench.drain();
    // Whoever cannot sign is not taken for the robot either.
    assert_eq!((counted.unsigned, counted.peer), (2, None));
    assert!(bench.taken.is_empty());
    let good = signed(5, &key);
    bench.send(&good);
    bench.send(&good);
    let mut without = GOOD.as_bytes().to_vec();
    without.resize(512, 0);
    let length = key.sign(&mut without, GOOD.len()).expect("room");
    bench.send(&without[..length]);
    let counted = bench.drain();
    assert_eq!((counted.replayed, counted.malformed), (1, 1), "{counted:?}");
    assert_eq!(bench.taken.len(), 2);
    let mut numbers = Vec::new();
    for position in [0.1, 0.2] {
        bench.link.send(1.0, 0, &Setpoint::at_rest(position));
        let mut buffer = [0; 512];
        let length = bench.robot.recv(&mut buffer).expect("a setpoint");
        assert!(key.has_signed(&buffer[..length]));
        let said: serde_json::Value = serde_json::from_slice(&buffer[..length]).expect("JSON");
        assert_eq!(said["position"], position);
        numbers.push(said["seq"].as_u64().expect("a number"));
    }
    // Numbers go on from the clock of the wall, also after the next start.
    assert!(
        numbers[0] > 1_500_000_000_000_000 && numbers[1] == numbers[0] + 1,
        "{numbers:?}"
    );
}
