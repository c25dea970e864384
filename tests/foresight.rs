//! A correction that is searched for beside the tick, at 1 kHz: the command is the one that the tick itself would have sent, to the bit.

mod embedded;

use embedded::axis_settings;
use proptest::prelude::*;
use quell::controller::{AxisSettings, Controller, Lent, RetuneOutcome, Setpoint};
use quell_shapers::{GridTrain, Mode, Refusal, Tap, UncertainMode, shaper_by_name};
use quell_trajectories::{AxisState, Limits, Planner, SampledTrajectory};

const PERIOD: f64 = 0.001;
const LIMITS: Limits = Limits {
    velocity: 2.6,
    acceleration: 10.0,
    jerk: 1000.0,
};

fn controller(plan: &SampledTrajectory) -> Controller {
    let belief = Mode::from_hertz(9.0, 0.05).expect("a mode");
    let settings = AxisSettings {
        limits: LIMITS,
        shaper: shaper_by_name("zvd"),
        adaptive: false,
        ..axis_settings(belief, PERIOD, PERIOD)
    };
    let mut controller = Controller::new(settings, 0.0).expect("a controller");
    controller.keep_spare();
    controller.load(plan.clone()).expect("it begins here");
    controller
}

fn plan(target: f64) -> SampledTrajectory {
    let ends = [0.0, target].map(AxisState::at_rest);
    let planner = Planner::new(1).expect("a planner");
    let plan = planner
        .plan(&ends[..1], &ends[1..], &[LIMITS])
        .expect("a plan");
    plan.sample(PERIOD).expect("samples")
}

fn modes(hertz: &[f64]) -> Vec<UncertainMode> {
    let known = hertz.iter().map(|hertz| {
        let mode = Mode::from_hertz(*hertz, 0.03).expect("a mode");
        UncertainMode {
            mode,
            natural_frequency_std: 0.003 * mode.natural_frequency(),
            damping_ratio_std: 0.003,
        }
    });
    known.collect()
}

/// Sixteen impulses over 0.2 s.
fn train() -> GridTrain {
    let tap = |k: u32| Tap {
        delay: 12 * k,
        amplitude: 1.0 / 16.0,
    };
    let taps: Vec<_> = (0..16).map(tap).collect();
    GridTrain::from_taps(&taps, PERIOD).expect("a train")
}

/// The command until the axis rests.
fn rest(controller: &mut Controller) -> Vec<Setpoint> {
    let mut sent = Vec::new();
    while !controller.is_settled() && sent.len() < 20_000 {
        sent.push(controller.tick(&[]));
    }
    sent
}

/// Lends after some ticks, runs ahead, and searches.
fn looked(
    controller: &mut Controller,
    plan: &SampledTrajectory,
    [after, ahead]: [usize; 2],
    modes: &[UncertainMode],
) -> Option<Box<Lent>> {
    (0..after).for_each(|_| {
        controller.tick(&[]);
    });
    let mut lent = None;
    let counted = allocation_counter::measure(|| lent = controller.lend());
    assert_eq!(counted.count_total, 0);
    let mut lent = lent.expect("it is there");
    assert!(controller.lend().is_none());
    let planned = |k: usize| {
        let state = plan.state(0, after + k - 1).expect("a state");
        Setpoint {
            position: state.position,
            velocity: state.velocity,
            acceleration: state.acceleration,
        }
    };
    lent.retune((&train(), modes), ahead, plan.samples() - after, planned);
    Some(lent)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn val_it_is_what_the_tick_itself_would_have_done(
        target in 0.5..2.0_f64,
        after in 50..250_usize,
        ahead in 1..60_usize,
        count in 1..=3_usize,
        early in 0..2_usize,
    ) {
        let modes = modes(&[8.0, 19.0, 31.0][..count]);
        let plan = plan(target);
        let mut own = controller(&plan);
        (0..after + ahead).for_each(|_| { own.tick(&[]); });
        let outcome = own.retune(&train(), &modes[0], &modes);

        let mut other = controller(&plan);
        let mut lent = looked(&mut other, &plan, [after, ahead], &modes);
        (0..ahead - early).for_each(|_| { other.tick(&[]); });
        prop_assert_eq!(other.due_in(lent.as_deref().expect("lent")), early as i64);
        let mut answer = RetuneOutcome::Installed;
        let counted = allocation_counter::measure(|| {
            answer = other.adopt(&mut lent, &modes[0], &modes);
        });
        prop_assert_eq!(counted.count_total, 0);
        if early == 0 {
            prop_assert_eq!(answer, outcome);
            prop_assert_eq!(rest(&mut other), rest(&mut own));
        } else {
            // At another tick than its own it is not taken.
            prop_assert_eq!(answer, RetuneOutcome::Refused(Refusal::Busy));
            let mut plain = controller(&plan);
            (0..after + ahead - early).for_each(|_| { plain.tick(&[]); });
            prop_assert_eq!(rest(&mut other), rest(&mut plain));
        }
    }
}

/// A plan that came meanwhile: the copy is of another command.
#[test]
fn what_has_changed_since_is_not_gone_on_with() {
    let (modes, plan) = (modes(&[8.0, 19.0]), plan(1.0));
    let mut controller = controller(&plan);
    let mut lent = looked(&mut controller, &plan, [150, 20], &modes);
    (0..10).for_each(|_| {
        controller.tick(&[]);
    });
    let here = controller.planned();
    let from = AxisState {
        position: here.position,
        velocity: here.velocity,
        acceleration: here.acceleration,
    };
    let planner = Planner::new(1).expect("a planner");
    let stop = planner.plan_stop(&[from], &[LIMITS]).expect("a stop");
    controller
        .load(stop.sample(PERIOD).expect("samples"))
        .expect("it begins here");
    (0..10).for_each(|_| {
        controller.tick(&[]);
    });
    let answer = controller.adopt(&mut lent, &modes[0], &modes);
    assert_eq!(answer, RetuneOutcome::Refused(Refusal::Busy));
    assert!(controller.lend().is_some());
}
