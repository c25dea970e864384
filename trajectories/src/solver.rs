//! Ruckig's objects, kept from plan to plan.

use std::cell::RefCell;

use ruckig::{InputParameter, Ruckig};

use crate::MAX_DEGREES_OF_FREEDOM;

/// The objects of Ruckig for a number of axes.
///
/// Creating it takes as long as planning a move of one axis. Each problem sets all inputs that this crate uses,
/// and Ruckig derives the rest from them, so that earlier plans have no effect.
pub(crate) struct Solver {
    pub(crate) input: InputParameter,
    pub(crate) solution: ruckig::Trajectory,
    ruckig: Ruckig,
}

impl Solver {
    pub(crate) fn new(axes: usize) -> Self {
        Self {
            input: InputParameter::new(axes),
            solution: ruckig::Trajectory::new_direct(axes),
            ruckig: Ruckig::new_direct_and_offline(axes),
        }
    }

    /// Solves the input; the answer is in the solution.
    pub(crate) fn solve(&mut self) -> ruckig::Result {
        self.ruckig.calculate(&mut self.input, &mut self.solution)
    }

    /// Works with this thread's solver for 1 to 7 axes; Ruckig's objects cannot change threads.
    pub(crate) fn kept<T>(axes: usize, work: impl FnOnce(&mut Self) -> T) -> T {
        thread_local! {
            static KEPT: RefCell<[Option<Solver>; MAX_DEGREES_OF_FREEDOM]> = const {
                RefCell::new([const { None }; MAX_DEGREES_OF_FREEDOM])
            };
        }
        KEPT.with_borrow_mut(|kept| match kept.get_mut(axes - 1) {
            Some(place) => work(place.get_or_insert_with(|| Self::new(axes))),
            None => work(&mut Self::new(axes)),
        })
    }
}
