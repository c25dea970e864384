//! The trains of the catalogue, one after the other for each mode: candidates that need no solver.

use quell_shapers::{GridTrain, SHAPERS, ShaperError, UncertainMode};
use quell_trajectories::{AxisState, Trajectory};

/// The trains of one shaper for all modes, at a control period.
pub struct Trains(Vec<GridTrain>);

impl Trains {
    /// Those of every shaper without negative impulses, the shortest first.
    pub fn of_catalogue<'a>(
        modes: impl Iterator<Item = &'a UncertainMode> + Clone,
        period: f64,
    ) -> Vec<Self> {
        let convex = SHAPERS.iter().filter(|shaper| shaper.is_convex());
        let all = convex.filter_map(|shaper| {
            let each = modes.clone();
            let trains = each.map(|known| shaper.on_grid_for(known, period));
            trains.collect::<Result<_, ShaperError>>().ok().map(Self)
        });
        let mut all: Vec<Self> = all.collect();
        all.sort_by_key(Self::ticks);
        all
    }

    /// By how much they lengthen a move, ticks.
    pub fn ticks(&self) -> usize {
        self.0.iter().map(GridTrain::duration_in_ticks).sum()
    }

    /// The share of a vibration that they leave of a mode.
    pub fn residual(&self, frequency: f64, damping_ratio: f64) -> f64 {
        let each = self.0.iter();
        each.map(|train| train.residual_vibration(frequency, damping_ratio))
            .product()
    }

    /// A plan of one axis from rest to rest after these trains: steps of constant jerk, too.
    pub fn shaped(&self, plan: &Trajectory) -> Option<Trajectory> {
        let axis = &plan.axes()[0];
        let [from, to] = [axis.state_at(0.0), axis.end()];
        let mut changes = Vec::new();
        for phase in axis.phases() {
            changes.push((phase.start, phase.jerk));
            changes.push((phase.start + phase.duration, -phase.jerk));
        }
        for train in &self.0 {
            let delayed = train.taps().iter().flat_map(|tap| {
                let delay = f64::from(tap.delay) * train.sample_time();
                let each = changes.iter();
                each.map(move |(at, jerk)| (at + delay, jerk * tap.amplitude))
            });
            changes = delayed.collect();
        }
        changes.sort_by(|one, other| one.0.total_cmp(&other.0));
        let mut jerk = 0.0;
        let steps = changes.windows(2).filter_map(|pair| {
            jerk += pair[0].1;
            let duration = pair[1].0 - pair[0].0;
            (duration > 0.0).then_some((duration, jerk))
        });
        let steps: Vec<(f64, f64)> = steps.collect();
        let at_rest = |state: AxisState| AxisState::at_rest(state.position);
        Trajectory::of_steps(at_rest(from), at_rest(to), &steps).ok()
    }
}

impl From<GridTrain> for Trains {
    fn from(train: GridTrain) -> Self {
        Self(vec![train])
    }
}
