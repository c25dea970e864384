//! Dry friction: its levels, and the steps that their change with the speed needs.

use super::Spline;

/// Dry friction between two sides that stick until the force that holds them exceeds `breakaway`,
/// and slide against `F_c + (F_s - F_c) exp(-(v / v_s)^2)`, or against a level that is a curve over the speed or over the position.
#[derive(Clone, Debug, PartialEq)]
pub struct Friction {
    /// Kinetic friction `F_c` for positive and for negative slip velocity, force, at least 0.
    pub kinetic: [f64; 2],
    /// Force `F_s` at which sticking ends in each direction, at least the kinetic one.
    pub breakaway: [f64; 2],
    /// Stribeck velocity `v_s`, above 0.
    pub stribeck_velocity: f64,
    /// Velocity `v_0` of friction that grows as `F_c tanh(v / v_0)` and does not stick; 0 where it jumps.
    pub transition_velocity: f64,
    /// Levels that are curves, instead of the above; negative values count as 0.
    pub levels: Option<Box<Levels>>,
}

/// Levels of friction that are curves.
#[derive(Clone, Debug, PartialEq)]
pub enum Levels {
    /// Over the speed, for positive and for negative slip velocity.
    OverSpeed([Spline; 2]),
    /// The same over `asinh(v / s)`, `s` a slow speed: their knots are dense about rest.
    OverLogSpeed([Spline; 2], f64),
    /// Over the position, at rest and at any speed.
    OverPosition(Spline),
}

/// Change of the friction level with the speed.
pub(crate) struct Change {
    /// Largest change of the force.
    pub force: f64,
    /// Speeds at which the level changes, the steepest zone first. Beyond the last one it is constant.
    pub zones: Vec<Zone>,
}

/// Speeds at which friction needs short steps of the integration.
#[derive(Clone, Copy)]
pub struct Zone {
    /// Speed beyond which a flatter zone begins.
    pub until: f64,
    /// Largest change of the speed within a step.
    pub step: f64,
}

impl Zone {
    /// The longest step at a speed that has this rate of change, to which friction may add its `drop`; `h` outside the zone, or to
    /// its border.
    pub(crate) fn longest(&self, speed: f64, change: f64, drop: f64, h: f64) -> f64 {
        let above = speed - self.until;
        match above > 0.0 {
            true if above + change * h < 0.0 => -1.01 * above / change,
            true => h,
            false => self.step / (change.abs() + drop),
        }
    }
}

impl Change {
    /// Most divisions of a step while friction depends on the speed, a power of 2.
    pub(crate) const FINEST: f64 = 32.0;

    /// Of levels over equally spaced speeds.
    fn of_even(levels: &[Spline; 2]) -> Self {
        let spacing = levels
            .iter()
            .map(Spline::spacing)
            .fold(f64::INFINITY, f64::min);
        let falls = levels.iter().map(Spline::steepest_fall);
        Self {
            force: falls.fold(0.0, f64::max),
            zones: vec![Zone {
                until: f64::INFINITY,
                step: 0.5 * spacing,
            }],
        }
    }

    /// Of levels over `asinh(v / slow)`, whose slope falls with the speed: zones of half, a quarter, ... of the steepest slope.
    /// What is flatter needs no division where the steepest has the most.
    fn of_dense(levels: &[Spline; 2], slow: f64) -> Self {
        let (mut force, mut slopes) = (0.0_f64, Vec::new());
        for level in levels {
            let knots: Vec<[f64; 2]> = level
                .knots()
                .map(|[u, level]| [slow * u.sinh(), level.max(0.0)])
                .collect();
            let values = || knots.iter().map(|own| own[1]);
            let most = values().fold(0.0, f64::max);
            force = force.max(most - values().fold(f64::INFINITY, f64::min));
            slopes.extend(knots.windows(2).map(|own| {
                let [before, after] = [own[0], own[1]];
                // A rise is stable, as for a transition velocity; a fall is as that of Stribeck friction.
                let slope = (after[1] - before[1]) / (after[0] - before[0]);
                let steep = if slope > 0.0 {
                    0.5 * slope
                } else {
                    -2.0 * slope
                };
                [after[0], steep]
            }));
        }
        let steepest = slopes.iter().fold(0.0, |most: f64, own| most.max(own[1]));
        let octaves = (0..Self::FINEST.log2() as i32).map(|k| steepest * 0.5_f64.powi(k));
        let zone = |most: f64| {
            let steep = slopes.iter().filter(|own| 2.0 * own[1] > most);
            Zone {
                until: steep.fold(0.0, |until, own| until.max(own[0])),
                step: force / most,
            }
        };
        let mut zones: Vec<Zone> = octaves.map(zone).collect();
        zones.dedup_by(|next, zone| next.until == zone.until);
        Self { force, zones }
    }
}

impl Friction {
    /// Friction with these levels over the speed, for positive and for negative slip velocity; it sticks up to
    /// those at speed 0.
    pub fn over_speed(levels: [Spline; 2]) -> Self {
        let at_rest = [0, 1].map(|side: usize| levels[side].value(0.0).max(0.0));
        Self::of_levels(at_rest, Levels::OverSpeed(levels))
    }

    /// The same with levels over `asinh(v / slow)`. A level that is 0 at rest does not stick.
    pub fn over_log_speed(levels: [Spline; 2], slow: f64) -> Self {
        let at_rest = [0, 1].map(|side: usize| levels[side].value(0.0).max(0.0));
        Self::of_levels(at_rest, Levels::OverLogSpeed(levels, slow))
    }

    /// Friction with this level over the position, the same in both directions and at all speeds.
    pub fn over_position(level: Spline) -> Self {
        Self::of_levels([0.0; 2], Levels::OverPosition(level))
    }

    fn of_levels(at_rest: [f64; 2], levels: Levels) -> Self {
        Self {
            kinetic: at_rest,
            breakaway: at_rest,
            stribeck_velocity: 1.0,
            transition_velocity: 0.0,
            levels: Some(Box::new(levels)),
        }
    }

    /// Force at which sticking ends in each direction at a position.
    #[inline]
    pub(crate) fn breakaway_at(&self, position: f64) -> [f64; 2] {
        match self.levels.as_deref() {
            Some(Levels::OverPosition(level)) => [level.nearest(position).max(0.0); 2],
            _ => self.breakaway,
        }
    }

    /// Whether the force at which sticking ends depends on the position.
    pub(crate) fn varies(&self) -> bool {
        matches!(self.levels.as_deref(), Some(Levels::OverPosition(_)))
    }

    /// Change of the level with the speed.
    pub(crate) fn change(&self) -> Change {
        match self.levels.as_deref() {
            Some(Levels::OverSpeed(levels)) => return Change::of_even(levels),
            Some(Levels::OverLogSpeed(levels, slow)) => return Change::of_dense(levels, *slow),
            Some(Levels::OverPosition(_)) | None => {}
        }
        let [up, down] = [0, 1].map(|side| self.breakaway[side] - self.kinetic[side]);
        let (force, step, velocity) = match self.transition_velocity > 0.0 {
            // A rise is stable: RK4 is stable in steps up to 2.8 of its time constants. It is 1 to .005 at the end.
            true => (
                self.kinetic[0].max(self.kinetic[1]),
                2.0,
                self.transition_velocity,
            ),
            // The force is the kinetic one to 1e-4 at the end.
            false => (up.max(down), 0.5, self.stribeck_velocity),
        };
        Change {
            force,
            zones: vec![Zone {
                until: 3.0 * velocity,
                step: step * velocity,
            }],
        }
    }

    /// Level at a position and a slip speed in the direction of `sign`.
    #[inline]
    pub fn level(&self, sign: f64, position: f64, speed: f64) -> f64 {
        let side = usize::from(sign < 0.0);
        let (kinetic, breakaway) = (self.kinetic[side], self.breakaway[side]);
        match self.levels.as_deref() {
            Some(Levels::OverSpeed(levels)) => return levels[side].value(speed).max(0.0),
            Some(Levels::OverLogSpeed(levels, slow)) => {
                // The standard one takes three times as long, for digits about 0 that no level has.
                let ratio = (speed / slow).abs();
                let asinh = (ratio + (ratio * ratio + 1.0).sqrt()).ln();
                return levels[side].value(asinh.copysign(speed)).max(0.0);
            }
            Some(Levels::OverPosition(level)) => return level.nearest(position).max(0.0),
            None => {}
        }
        if self.transition_velocity > 0.0 {
            return kinetic * (speed / self.transition_velocity).tanh();
        }
        if breakaway == kinetic || self.stribeck_velocity == 0.0 {
            return kinetic;
        }
        kinetic + (breakaway - kinetic) * (-(speed / self.stribeck_velocity).powi(2)).exp()
    }
}
