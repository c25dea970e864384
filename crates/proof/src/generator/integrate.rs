//! Runge-Kutta with small fixed steps that end where something sticks, slips or touches.

/// States that a plant may have.
pub const STATES: usize = 18;

/// All states of a plant; which is which the plant knows.
pub type State = [f64; STATES];

/// The present state of dry friction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Contact {
    /// The two sides move together.
    Stuck,
    /// They slide, in the direction of the sign (1 or -1).
    Sliding(f64),
}

/// A mechanical system with at most one pair of surfaces that stick and slip.
pub trait Plant {
    /// Rates of all states.
    fn rates(&self, time: f64, state: &State, contact: Contact) -> State;
    /// Velocity between the surfaces; `None` without dry friction.
    fn slip(&self, time: f64, state: &State) -> Option<f64>;
    /// By how much the force that holds the surfaces together exceeds what friction can give: not above
    /// 0 while they stick. With it the direction in which they would slide.
    fn excess(&self, time: f64, state: &State) -> (f64, f64);
    /// Takes the last rounding out of a slip velocity that is zero.
    fn arrest(&self, time: f64, state: &mut State);
    /// Functions whose changes of sign end a step: distances to what may be touched.
    fn edges(&self, time: f64, state: &State) -> [f64; 4];
    /// The target of a sensor, and its rate.
    fn shown(&self, time: f64, state: &State, rates: &State) -> [f64; 2];
}

/// Steps are halved so often to find an instant: 2^-30 of a step.
const HALVINGS: usize = 30;
/// Events that one step may have; chatter beyond that ends in sticking.
const MOST_EVENTS: usize = 12;

/// Integrates from `start` with steps of at most `step`, and returns what is shown at `instants`
/// (increasing). Steps end at each of `breaks` (increasing).
pub fn integrate(
    plant: &impl Plant,
    start: State,
    step: f64,
    breaks: &[f64],
    instants: &[f64],
) -> Vec<f64> {
    let Some(&end) = instants.last() else {
        return Vec::new();
    };
    let mut run = Run::new(plant, start);
    let mut seen = Vec::with_capacity(instants.len());
    let mut breaks = breaks.iter().copied().filter(|&t| t > 0.0).peekable();
    while seen.len() < instants.len() && run.time <= end {
        while breaks.next_if(|&t| t <= run.time + 1e-12).is_some() {}
        let left = breaks.peek().map_or(step, |next| next - run.time);
        // Two equal steps rather than a very short last one.
        let size = match left {
            left if left <= step => left,
            left if left < 2.0 * step => 0.5 * left,
            _ => step,
        };
        // Most steps are between two samples: only those that hold one are looked into.
        let looked = instants[seen.len()] <= run.time + size;
        let before = looked.then(|| (run.time, run.shown()));
        run.advance(size);
        let Some(before) = before else { continue };
        let after = (run.time, run.shown());
        while let Some(&instant) = instants.get(seen.len()).filter(|&&t| t <= run.time) {
            seen.push(hermite(before, after, instant));
        }
    }
    seen
}

/// Value at an instant of the cubic through two values and rates.
fn hermite((t0, [y0, v0]): (f64, [f64; 2]), (t1, [y1, v1]): (f64, [f64; 2]), time: f64) -> f64 {
    let h = t1 - t0;
    let s = (time - t0) / h;
    let (a, b) = (1.0 - s, s);
    let slope = y1 - y0;
    y0 * a + y1 * b + a * b * (a * (h * v0 - slope) - b * (h * v1 - slope))
}

struct Run<'p, P> {
    plant: &'p P,
    time: f64,
    state: State,
    contact: Contact,
}

impl<'p, P: Plant> Run<'p, P> {
    fn new(plant: &'p P, state: State) -> Self {
        let mut run = Self {
            plant,
            time: 0.0,
            state,
            contact: Contact::Sliding(1.0),
        };
        if plant.slip(0.0, &state).is_some() {
            run.settle_contact();
        }
        run
    }

    fn shown(&self) -> [f64; 2] {
        let rates = self.plant.rates(self.time, &self.state, self.contact);
        self.plant.shown(self.time, &self.state, &rates)
    }

    /// One step, cut at the events within it.
    fn advance(&mut self, size: f64) {
        let end = self.time + size;
        for _ in 0..MOST_EVENTS {
            let whole = end - self.time;
            let next = self.stepped(whole);
            let Some(share) = self.first_event(&next, whole) else {
                self.state = next;
                self.time = end;
                return;
            };
            let slipped = self.friction_event(&self.stepped(share * whole), share * whole);
            self.state = self.stepped(share * whole);
            self.time += share * whole;
            if slipped {
                self.settle_contact();
            }
            if end - self.time < 1e-9 * size {
                self.time = end;
                return;
            }
        }
        self.state = self.stepped(end - self.time);
        self.time = end;
    }

    /// Where in the step the first event lies, as a share of it, just after it happened.
    fn first_event(&self, next: &State, whole: f64) -> Option<f64> {
        let start = self.plant.edges(self.time, &self.state);
        let happened = |state: &State, size: f64| {
            let edges = self.plant.edges(self.time + size, state);
            let crossed = start.iter().zip(edges).any(|(a, b)| a * b < 0.0);
            crossed || self.friction_event(state, size)
        };
        if !happened(next, whole) {
            return None;
        }
        let (mut before, mut after) = (0.0, 1.0);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (before + after);
            if happened(&self.stepped(middle * whole), middle * whole) {
                after = middle;
            } else {
                before = middle;
            }
        }
        Some(after)
    }

    /// Whether friction changes its state within a step that leads to `state`.
    fn friction_event(&self, state: &State, size: f64) -> bool {
        let Some(slip) = self.plant.slip(self.time + size, state) else {
            return false;
        };
        match self.contact {
            Contact::Sliding(sign) => slip * sign < 0.0,
            Contact::Stuck => self.plant.excess(self.time + size, state).0 > 0.0,
        }
    }

    /// At rest against each other: hold, or slide in the direction of the greater force.
    fn settle_contact(&mut self) {
        self.plant.arrest(self.time, &mut self.state);
        let (excess, direction) = self.plant.excess(self.time, &self.state);
        self.contact = if excess > 0.0 {
            Contact::Sliding(direction)
        } else {
            Contact::Stuck
        };
    }

    /// The classical fourth-order step.
    fn stepped(&self, h: f64) -> State {
        let (t, x) = (self.time, &self.state);
        let rates = |t: f64, x: &State| self.plant.rates(t, x, self.contact);
        let k1 = rates(t, x);
        let k2 = rates(t + 0.5 * h, &moved(x, 0.5 * h, &k1));
        let k3 = rates(t + 0.5 * h, &moved(x, 0.5 * h, &k2));
        let k4 = rates(t + h, &moved(x, h, &k3));
        std::array::from_fn(|i| x[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    }
}

fn moved(x: &State, h: f64, rate: &State) -> State {
    std::array::from_fn(|i| x[i] + h * rate[i])
}
