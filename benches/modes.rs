//! What adaptation leaves of the vibration of arms with several modes, and of modes that depend on pose and payload.
//!
//! `cargo bench --bench modes`; `-- --campaign N --from SEED` for random programmes, `-- --attainable N --from SEED`
//! for what the best trains leave of those with backlash.

#[path = "../tests/modes/plant.rs"]
mod plant;
#[path = "../tests/modes/programme.rs"]
mod programme;
#[path = "../tests/modes/random.rs"]
mod random;

#[path = "modes/attainable.rs"]
mod attainable;

use plant::{Faults, PlantMode};
use programme::{Left, Policy, Programme, median, percent, worst};
use rayon::prelude::*;

/// Degrees of a programme: over the whole range, in pieces of unlike length.
const TARGETS: [f64; 12] = [
    60.0, 0.0, 30.0, 55.0, 10.0, 45.0, 5.0, 60.0, 20.0, 40.0, 0.0, 35.0,
];

fn arm(name: &str, modes: &[PlantMode], belief_hz: f64) -> Programme {
    Programme {
        name: name.to_string(),
        modes: modes.to_vec(),
        faults: Faults::USUAL,
        belief_hz,
        shaper: "zvd",
        start: 0.0,
        moves: TARGETS
            .map(|degrees| (f64::to_radians(degrees), 0.0))
            .to_vec(),
        declared: 1.0,
        inertia: None,
        seed: 1,
    }
}

fn arms() -> Vec<Programme> {
    let mode = |hertz, share| PlantMode::new(hertz, 0.03, share);
    // 8 Hz at 0 degrees, 11 Hz at 60.
    let posed = PlantMode {
        slope: 3.0 / 8.0 / 60f64.to_radians(),
        ..mode(8.0, 1.0)
    };
    let loaded = PlantMode {
        payload: 0.8,
        ..mode(8.0, 1.0)
    };
    let mut payload = arm("payload 0-100 %", &[loaded], 8.0);
    for (k, entry) in payload.moves.iter_mut().enumerate() {
        entry.1 = [0.0, 1.0, 0.5, 0.25, 0.75, 0.0, 0.9, 0.1][k % 8];
    }
    vec![
        arm("one mode, belief 25 % off", &[mode(8.0, 1.0)], 10.0),
        arm(
            "8 + 19 Hz, 1 : 1/3",
            &[mode(8.0, 1.0), mode(19.0, 1.0 / 3.0)],
            10.0,
        ),
        arm("8 + 19 Hz, 1 : 1", &[mode(8.0, 1.0), mode(19.0, 1.0)], 8.5),
        arm(
            "8 + 19 + 31 Hz",
            &[mode(8.0, 1.0), mode(19.0, 1.0), mode(31.0, 1.5)],
            9.0,
        ),
        arm("8 -> 11 Hz, belief 10", &[posed], 10.0),
        arm("8 -> 11 Hz, belief 8", &[posed], 8.0),
        payload,
    ]
}

/// Kinds of programmes.
type Kind = (&'static str, fn(&Programme) -> bool);
const KINDS: [Kind; 5] = [
    ("without backlash", |p| p.faults.backlash == 0.0),
    ("without backlash and friction", |p| {
        p.faults.backlash == 0.0 && p.faults.friction == 0.0
    }),
    ("with backlash", |p| p.faults.backlash > 0.0),
    ("one mode", |p| p.modes.len() == 1),
    ("several modes", |p| p.modes.len() > 1),
];

/// Root of the mean square of what the moves left.
fn size(left: &[Left]) -> f64 {
    (left.iter().map(|left| left.residual.powi(2)).sum::<f64>() / left.len() as f64).sqrt()
}

/// A random programme; `--folds` lets the inertia change along the way, not the stiffness.
fn programme_of(seed: u64) -> Programme {
    let mut programme = random::programme(seed);
    let folds = std::env::args().any(|word| word == "--folds");
    programme
        .modes
        .iter_mut()
        .for_each(|mode| mode.folds = folds);
    programme
}

/// What random programmes leave over what they leave without adaptation.
fn campaign(count: u64, from: u64) {
    let run = |seed: u64| {
        let programme = programme_of(seed);
        let [fixed, adaptive, learned] =
            [Policy::Fixed, Policy::Adaptive, Policy::Learned].map(|policy| programme.run(policy));
        let ratio = |left: &[Left], skip: usize| size(&left[skip..]) / size(&fixed[skip..]);
        let each = learned
            .iter()
            .zip(&fixed)
            .map(|(a, b)| format!("{:.2}", a.residual / b.residual));
        let each: Vec<String> = each.collect();
        (
            [ratio(&adaptive, 0), ratio(&learned, 0), ratio(&learned, 2)],
            format!(
                "{:.3} {} {}",
                ratio(&learned, 0),
                each.join(" "),
                programme.name
            ),
            programme,
        )
    };
    let mut all: Vec<_> = (from..from + count).into_par_iter().map(run).collect();
    for (k, name) in ["adaptive", "learned", "learned, from the third move"]
        .iter()
        .enumerate()
    {
        let mut ratios: Vec<f64> = all.iter().map(|one| one.0[k]).collect();
        ratios.sort_by(f64::total_cmp);
        let at = |part: f64| ratios[((ratios.len() - 1) as f64 * part) as usize];
        let worse = ratios.iter().filter(|ratio| **ratio > 1.05).count();
        println!(
            "{name}: median {:.3}, 90 % {:.3}, 99 % {:.3}, worst {:.3}; {worse} of {count} above 1.05",
            at(0.5),
            at(0.9),
            at(0.99),
            at(1.0)
        );
    }
    for (name, is_of) in KINDS {
        let of_kind = all.iter().filter(|one| is_of(&one.2));
        let mut ratios: Vec<f64> = of_kind.map(|one| one.0[1]).collect();
        if !ratios.is_empty() {
            ratios.sort_by(f64::total_cmp);
            println!("{name}: {}, median {:.3}", ratios.len(), median(&ratios));
        }
    }
    all.sort_by(|a, b| b.0[1].total_cmp(&a.0[1]));
    all.iter().take(12).for_each(|one| println!("  {}", one.1));
}

/// What the best trains leave of programmes with backlash, over what they leave without adaptation.
fn best_trains(count: u64, from: u64) {
    let with_gap = (from..).map(programme_of);
    let with_gap = with_gap.filter(|programme| programme.faults.backlash > 0.0);
    for programme in with_gap.take(count as usize) {
        let [fixed, learned] = [Policy::Fixed, Policy::Learned].map(|policy| programme.run(policy));
        let base = size(&fixed);
        let gaps = programme.modes.len() as f64 * programme.faults.backlash;
        println!(
            "{:.3}, from the third move {:.3}, half gaps {:.3}; {}; {}",
            size(&learned) / base,
            size(&learned[2..]) / size(&fixed[2..]),
            gaps / base,
            attainable::attainable(&programme)
                .map(|best| best.over(base))
                .join("; "),
            programme.name
        );
    }
}

fn number(name: &str) -> Option<u64> {
    let mut words = std::env::args().skip_while(|word| word != name);
    words.nth(1).and_then(|word| word.parse().ok())
}

fn main() {
    if let Some(seed) = number("--seed") {
        let programme = programme_of(seed);
        println!(
            "{}\n{:?} belief {:.2} Hz, {}",
            programme.name, programme.modes, programme.belief_hz, programme.shaper
        );
        let [unshaped, fixed, learned] =
            [Policy::Unshaped, Policy::Fixed, Policy::Learned].map(|policy| programme.run(policy));
        for (k, left) in learned.iter().enumerate() {
            let mm = |left: &Left| 1e3 * left.residual;
            println!(
                "{:?}: {:.3} {:.3} {:.3} mrad, {:.3} s, {} retunes, {}",
                programme.moves[k],
                mm(&unshaped[k]),
                mm(&fixed[k]),
                mm(left),
                left.delay,
                left.retunes,
                left.said
            );
        }
        return;
    }
    if let Some(count) = number("--attainable") {
        return best_trains(count, number("--from").unwrap_or(0));
    }
    if let Some(count) = number("--campaign") {
        return campaign(count, number("--from").unwrap_or(0));
    }
    println!(
        "% of the unshaped vibration at the tip: median, worst, of the third move on the same"
    );
    let only = std::env::args().skip_while(|word| word != "--only").nth(1);
    for programme in arms() {
        if only
            .as_ref()
            .is_some_and(|word| !programme.name.contains(word.as_str()))
        {
            continue;
        }
        let unshaped = programme.run(Policy::Unshaped);
        println!("{}", programme.name);
        for policy in [Policy::Fixed, Policy::Adaptive, Policy::Learned] {
            let left = programme.run(policy);
            let all = percent(&left, &unshaped);
            let late = &all[2..];
            let retunes: u32 = left.iter().map(|left| left.retunes).sum();
            let delays: Vec<f64> = left.iter().map(|left| left.delay).collect();
            let each: Vec<String> = all.iter().map(|value| format!("{value:.1}")).collect();
            println!(
                "  {policy:?}: {:.2} {:.2} | {:.2} {:.2} | {retunes} retunes, {:.3} s | {}",
                median(&all),
                worst(&all),
                median(late),
                worst(late),
                median(&delays),
                each.join(" ")
            );
            if policy == Policy::Learned && std::env::args().any(|word| word == "--each") {
                for (left, all) in left.iter().zip(&unshaped) {
                    println!(
                        "    {:.4} of {:.4} mrad, {} retunes, {}",
                        1e3 * left.residual,
                        1e3 * all.residual,
                        left.retunes,
                        left.said
                    );
                }
            }
        }
    }
}
