//! A sensor's clock that is set: the stamps that the link hands on go as by the clock before.

use std::time::Duration;

use quell::service::contract::{Measured, Quantity};
use quell::service::link::{Ear, UdpSettings};

use super::world::ROBOT;

/// Encoder and deformation are on the robot's clock, the tip on one of its own, 3 s ahead. Every sample is late by 0 to 2 ms.
struct Robot {
    ahead: f64,
    tip_ahead: f64,
}

/// What the link hands on over 4 s; the clocks are set at 1.5 s and at 3 s.
fn heard(leaps: [(f64, f64); 2]) -> Vec<Measured> {
    let (mut ear, mut heard) = Ear::new(UdpSettings {
        address: ROBOT,
        robot: None,
        joints: vec!["joint_1".into()],
        watchdog: Duration::from_millis(200),
        key: None,
    });
    let mut robot = Robot {
        ahead: 500.0,
        tip_ahead: 503.0,
    };
    let mut all = Vec::new();
    for k in 0..4000 {
        if k == 1500 || k == 3000 {
            let (both, tip) = leaps[k / 1500 - 1];
            robot.ahead += both;
            robot.tip_ahead += both + tip;
        }
        let time = 0.001 * k as f64;
        let now = time + 0.001 * (k % 3) as f64;
        let said = [
            (robot.ahead, "\"motor_position\":1,\"deformation\":2"),
            (robot.tip_ahead, "\"tip_position\":[1,2,3]"),
        ];
        for (ahead, what) in said {
            let stamp = time + ahead;
            let text = format!("{{\"t\":{stamp:.6},\"joint\":\"joint_1\",{what}}}");
            ear.hear(text.as_bytes(), ROBOT, now);
        }
        let mut inbox = Vec::with_capacity(16);
        heard.receive(&mut inbox);
        all.extend(inbox);
    }
    all
}

/// Leaps on and back, of all clocks and of the tip's alone, once and again: seven samples of a sensor are lost until a leap is
/// believed, and no more. Stamps go on, and those of one clock stay together.
#[test]
fn stamps_go_on_as_by_the_clock_before() {
    for leaps in [
        [(0.0, 0.0), (0.0, 0.0)],
        [(0.0, 7200.0), (0.0, 0.0)],
        [(0.0, -7200.0), (0.0, 7200.0)],
        [(0.0, 1.7e9), (1.7e9, 0.0)],
        [(-2.0, 0.0), (3.0, 0.0)],
        [(1.7e9, 0.0), (0.0, -3600.0)],
        [(1.7e9, 0.3), (0.0, 0.0)],
    ] {
        let all = heard(leaps);
        let of = |quantity| {
            let one = all.iter().filter(|one| one.quantity == quantity);
            one.collect::<Vec<_>>()
        };
        let motor = of(Quantity::MotorPosition);
        for (quantity, ahead) in [
            (Quantity::MotorPosition, 500.0),
            (Quantity::Deformation, 500.0),
            (Quantity::TipPosition, 503.0),
        ] {
            let sensor = of(quantity);
            assert!(sensor.len() >= 4000 - 2 * 7, "{leaps:?} {quantity:?}");
            assert!(sensor.windows(2).all(|two| two[1].stamp > two[0].stamp));
            for one in &sensor {
                // What was measured at an instant is received 0 to 2 ms later.
                let beyond = one.received - one.stamp + ahead;
                // Eight samples have one of the least delay; 2^-22 s is the resolution of a stamp since 1970.
                assert!((-1e-6..2.001e-3).contains(&beyond), "{leaps:?} {one:?}");
            }
        }
        let deformation = of(Quantity::Deformation);
        assert!(
            motor
                .iter()
                .zip(deformation)
                .all(|(one, other)| one.stamp == other.stamp)
        );
    }
}
