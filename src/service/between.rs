//! The motion between two setpoints.

use quell_shapers::Setpoint;

/// Where a motion is at a `share` (0 to 1) of the `period` (s) that leads from one setpoint to another:
/// the polynomial of fifth order that has position, velocity and acceleration of both at its ends. At 1
/// it is the second one to the bit.
///
/// Within a period the jerk of a plan may change its sign, and the polynomial then changes the
/// acceleration over a period by up to 4 % more than the plan does. Source: Biagiotti and Melchiorri,
/// Trajectory Planning for Automatic Machines and Robots, Springer 2008, section 2.1.
pub fn between([from, to]: [Setpoint; 2], share: f64, period: f64) -> Setpoint {
    if share >= 1.0 {
        return to;
    }
    let (v0, v1) = (from.velocity * period, to.velocity * period);
    let (a0, a1) = (
        from.acceleration * period * period,
        to.acceleration * period * period,
    );
    let way = to.position - from.position;
    let c2 = 0.5 * a0;
    let c3 = 10.0 * way - 6.0 * v0 - 4.0 * v1 - 1.5 * a0 + 0.5 * a1;
    let c4 = -15.0 * way + 8.0 * v0 + 7.0 * v1 + 1.5 * a0 - a1;
    let c5 = 6.0 * way - 3.0 * (v0 + v1) - 0.5 * (a0 - a1);
    let u = share;
    let slope = v0 + u * (2.0 * c2 + u * (3.0 * c3 + u * (4.0 * c4 + u * 5.0 * c5)));
    let bend = 2.0 * c2 + u * (6.0 * c3 + u * (12.0 * c4 + u * 20.0 * c5));
    Setpoint {
        position: from.position + u * (v0 + u * (c2 + u * (c3 + u * (c4 + u * c5)))),
        velocity: slope / period,
        acceleration: bend / (period * period),
    }
}

/// [`between`] with the linear velocity and acceleration: these keep every limit that the setpoints keep, and their
/// slopes are mean acceleration and mean jerk of the period. They differ from the derivatives of the position by up
/// to `j h^2 / 8` and `j h / 2`, with `j` the limit of the jerk and `h` the period.
pub fn within_limits(pair: [Setpoint; 2], share: f64, period: f64) -> Setpoint {
    if share >= 1.0 {
        return pair[1];
    }
    let linear = |of: fn(Setpoint) -> f64| of(pair[0]) + share * (of(pair[1]) - of(pair[0]));
    Setpoint {
        position: between(pair, share, period).position,
        velocity: linear(|setpoint| setpoint.velocity),
        acceleration: linear(|setpoint| setpoint.acceleration),
    }
}
