//! Axes that keep a path in space: all run the trains of all.

use core::borrow::BorrowMut;

use quell_shapers::{GridTrain, Setpoint, ShaperError, ShapingFilter};

use super::Controller;

/// Keeps the path in space of axes that move together.
///
/// Axes that run their own trains have the least delay, but different lags, so that they leave the path while
/// they move. Here every axis runs the trains of all axes, one after the other. All are delayed alike, each is
/// the same function of the path parameter, and the path is kept to rounding; the delays of the trains add up.
/// New trains take effect at rest, on all axes with the same tick, whatever the axes' own
/// [`super::RetunePolicy`] says.
pub struct KeptPath {
    /// Number of ticks for which every command has stood still.
    rested: usize,
}

impl KeptPath {
    /// Keeps the path of `axes` from now on; all must be at rest. Allocates.
    ///
    /// # Errors
    /// [`ShaperError`] where the axes have different control periods.
    pub fn new<C: BorrowMut<Controller>>(axes: &mut [C]) -> Result<Self, ShaperError> {
        let each = || axes.iter().map(|controller| controller.borrow().axis());
        let trains: Vec<_> = each().map(|axis| axis.next_train().clone()).collect();
        let capacities: Vec<_> = each().map(|axis| axis.filter.capacity()).collect();
        let lane = |(index, controller): (_, &C)| {
            Lane::new(index, controller.borrow(), &trains, &capacities)
        };
        let lanes = axes.iter().enumerate().map(lane);
        let lanes: Vec<_> = lanes.collect::<Result<_, _>>()?;
        for (controller, lane) in axes.iter_mut().zip(lanes) {
            controller.borrow_mut().axis.enter(lane)?;
        }
        Ok(Self { rested: 0 })
    }

    /// To be called before each tick of the same `axes`: puts waiting trains in force on all axes with this
    /// tick. No allocation.
    pub fn exchange_trains<C: BorrowMut<Controller>>(&mut self, axes: &mut [C]) {
        let settled = axes.iter().all(|axis| axis.borrow().is_settled());
        self.rested = match settled {
            true => self.rested.saturating_add(1),
            false => 0,
        };
        for index in 0..axes.len() {
            let lane = axes[index].borrow_mut().axis.lane.as_mut();
            if let Some(train) = lane.and_then(|lane| lane.take_waiting(self.rested)) {
                for axis in axes.iter_mut() {
                    let lane = axis.borrow_mut().axis.lane.as_mut();
                    lane.into_iter()
                        .for_each(|lane| lane.install(index, &train));
                }
            }
        }
    }
}

/// The trains of all axes as one axis runs them, in the order of the axes.
pub(super) struct Lane {
    filters: Vec<ShapingFilter>,
    /// Index of the train for this axis' own mode.
    axis: usize,
    waiting: Option<GridTrain>,
}

impl Lane {
    /// The lane of one axis at rest, for trains of up to `capacities` ticks.
    fn new(
        axis: usize,
        controller: &Controller,
        trains: &[GridTrain],
        capacities: &[usize],
    ) -> Result<Self, ShaperError> {
        let filter = |(train, &capacity): (&GridTrain, &usize)| {
            let mut filter = ShapingFilter::new(controller.sample_time(), capacity);
            filter.install(train)?;
            filter.reset(controller.planned().position);
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

    /// Keeps a train until all axes rest; returns whether it fits.
    pub fn wait_with(&mut self, train: &GridTrain) -> bool {
        let fits = train.duration_in_ticks() <= self.capacity();
        if fits {
            self.waiting = Some(train.clone());
        }
        fits
    }

    /// The waiting train, once all axes have rested for as many ticks as it needs to take over at once.
    pub fn take_waiting(&mut self, ticks: usize) -> Option<GridTrain> {
        let ready = |train: &mut GridTrain| train.duration_in_ticks() < ticks;
        self.waiting.take_if(ready)
    }

    /// Puts a train in force for the mode of some axis. At rest it takes over at once.
    pub fn install(&mut self, axis: usize, train: &GridTrain) {
        if let Some(filter) = self.filters.get_mut(axis) {
            // The length was checked by the axis that designed it, the grid when the lane was created.
            let _ = filter.install(train);
        }
    }
}
