//! A drive that acts on its input after a dead time.

use super::cubic::{cubic_coefficients, with_slopes};
use super::grid::sizes;
use super::shared_parameters::DELAY;
use super::{Drive, Effect, Law, Likeness, Place, Property};

struct Delay {
    delay: f64,
}

impl Drive for Delay {
    /// A cubic between samples; before the first one its value.
    fn run(&self, time: &[f64], values: &mut [f64]) {
        if self.delay <= 0.0 || values.is_empty() {
            return;
        }
        let curve = with_slopes(time, values);
        let mut k = 0;
        for (now, value) in time.iter().zip(values.iter_mut()) {
            let instant = now - self.delay;
            while k + 1 < time.len() && time[k + 1] <= instant {
                k += 1;
            }
            *value = match instant > time[0] && k + 1 < time.len() {
                true => {
                    let h = time[k + 1] - time[k];
                    let [c0, c1, c2, c3] = cubic_coefficients(curve[k], curve[k + 1], h);
                    let s = instant - time[k];
                    c0 + s * (c1 + s * (c2 + s * c3))
                }
                false => curve[k][0],
            };
        }
    }

    fn is_static(&self) -> bool {
        false
    }
}

/// A dead time of the drive: `z(t) = u(t - T)`.
pub const DRIVE_DELAY: Effect = Effect {
    name: "drive_delay",
    title: "drive delay",
    places: &[Place::Drive],
    physics: "A command waits for the bus, the controller's cycle and the inverter's hold, and acts T \
        later, unchanged: z(t) = u(t - T). A lag makes the same shift where motion is slow, a delay \
        keeps the size of what is fast. Source: Astrom and Wittenmark, Computer-Controlled Systems \
        (1997), chapter 3.",
    remedy: "Count the cycles between controller and amplifier; shift the command, or the model's \
        input, by the delay.",
    parameters: &[DELAY],
    properties: &[Property::Alike(Likeness::ShiftInTime)],
    law: |p| Law::Drive(Box::new(Delay { delay: p[0] })),
    starts: |scales| sizes(scales.period(), [0.005, 0.02, 0.06, 0.15, 0.3, 0.5]),
};
