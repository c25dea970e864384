//! Choice of the size of a hidden effect.

use super::Channel;
use super::hidden::{Entry, Parameters, Scales};
use super::programme::Programme;
use super::random::Draw;
use super::refit::{Beside, leftover, leftover_beside};
use super::sensors::Arm;

/// Least and greatest share of the deformation that an effect leaves.
pub const SHARES: [f64; 2] = [0.03, 0.30];
/// Residual of a refit, over the noise, from which it is plain that something is there.
const PLAIN: f64 = 1.3;
/// Below this residual over the noise a refit hides the effect: with some 2000 samples the excess is
/// 3 standard deviations of a chi-squared sum.
pub const HIDDEN: f64 = 1.05;
/// Samples on which sizes are judged.
const SAMPLES: usize = 1200;

/// The reference of an effect's size: the arm without it.
pub struct Bench<'a> {
    /// The arm as it is before the effect.
    pub arm: &'a Arm,
    /// Moves of the recording to be diagnosed.
    pub programme: &'a Programme,
    /// Sizes of the motion.
    pub scales: &'a Scales,
    /// One standard deviation of the sensor's noise.
    pub noise: f64,
    stamps: Vec<f64>,
    clean: Vec<Vec<f64>>,
    deformation: f64,
}

/// Something hidden at a chosen size.
pub struct Concealed {
    /// Its kind.
    pub entry: &'static Entry,
    /// Its place and shape, as four numbers in [0, 1).
    pub shape: [f64; 4],
    /// Its size.
    pub size: f64,
    /// Its parameters.
    pub parameters: Parameters,
    /// Rms of its change over the rms of the deformation.
    pub share: f64,
    /// Rms over the noise after a refit of the nominal structure.
    pub residual: f64,
}

impl<'a> Bench<'a> {
    /// Simulates the arm without the effect.
    pub fn new(arm: &'a Arm, programme: &'a Programme, scales: &'a Scales, noise: f64) -> Self {
        let spacing = programme.duration / SAMPLES as f64;
        let stamps: Vec<f64> = (1..SAMPLES).map(|k| k as f64 * spacing).collect();
        let mut bench = Self {
            arm,
            programme,
            scales,
            noise,
            stamps,
            clean: Vec::new(),
            deformation: 0.0,
        };
        bench.clean = bench.read(arm);
        let still: Vec<f64> = bench.stamps.iter().map(|_| 0.0).collect();
        let motor = |&stamp: &f64| programme.at(arm.true_time(stamp))[0];
        let deformation = match arm.channel {
            Channel::Deformation => rms_change(&bench.clean, &[still], false),
            Channel::Link => {
                let motor = bench.stamps.iter().map(motor).collect();
                rms_change(&bench.clean, &[motor], false)
            }
            Channel::Tip => scales.deformation_rms * arm.lever_arm,
        };
        bench.deformation = deformation;
        bench
    }

    fn read(&self, arm: &Arm) -> Vec<Vec<f64>> {
        let step = 0.05 / self.scales.natural_frequency;
        arm.read(self.programme, &self.stamps, step)
    }

    /// Hides an effect so that it leaves a drawn share of the deformation and is not wholly absorbed by a
    /// refit of the nominal structure; `None` where it cannot.
    pub fn conceal(&self, draw: &mut Draw, entry: &'static Entry) -> Option<Concealed> {
        let shape = [(); 4].map(|()| draw.uniform(0.0, 1.0));
        let mut target = draw.log_uniform(SHARES[0], SHARES[1]);
        let nearly_hidden = draw.chance(0.3);
        let mut start = entry.sizes[0];
        loop {
            let found = self.size(entry, shape, target, start)?;
            if !self.shows_as_itself(&found) {
                return None;
            }
            let least = if nearly_hidden { HIDDEN } else { PLAIN };
            if found.residual >= least {
                return Some(found);
            }
            if target >= SHARES[1] {
                return (found.residual >= HIDDEN).then_some(found);
            }
            (target, start) = ((2.0 * target).min(SHARES[1]), 2.0 * found.size);
        }
    }

    /// The size whose change is this share of the deformation, within a tenth; the greatest size where
    /// that leaves a share that is large enough.
    fn size(
        &self,
        entry: &'static Entry,
        shape: [f64; 4],
        target: f64,
        start: f64,
    ) -> Option<Concealed> {
        let mut bracket = Bracket::new(start, entry.sizes[1]);
        for _ in 0..10 {
            let size = bracket.size;
            let mut arm = self.arm.clone();
            let parameters = (entry.hide)(&mut arm, self.scales, shape, size);
            let columns = self.read(&arm);
            let share = self.share(&columns);
            let within = (share / target - 1.0).abs() < 0.1;
            let full = size >= bracket.most && share >= SHARES[0] && share < target;
            if (within || full) && share <= SHARES[1] * 1.1 {
                let left = leftover(&arm, self.programme, &self.stamps, &columns) / self.noise;
                return Some(Concealed {
                    entry,
                    shape,
                    size,
                    parameters,
                    share,
                    residual: left.hypot(1.0),
                });
            }
            bracket = bracket.next(share, target)?;
        }
        None
    }

    /// Whether the effect still shows beside a simpler law that it contains: an unobservable effect is not
    /// hidden.
    fn shows_as_itself(&self, concealed: &Concealed) -> bool {
        let Some(simpler) = concealed.entry.contains else {
            return true;
        };
        let mut arm = self.arm.clone();
        (concealed.entry.hide)(&mut arm, self.scales, concealed.shape, concealed.size);
        let columns = self.read(&arm);
        let grow = |arm: &mut Arm, by: &[f64]| {
            simpler(
                arm,
                self.scales,
                concealed.shape,
                concealed.size,
                [by[0], by[1]],
            );
        };
        self.shows_beside(
            &arm,
            &columns,
            Beside {
                factors: 2,
                grow: &grow,
            },
        )
    }

    /// Whether something of what an arm shows is left where a refit may make use of another law.
    fn shows_beside(&self, arm: &Arm, columns: &[Vec<f64>], beside: Beside) -> bool {
        let left = leftover_beside(arm, self.programme, &self.stamps, columns, beside);
        (left / self.noise).hypot(1.0) >= HIDDEN
    }

    /// Whether none of several is hidden by a refit of the nominal structure with the others in it, of any size.
    pub fn all_show(&self, hidden: &[Concealed]) -> bool {
        if hidden.len() < 2 {
            return true;
        }
        let mut arm = self.arm.clone();
        for one in hidden {
            (one.entry.hide)(&mut arm, self.scales, one.shape, one.size);
        }
        let columns = self.read(&arm);
        (0..hidden.len()).rev().all(|own| {
            let others = || hidden.iter().enumerate().filter(move |(k, _)| *k != own);
            let grow = |arm: &mut Arm, by: &[f64]| {
                for ((_, other), by) in others().zip(by) {
                    (other.entry.hide)(arm, self.scales, other.shape, other.size * by);
                }
            };
            let factors = (hidden.len() - 1).max(2);
            self.shows_beside(
                &arm,
                &columns,
                Beside {
                    factors,
                    grow: &grow,
                },
            )
        })
    }

    fn share(&self, columns: &[Vec<f64>]) -> f64 {
        let own_clock = self.arm.channel != Channel::Deformation;
        rms_change(columns, &self.clean, own_clock) / self.deformation
    }

    /// Residual over the noise of several effects together.
    pub fn residual(&self, arm: &Arm) -> f64 {
        let columns = self.read(arm);
        (leftover(arm, self.programme, &self.stamps, &columns) / self.noise).hypot(1.0)
    }
}

/// Sizes between which the right one lies; the share grows with the size, though not always evenly.
struct Bracket {
    size: f64,
    low: f64,
    high: f64,
    most: f64,
}

impl Bracket {
    fn new(start: f64, most: f64) -> Self {
        Self {
            size: start.min(most),
            low: 0.0,
            high: f64::INFINITY,
            most,
        }
    }

    /// Around another size after this one left that share; `None` where there is none to try.
    fn next(mut self, share: f64, target: f64) -> Option<Self> {
        if !share.is_finite() {
            return None;
        }
        if share < target {
            self.low = self.size;
        } else {
            self.high = self.size;
        }
        let guess = self.size * (target / share.max(1e-6)).clamp(0.2, 5.0);
        self.size = if guess > self.low && guess < self.high {
            guess
        } else if self.high.is_finite() {
            0.5 * (self.low + self.high)
        } else {
            2.0 * self.low
        };
        self.size = self.size.min(self.most);
        (self.low < self.most).then_some(self)
    }
}

/// Rms of the change of readings, without the change of their mean and, if the sensor has its own clock,
/// without the effect of a clock shift: any fit includes these two.
fn rms_change(with: &[Vec<f64>], without: &[Vec<f64>], own_clock: bool) -> f64 {
    let mut changes = Vec::new();
    let mut slopes = Vec::new();
    for (a, b) in with.iter().zip(without) {
        changes.push(centred(a.iter().zip(b).map(|(a, b)| a - b).collect()));
        let later = b.iter().skip(2).chain(b.last()).chain(b.last());
        slopes.push(centred(
            later.zip(b).map(|(late, early)| late - early).collect(),
        ));
    }
    let count = with.first().map_or(1, Vec::len) as f64;
    let (changes, slopes) = (changes.concat(), slopes.concat());
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut left = product(&changes, &changes);
    if own_clock {
        left -= product(&changes, &slopes).powi(2) / product(&slopes, &slopes).max(1e-300);
    }
    (left.max(0.0) / count).sqrt()
}

fn centred(mut values: Vec<f64>) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    values.iter_mut().for_each(|value| *value -= mean);
    values
}
