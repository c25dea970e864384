//! A diagnosis that its caller stops. Its work is counted in the simulations of this process, so all is one test.

use quell::diagnosis::{DiagnosisError, Options, Stop, diagnose};
use quell::model::effects::Catalogue;
use quell::model::{Model, simulations};
use quell::proof::{Case, Kind, generate_kind};
use std::slice::from_ref;

/// The effects of the case and some others: all steps of a search, and few simulations in each.
const FEW: [&str; 6] = [
    "backlash",
    "bilinear_stiffness",
    "coulomb_friction",
    "sensor_delay",
    "viscoelastic_creep",
    "viscous_drag",
];

fn few() -> Catalogue {
    let all = Catalogue::default().0.iter().copied();
    let few: Vec<_> = all.filter(|own| FEW.contains(&own.name)).collect();
    Catalogue(few.leak())
}

/// Stops after so many simulations, and returns how many were made and how it ended.
fn diagnosed(case: &Case, most: u64) -> (u64, Result<(), DiagnosisError>) {
    let model = Model::from_toml(&case.model, "model.toml").unwrap();
    let before = simulations();
    let options = Options {
        stop: Stop::when(move || simulations() - before >= most),
        catalogue: few(),
        ..Options::default()
    };
    let ended = diagnose(&model, from_ref(&case.train), &[], &options, &|_, _| {});
    (simulations() - before, ended.map(|_| ()))
}

/// Wherever it is stopped, it ends with that error: what was not simulated must not be reckoned with.
#[test]
fn it_ends_wherever_it_is_stopped() {
    for (kind, seed) in [(Kind::Clean, 7), (Kind::Pair, 1)] {
        let case = generate_kind(kind, seed, 0).unwrap();
        let (all, ended) = diagnosed(&case, u64::MAX);
        assert!(ended.is_ok(), "{ended:?}");
        let mut most = 1;
        while most < all {
            let (_, ended) = diagnosed(&case, most);
            let stopped = matches!(ended, Err(DiagnosisError::Stopped));
            assert!(stopped, "{kind:?} {seed}, {most} of {all}: {ended:?}");
            most += 1 + most / 5;
        }
    }
}
