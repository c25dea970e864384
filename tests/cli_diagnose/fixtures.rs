//! Diagnoses as the library makes them, once a run: of cases of the proof's generator, and of one of them at rest.

use quell::diagnosis::{Options, Outcome, diagnose};
use quell::effects::{Catalogue, EFFECTS};
use quell::model::Model;
use quell::proof::{Case, Kind, generate_kind};
use quell::recording::{Channel, Recording, Role};
use std::sync::OnceLock;

/// A kind of cases, what one of them hides, and a seed whose first cases have it: each takes half a second to make.
type Hidden = (Kind, &'static [&'static str], u64);
/// A machine that lacks nothing, one with a law of the catalogue, and one with a law that no catalogue holds.
pub const CLEAN: Hidden = (Kind::Clean, &[], 5);
pub const DAMPED: Hidden = (Kind::Single, &["quadratic_damping"], 6);
const DRAGGED: Hidden = (Kind::Single, &["viscous_drag"], 2);
const OUTSIDE: Hidden = (Kind::Outside, &["parametric_stiffness"], 5);

/// The first case of the generator that hides these effects.
pub fn case(hidden: Hidden) -> Case {
    cases(hidden).next().unwrap()
}

fn cases((kind, hidden, seed): Hidden) -> impl Iterator<Item = Case> {
    let cases = (0..).map(move |index| generate_kind(kind, seed, index).unwrap());
    cases.filter(move |case| {
        let effects = case.truth.effects.iter();
        effects
            .map(|one| one.effect.as_str())
            .eq(hidden.iter().copied())
    })
}

/// A recording's diagnosis, and the effects that it looked through.
pub struct Diagnosed {
    pub name: &'static str,
    pub catalogue: Catalogue,
    pub outcome: Outcome,
}

/// One recording for each thing that a diagnosis can say, as far as that can be known before.
pub fn all() -> &'static [Diagnosed] {
    static ALL: OnceLock<Vec<Diagnosed>> = OnceLock::new();
    ALL.get_or_init(|| {
        let whole = Catalogue::default();
        let from = |name, which, catalogue| {
            let case = case(which);
            diagnosed(name, case.model, case.train, catalogue)
        };
        let (model, rest) = rest();
        vec![
            from("clean", CLEAN, whole),
            from("damped", DAMPED, whole),
            from("dragged", DRAGGED, whole),
            from("outside", OUTSIDE, whole),
            from("unlisted", DAMPED, without_its_law()),
            diagnosed("rest", model, rest, whole),
        ]
    })
}

fn diagnosed(
    name: &'static str,
    model: String,
    recording: Recording,
    catalogue: Catalogue,
) -> Diagnosed {
    let believed = Model::from_toml(&model, "model.toml").unwrap();
    let options = Options {
        catalogue,
        ..Options::default()
    };
    let outcome = diagnose(&believed, &[recording], &[], &options, &|_, _| {}).unwrap();
    Diagnosed {
        name,
        catalogue,
        outcome,
    }
}

/// A catalogue of one effect, a clock that runs fast, which explains no damping: what is found is a learned law.
fn without_its_law() -> Catalogue {
    let clock = EFFECTS
        .iter()
        .position(|effect| effect.name == "clock_skew");
    let clock = clock.unwrap();
    Catalogue(&EFFECTS[clock..=clock])
}

/// A clean machine before its first move, whose sensors show noise. That of a tip in space has a direction then, in which
/// nothing moves.
fn rest() -> (String, Recording) {
    let still = |case: Case| (case.model, before_the_first_move(case.train));
    let mut machines = cases(CLEAN).map(still);
    let shows_noise = |own: &Channel| own.columns.len() == 1 && own.varies();
    let noisy = |(_, rest): &(String, Recording)| rest.channels.iter().any(shows_noise);
    machines.find(noisy).unwrap()
}

fn before_the_first_move(mut recording: Recording) -> Recording {
    let motor = recording.channel(Role::MotorPosition).unwrap();
    let moves = |position: &f64| *position != motor.columns[0][0];
    let begins = motor.time[motor.columns[0].iter().position(moves).unwrap()];
    for channel in &mut recording.channels {
        let before = channel.time.partition_point(|&time| time < begins);
        channel.time.truncate(before);
        channel
            .columns
            .iter_mut()
            .for_each(|column| column.truncate(before));
    }
    recording
}
