//! Corrections in motion for one to three modes: a way is found in almost every move, and it leaves nothing.

mod embedded;

use embedded::axis_settings;
use quell::controller::{AxisSettings, Controller, RetuneOutcome, Setpoint};
use quell_shapers::{GridTrain, Mode, UncertainMode, shaper_by_name};
use quell_trajectories::{AxisState, Limits, Planner, SampledTrajectory};
use rand::{Rng, SeedableRng};
use rand_chacha::ChaCha8Rng;

const PERIOD: f64 = 0.004;
const LIMITS: Limits = Limits {
    velocity: 2.6,
    acceleration: 10.0,
    jerk: 1000.0,
};
/// Moves for each number of modes.
const MOVES: usize = 60;
/// Ticks from one try to the next: a period of 8 Hz, as in the service.
const TRIED: usize = 31;

fn plan(target: f64) -> SampledTrajectory {
    let ends = [0.0, target].map(AxisState::at_rest);
    let planner = Planner::new(1).expect("a planner");
    let plan = planner.plan(&ends[..1], &ends[1..], &[LIMITS]);
    plan.expect("a plan").sample(PERIOD).expect("samples")
}

/// Amplitude that a command leaves in a mode, rad: `|sum du_k exp(lambda t_k)|`.
fn left(sent: &[Setpoint], mode: Mode) -> f64 {
    let (decay, omega) = (mode.decay_rate(), mode.damped_frequency());
    let (mut parts, mut before) = ([0.0; 2], 0.0);
    for (k, now) in sent.iter().enumerate() {
        let age = (sent.len() - k) as f64 * PERIOD;
        let size = (now.position - before) * (-decay * age).exp();
        parts[0] += size * (omega * age).cos();
        parts[1] += size * (omega * age).sin();
        before = now.position;
    }
    parts[0].hypot(parts[1])
}

/// What a move leaves in all modes, rad, and whether it was corrected after so many ticks, tried again and again.
fn run(target: f64, belief: f64, modes: &[UncertainMode], after: Option<usize>) -> (f64, bool) {
    let belief = Mode::from_hertz(belief, 0.05).expect("a mode");
    let settings = AxisSettings {
        limits: LIMITS,
        adaptive: false,
        longest_train: 1.0,
        ..axis_settings(belief, PERIOD, PERIOD)
    };
    let mut controller = Controller::new(settings, 0.0).expect("a controller");
    controller.load(plan(target)).expect("it begins here");
    let zvd = shaper_by_name("zvd").expect("a shaper");
    let each = modes
        .iter()
        .map(|known| zvd.on_grid_for(known, PERIOD).expect("a train"));
    let train = each
        .reduce(|product: GridTrain, train| product.convolve(&train).expect("a product"))
        .expect("a mode");
    let (mut sent, mut corrected) = (Vec::new(), false);
    while sent.is_empty() || !controller.is_settled() {
        let due =
            after.is_some_and(|after| sent.len() >= after && (sent.len() - after) % TRIED == 0);
        if due && !corrected {
            let outcome = controller.retune(&train, &modes[0], modes);
            corrected = matches!(outcome, RetuneOutcome::Corrected(_));
        }
        sent.push(controller.tick(&[]));
    }
    (
        modes.iter().map(|known| left(&sent, known.mode)).sum(),
        corrected,
    )
}

#[test]
fn three_modes_are_corrected_for_as_one_is() {
    let mut random = ChaCha8Rng::seed_from_u64(19);
    for count in 1..=3 {
        let (mut shares, mut found) = (Vec::new(), 0);
        for _ in 0..MOVES {
            let first = random.random_range(6.0..12.0);
            let ratios = [
                1.0,
                random.random_range(1.7..3.0),
                random.random_range(3.2..4.7),
            ];
            let modes = ratios.map(|ratio| {
                let mode = Mode::from_hertz(first * ratio, 0.03).expect("a mode");
                UncertainMode {
                    mode,
                    natural_frequency_std: 0.003 * mode.natural_frequency(),
                    damping_ratio_std: 0.003,
                }
            });
            let (target, belief) = (random.random_range(0.5..1.5), 1.15 * first);
            let after = random.random_range(40..100);
            let (before, _) = run(target, belief, &modes[..count], None);
            let (now, corrected) = run(target, belief, &modes[..count], Some(after));
            found += usize::from(corrected);
            shares.push(now / before);
        }
        shares.sort_by(f64::total_cmp);
        let [median, most] = [shares[MOVES / 2], shares[MOVES - 1]];
        println!(
            "{count} modes: {found} of {MOVES} corrected; {median:.1e} in the median, {most:.2} at most"
        );
        assert!(found * 20 >= MOVES * 19, "{found} of {MOVES}");
        assert!(median < 1e-6 && most < 1.0 + 1e-9, "{median} {most}");
    }
}
