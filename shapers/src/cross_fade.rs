//! Several trains at work, each fading into the next.

use crate::filter::shape;
use crate::smooth_step::step_at;
use crate::{GridTrain, Setpoint};
use arrayvec::ArrayVec;

/// Trains that can fade into each other at the same time.
const LAYERS: usize = 3;

#[derive(Clone, Debug)]
struct Layer {
    train: GridTrain,
    /// The tick before the first that mixes.
    start: u64,
    ticks: usize,
}

impl Layer {
    /// Share that the train has in the output.
    fn share(&self, tick: u64, sample_time: f64) -> Setpoint {
        let elapsed = tick.saturating_sub(self.start) as f64;
        step_at(elapsed, self.ticks, sample_time)
    }
}

/// The train in force and those that fade in over it.
///
/// With `b` the smooth step of a layer, `y <- (1 - b) y + b y_layer`; velocity and acceleration
/// follow by the product rule, so that all three stay consistent and continuous.
#[derive(Clone, Debug)]
pub(crate) struct CrossFade {
    base: GridTrain,
    layers: ArrayVec<Layer, LAYERS>,
}

impl CrossFade {
    pub fn new(train: GridTrain) -> Self {
        Self {
            base: train,
            layers: ArrayVec::new(),
        }
    }

    /// The train that will be in force when every layer has faded in.
    #[inline]
    pub fn last(&self) -> &GridTrain {
        self.layers.last().map_or(&self.base, |layer| &layer.train)
    }

    /// The longest of the trains at work, ticks.
    #[inline]
    pub fn duration_in_ticks(&self) -> usize {
        self.layers
            .iter()
            .map(|layer| layer.train.duration_in_ticks())
            .fold(self.base.duration_in_ticks(), usize::max)
    }

    /// Whether nothing fades.
    #[inline]
    pub fn is_single(&self) -> bool {
        self.layers.is_empty()
    }

    pub fn is_full(&self) -> bool {
        self.layers.is_full()
    }

    /// Lets a train fade in over `ticks` ticks after tick `start`; ignored where [`Self::is_full`].
    pub fn fade_in(&mut self, train: &GridTrain, start: u64, ticks: usize) {
        if !self.is_full() {
            self.layers.push(Layer {
                train: train.clone(),
                start,
                ticks: ticks.max(1),
            });
        }
    }

    /// Puts one train in force at once: only where the line is constant.
    pub fn replace(&mut self, train: &GridTrain) {
        self.layers.clear();
        self.base.clone_from(train);
    }

    /// Forgets what lies under a layer that has faded in at `tick`.
    pub fn tidy(&mut self, tick: u64) {
        let done = self
            .layers
            .iter()
            .rposition(|layer| tick >= layer.start + layer.ticks as u64);
        if let Some(index) = done {
            self.base.clone_from(&self.layers[index].train);
            self.layers.drain(..=index);
        }
    }

    /// Output at `tick` for inputs given by age.
    pub fn output(
        &self,
        tick: u64,
        sample_time: f64,
        input: impl Fn(usize) -> Setpoint,
    ) -> Setpoint {
        self.mixed(&input, |layer| layer.share(tick, sample_time))
    }

    fn mixed(
        &self,
        input: impl Fn(usize) -> Setpoint,
        share: impl Fn(&Layer) -> Setpoint,
    ) -> Setpoint {
        let alone = shape(&self.base, &input);
        self.layers.iter().fold(alone, |output, layer| {
            mix(output, shape(&layer.train, &input), share(layer))
        })
    }
}

/// The trains of the ticks to come. By reference: a train has 4 KiB.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Trains<'a> {
    /// Those at work.
    AsTheyAre(&'a CrossFade),
    /// Over those at work another fades in, over so many ticks after a tick.
    Fading(&'a CrossFade, &'a GridTrain, u64, usize),
    /// Another takes over at once.
    Switched(&'a GridTrain),
}

impl<'a> Trains<'a> {
    /// The longest of the trains at work, ticks.
    pub fn duration_in_ticks(&self) -> usize {
        match self {
            Self::AsTheyAre(present) => present.duration_in_ticks(),
            Self::Fading(present, next, ..) => {
                present.duration_in_ticks().max(next.duration_in_ticks())
            }
            Self::Switched(next) => next.duration_in_ticks(),
        }
    }

    /// The train at work where it is only one.
    pub fn single(&self) -> Option<&'a GridTrain> {
        match *self {
            Self::AsTheyAre(present) => present.is_single().then(|| present.last()),
            Self::Fading(..) => None,
            Self::Switched(next) => Some(next),
        }
    }

    /// As [`CrossFade::output`].
    pub fn output(
        &self,
        tick: u64,
        sample_time: f64,
        input: impl Fn(usize) -> Setpoint,
    ) -> Setpoint {
        match *self {
            Self::AsTheyAre(present) => present.output(tick, sample_time, input),
            Self::Fading(present, next, start, ticks) => {
                let b = step_at(tick.saturating_sub(start) as f64, ticks, sample_time);
                let faded = shape(next, &input);
                mix(present.output(tick, sample_time, input), faded, b)
            }
            Self::Switched(next) => shape(next, input),
        }
    }

    /// The acceleration of the output that comes from that of the inputs, and not from the fading.
    pub fn planned_acceleration(
        &self,
        tick: u64,
        sample_time: f64,
        input: impl Fn(usize) -> Setpoint,
    ) -> f64 {
        let constant = |share: Setpoint| Setpoint::at_rest(share.position);
        let present = |present: &CrossFade| {
            present.mixed(&input, |layer| constant(layer.share(tick, sample_time)))
        };
        let output = match *self {
            Self::AsTheyAre(trains) => present(trains),
            Self::Fading(trains, next, start, ticks) => {
                let b = step_at(tick.saturating_sub(start) as f64, ticks, sample_time);
                mix(present(trains), shape(next, &input), constant(b))
            }
            Self::Switched(next) => shape(next, &input),
        };
        output.acceleration
    }

    /// The last tick at which a train fades; none where none does.
    pub fn fades_until(&self) -> Option<u64> {
        let last = |trains: &CrossFade| {
            let ends = trains
                .layers
                .iter()
                .map(|layer| layer.start + layer.ticks as u64);
            ends.max()
        };
        match *self {
            Self::AsTheyAre(trains) => last(trains),
            Self::Fading(trains, _, start, ticks) => last(trains).max(Some(start + ticks as u64)),
            Self::Switched(_) => None,
        }
    }
}

fn mix(old: Setpoint, new: Setpoint, b: Setpoint) -> Setpoint {
    let position = new.position - old.position;
    let velocity = new.velocity - old.velocity;
    let acceleration = new.acceleration - old.acceleration;
    Setpoint {
        position: old.position + b.position * position,
        velocity: old.velocity + b.position * velocity + b.velocity * position,
        acceleration: old.acceleration
            + b.position * acceleration
            + 2.0 * b.velocity * velocity
            + b.acceleration * position,
    }
}
