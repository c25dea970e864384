//! Axes that keep a path in space: all run the trains of all.

use quell_shapers::{GridTrain, Setpoint, ShaperError, ShapingFilter};

/// What shaping does to the path of a move of several axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathPolicy {
    /// Each axis runs its own train: least delay, but the axes lag differently and the path in space
    /// is left while they move.
    Independent,
    /// Every axis runs the trains of all axes, one after the other. All are then delayed alike, each
    /// is the same function of the path parameter, and the path is kept to rounding; the added
    /// delays add up. New trains take effect at rest, on all axes with the same tick, whatever the
    /// axes' own [`super::RetunePolicy`] says.
    Kept,
}

/// The trains of all axes as one axis runs them, in the order of the axes.
pub(super) struct Lane {
    filters: Vec<ShapingFilter>,
    /// Which of them is for this axis' own mode.
    axis: usize,
    waiting: Option<GridTrain>,
}

impl Lane {
    /// The lane of one axis at rest at `position`, for trains of up to `capacities` ticks.
    pub fn new(
        axis: usize,
        position: f64,
        trains: &[GridTrain],
        capacities: &[usize],
    ) -> Result<Self, ShaperError> {
        let filter = |(train, &capacity): (&GridTrain, &usize)| {
            let mut filter = ShapingFilter::new(train.sample_time(), capacity);
            filter.install(train)?;
            filter.reset(position);
            Ok(filter)
        };
        Ok(Self {
            filters: trains
                .iter()
                .zip(capacities)
                .map(filter)
                .collect::<Result<_, _>>()?,
            axis,
            waiting: None,
        })
    }

    pub fn step(&mut self, planned: Setpoint) -> Setpoint {
        self.filters
            .iter_mut()
            .fold(planned, |setpoint, filter| filter.step(setpoint))
    }

    pub fn is_settled(&self) -> bool {
        self.filters.iter().all(ShapingFilter::is_settled)
    }

    /// The train in force for this axis' own mode.
    pub fn own(&self) -> &GridTrain {
        self.filters[self.axis].train()
    }

    /// The train for this axis' own mode that the next move will meet.
    pub fn next_own(&self) -> &GridTrain {
        self.waiting.as_ref().unwrap_or(self.own())
    }

    /// Whether a train waits for all axes to rest.
    pub fn is_train_waiting(&self) -> bool {
        self.waiting.is_some()
    }

    /// The longest train for this axis' own mode, ticks.
    pub fn capacity(&self) -> usize {
        self.filters[self.axis].capacity()
    }

    /// Keeps a train until all axes rest; says whether it fits.
    pub fn wait_with(&mut self, train: &GridTrain) -> bool {
        let fits = train.duration_in_ticks() <= self.capacity();
        if fits {
            self.waiting = Some(train.clone());
        }
        fits
    }

    /// The train that waits, once all axes have rested for `ticks` that it needs to take over at
    /// once.
    pub fn take_waiting(&mut self, ticks: usize) -> Option<GridTrain> {
        let ready = |train: &mut GridTrain| train.duration_in_ticks() < ticks;
        self.waiting.take_if(ready)
    }

    /// Puts a train in force for the mode of some axis. At rest it takes over at once.
    pub fn install(&mut self, axis: usize, train: &GridTrain) {
        if let Some(filter) = self.filters.get_mut(axis) {
            // The length was checked by the axis that designed it, the grid when the lane was made.
            let _ = filter.install(train);
        }
    }
}
