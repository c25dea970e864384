//! Motor side and link at one instant: the forces on them, and those of sticking friction.

use super::attachment::Attachment;
use crate::effects::{Inertia, Motion};

/// Forces and mobilities (inverse inertias) of motor side and link; a mobility of 0 is a prescribed
/// motion, whose acceleration is the bias.
pub(super) struct Bodies {
    pub force: [f64; 2],
    pub mobility: [f64; 2],
    pub bias: [f64; 2],
}

impl Bodies {
    /// Acceleration of the motor side (0) or the link (1).
    #[inline(always)]
    pub fn acceleration(&self, body: usize) -> f64 {
        self.bias[body] + self.mobility[body] * self.force[body]
    }

    /// A force that resists motion at an attachment; `ratio` is the velocity of the transmission's input for
    /// a unit velocity of the motor side.
    #[inline(always)]
    pub fn resist(&mut self, attachment: Attachment, force: f64, ratio: f64) {
        match attachment {
            Attachment::Motor => self.force[0] -= force,
            Attachment::Across => {
                self.force[1] -= force;
                self.force[0] += ratio * force;
            }
            Attachment::Link => self.force[1] -= force,
        }
    }

    /// A further inertia that moves with the body of an attachment to ground.
    #[inline(always)]
    pub fn load(&mut self, attachment: Attachment, inertia: f64) {
        let body = usize::from(attachment != Attachment::Motor);
        match self.mobility[body] > 0.0 {
            true => self.mobility[body] /= 1.0 + inertia * self.mobility[body],
            // Its motion is prescribed.
            false => self.force[body] -= inertia * self.bias[body],
        }
    }

    /// `m y'' + m' y'^2 / 2 = F` with an inertia that depends on time and pose.
    pub fn reshape(&mut self, inertia: &dyn Inertia, motion: &Motion, body: usize) {
        let [y, v] = motion.link;
        let factor = inertia.factor(motion.time, y);
        self.mobility[body] /= factor;
        if self.mobility[body] > 0.0 {
            self.bias[body] -= 0.5 * inertia.slope(motion.time, y) * v * v / factor;
        }
    }

    /// Adds the forces of sticking friction, by which nothing slips, and returns them for each attachment.
    ///
    /// Two sticking attachments stop both bodies. With three the distribution is not determined; the
    /// transmission then gets no force.
    pub fn hold(&mut self, sticks: [bool; 3]) -> [f64; 3] {
        let [motor, link] = [self.acceleration(0), self.acceleration(1)];
        let [m, l] = self.mobility;
        let over = |slip: f64, mobility: f64| match mobility > 0.0 {
            true => slip / mobility,
            false => 0.0,
        };
        let forces = match sticks {
            [false, false, false] => [0.0; 3],
            [true, false, false] => [over(motor, m), 0.0, 0.0],
            [false, true, false] => [0.0, over(link - motor, m + l), 0.0],
            [false, false, true] => [0.0, 0.0, over(link, l)],
            [true, true, false] => {
                let across = over(link, l);
                [over(motor, m) + across, across, 0.0]
            }
            [false, true, true] => {
                let across = -over(motor, m);
                [0.0, across, over(link, l) - across]
            }
            [true, _, true] => [over(motor, m), 0.0, over(link, l)],
        };
        self.force[0] += forces[1] - forces[0];
        self.force[1] -= forces[1] + forces[2];
        forces
    }
}
