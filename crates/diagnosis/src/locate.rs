//! Where a model and a recording differ: by place in the chain, in time, over a coordinate, in frequency. This
//! says where to look. Names of effects come from simulation only.

mod basis;
mod candidate_events;
mod colour;
mod coordinate;
mod correlation;
mod frequency;
mod orders;
mod peaks;
mod phases;
mod place;
mod pursuit;
mod refit;
mod responses;
mod search;
mod sensor_side;
mod smoother;
mod stretches;
mod transition;

use quell_model::effects::CandidateStop;
use std::f64::consts::TAU;

use super::{CoordinateTrace, Location};
use smoother::{Smoothed, Smoother};
use transition::Path;

/// Most candidates of a kind.
const MOST: usize = 8;
/// Fewest stamps for a statement.
const FEWEST: usize = 32;

/// Dynamics of a model's error: `e'' + 2 xi w e' + w^2 e = d`; both 0 for a free mass.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dynamics {
    /// `w`, rad/s.
    pub natural_frequency: f64,
    /// `xi`.
    pub damping_ratio: f64,
}

/// The residual of a refitted model in one output of one recording.
#[derive(Clone, Copy, Debug)]
pub struct Residual<'a> {
    /// Stamps, s, increasing; they may be irregular or have gaps.
    pub time: &'a [f64],
    /// Recorded minus model.
    pub residual: &'a [f64],
    /// Standard deviation of the noise.
    pub noise_std: f64,
    /// Position, velocity and acceleration of the motor side at the stamps.
    pub motor: &'a [[f64; 3]],
    /// The same for the link as the model simulates it; the motor side's where there is no link.
    pub link: &'a [[f64; 3]],
    /// Dynamics between a missing force and the output.
    pub dynamics: Dynamics,
    /// Instants at which the simulation was restarted from measured values, s, increasing.
    pub restarts: &'a [f64],
    /// Whether no dynamics lie between cause and output. The residual itself is then the missing part, and the
    /// place is the sensor.
    pub sensor_only: bool,
}

/// Where the mismatch sits.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Located {
    /// Where, in words and numbers; empty where neither force nor sensor error is above chance.
    pub location: Location,
    /// Missing force at the stamps, divided by the inertia: an acceleration of the output (for
    /// `sensor_only` the output itself).
    pub missing: Vec<f64>,
    /// Its standard deviation.
    pub missing_std: Vec<f64>,
    /// Log-likelihood gain of a missing force over noise, white or coloured: the evidence against the equation
    /// of motion.
    pub dynamic_gain: f64,
    /// Log-likelihood gain of the best sensor error that depends on the motion.
    pub sensor_gain: f64,
    /// The coordinate that it follows best, if above chance. The caller adds the units.
    pub coordinate: Option<CoordinateTrace>,
    /// Share of the variance that each coordinate explains, corrected for chance.
    pub explained: Vec<(String, f64)>,
    /// Share of the chi-squared above the noise in each phase of the motion.
    pub phases: Vec<(String, f64)>,
    /// Instants at which something seems to happen, s; the most suspicious first, at most 8.
    pub candidate_events: Vec<f64>,
    /// Angular frequencies that stand out of the residual, rad/s; the strongest first, at most 8.
    pub candidate_frequencies: Vec<f64>,
    /// Radians per unit of position of forces periodic in position; the one that explains most first, at most 8.
    pub candidate_orders: Vec<f64>,
    /// What the link may have met at those candidates that are sudden.
    pub candidate_stops: Vec<CandidateStop>,
}

/// Locates the mismatch behind a residual.
///
/// The missing force `d` in `e'' + 2 xi w e' + w^2 e = d` is modelled as a random walk whose intensity
/// maximises the likelihood; a smoother estimates it at each stamp. It is compared with coordinates, positions
/// and instants. The residual is compared with sensor errors, phases and frequencies. The equation of motion is
/// at fault if the force gains more than coloured noise and more than the sensor, each gain less half the
/// logarithm of the length for each of its parameters (Schwarz, 1978).
///
/// A residual that is too short or not finite gives an empty location. The cost is linear in the length, apart
/// from sorting.
///
/// Source: Kristensen, Madsen and Jorgensen, "A method for systematic improvement of stochastic
/// grey-box models", Computers and Chemical Engineering 28 (2004).
pub fn locate(residual: &Residual) -> Located {
    let n = residual.time.len();
    if !usable(residual) {
        return Located {
            missing: vec![0.0; n],
            missing_std: vec![0.0; n],
            ..Located::default()
        };
    }
    let smoother = smoother(residual);
    let scaled: Vec<f64> = residual
        .residual
        .iter()
        .map(|r| r / residual.noise_std)
        .collect();
    let (intensity, likelihood) = smoother.fit(&scaled);
    let mut smoothed = smoother.smooth(&scaled, intensity);
    let errors = smoothed.error.iter_mut().flatten();
    for value in errors
        .chain(&mut smoothed.missing)
        .chain(&mut smoothed.missing_std)
    {
        *value *= residual.noise_std;
    }
    let dynamic_gain = (likelihood - colour::likelihood(residual.time, &scaled)).max(0.0);
    put_together(residual, &smoother, smoothed, dynamic_gain)
}

/// The location from the missing force and the residual.
fn put_together(
    residual: &Residual,
    smoother: &Smoother,
    smoothed: Smoothed,
    dynamic_gain: f64,
) -> Located {
    let labels = phases::label(residual);
    let moving = coordinate::moving(&labels);
    let (phases, strong_phases) = phases::chi_squared(residual, &labels);
    let refit = refit::refit(residual, smoother);
    let sensor = sensor_side::sensor_side(residual, &refit, time_scale(residual) / TAU);
    let orders = orders::orders(residual, &smoothed.missing, &moving);
    let candidates =
        candidate_events::candidate_events(residual, &smoothed, &moving, time_scale(residual));
    let frequencies =
        |series: &[f64]| frequency::frequencies(residual.time, series, &residual.dynamics);
    let (frequencies, elsewhere) = (frequencies(residual.residual), frequencies(&sensor.left));
    let away = |f: &f64| !frequency::is_near(*f, &residual.dynamics);
    let (explained, mut coordinate) = coordinate::best(residual, &smoothed, &moving);
    let events = candidates
        .iter()
        .filter_map(|s| responses::to_event(smoother, s));
    let ripples = orders
        .iter()
        .map(|&order| responses::to_order(residual, smoother, order));
    let evidence = place::Evidence {
        residual,
        missing: &smoothed.missing,
        dynamic_gain,
        sensor: &sensor,
        events: responses::evidence(residual, &refit, events),
        ripple: responses::evidence(residual, &refit, ripples),
        candidate_events: &candidates,
        rings_elsewhere: elsewhere.iter().any(away),
    };
    let place = evidence.place(&mut coordinate);
    let candidate_orders = match place {
        Some(_) => {
            let all = [orders, orders::slow(residual, &moving)].concat();
            pursuit::pursued(residual, (smoother, &refit), all)
        }
        None => Vec::new(),
    };
    let sudden = candidates
        .iter()
        .filter(|s| s.kind != candidate_events::Kind::Change);
    let stop = |at| candidate_events::stop(residual, &smoothed.missing, at);
    let candidate_stops = sudden.map(|s| stop(s.at)).collect();
    let location = place.map(|place| Location {
        place: Some(place.name().into()),
        phases: strong_phases,
        times_s: stretches::strong(residual, time_scale(residual)),
        coordinate: coordinate.as_ref().map(|c| c.coordinate.clone()),
        frequency_hz: frequencies.first().map(|f| f / TAU),
    });
    Located {
        coordinate: coordinate.filter(|_| place.is_some()),
        location: location.unwrap_or_default(),
        missing: smoothed.missing,
        missing_std: smoothed.missing_std,
        dynamic_gain,
        sensor_gain: sensor.gain,
        explained,
        phases,
        candidate_events: candidates.iter().map(|s| s.time).collect(),
        candidate_stops,
        candidate_frequencies: frequencies,
        candidate_orders,
    }
}

fn usable(residual: &Residual) -> bool {
    let n = residual.time.len();
    let lengths = [
        residual.residual.len(),
        residual.motor.len(),
        residual.link.len(),
    ];
    let motion = residual.motor.iter().chain(residual.link).flatten();
    let mut values = residual.time.iter().chain(residual.residual).chain(motion);
    let Dynamics {
        natural_frequency,
        damping_ratio,
    } = residual.dynamics;
    n >= FEWEST
        && lengths == [n; 3]
        && values.all(|x| x.is_finite())
        && residual.time.windows(2).all(|w| w[1] > w[0])
        && residual.noise_std.is_finite()
        && residual.noise_std > 0.0
        && (natural_frequency.is_finite() && natural_frequency >= 0.0)
        && (damping_ratio.is_finite() && damping_ratio >= 0.0)
        && residual.residual.iter().any(|r| *r != 0.0)
}

/// The period of the mode; where there is none, ten samples or a fiftieth of the recording.
fn time_scale(residual: &Residual) -> f64 {
    let n = residual.time.len();
    let span = residual.time[n - 1] - residual.time[0];
    let w = residual.dynamics.natural_frequency;
    if w > 0.0 && !residual.sensor_only {
        (TAU / w).clamp(3.0 * span / (n - 1) as f64, 0.25 * span)
    } else {
        (10.0 * span / (n - 1) as f64).max(0.02 * span)
    }
}

fn smoother(residual: &Residual) -> Smoother {
    let Dynamics {
        natural_frequency: w,
        damping_ratio,
    } = residual.dynamics;
    let scale = time_scale(residual);
    if residual.sensor_only {
        // There are no dynamics to restart.
        return Smoother::new(Path::Direct, 1.0, residual.time, scale, &[]);
    }
    let path = Path::Motion {
        damping: 2.0 * damping_ratio * w,
        stiffness: w * w,
    };
    Smoother::new(path, TAU / scale, residual.time, scale, residual.restarts)
}
