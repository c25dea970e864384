//! The positions of all joints, of which one message has all: also of a joint that is not commanded just now.

use crate::service::config::MOST_JOINTS;

/// Positions of the joints, rad.
pub type Positions = [f64; MOST_JOINTS];

/// A joint in the message.
#[derive(Clone, Copy, Debug, Default)]
struct Joint {
    /// Last position in the message.
    position: Option<f64>,
    /// Last measured position.
    measured: Option<f64>,
    /// Whether it was commanded since the last message.
    commanded: bool,
    /// Whether it was in the last message.
    before: bool,
}

/// What goes into the next message. No allocation.
///
/// A joint that is not commanded any more, as after a silence or while something else moves it, stays in the messages
/// of the others. It is there where it was measured when its commands ended, since its last command would drive it
/// back.
#[derive(Clone, Debug)]
pub struct Commands {
    joints: [Joint; MOST_JOINTS],
    count: usize,
}

impl Commands {
    /// For so many joints.
    pub fn new(count: usize) -> Self {
        Self {
            joints: Default::default(),
            count,
        }
    }

    /// A joint was measured at a position, rad.
    pub fn measure(&mut self, joint: usize, position: f64) {
        if let Some(joint) = self.joints.get_mut(joint) {
            joint.measured = Some(position);
        }
    }

    /// A joint is commanded to a position, rad.
    pub fn command(&mut self, joint: usize, position: f64) {
        if let Some(joint) = self.joints.get_mut(joint) {
            (joint.position, joint.commanded) = (Some(position), true);
        }
    }

    /// The message of a tick; `None` where no joint is commanded, or one never was.
    pub fn take(&mut self) -> Option<Positions> {
        let joints = self.joints.get_mut(..self.count)?;
        let is_due = joints.iter().any(|joint| joint.commanded);
        for joint in &mut *joints {
            if joint.before && !joint.commanded {
                joint.position = joint.measured.or(joint.position);
            }
            (joint.before, joint.commanded) = (joint.commanded, false);
        }
        let all = joints.iter().all(|joint| joint.position.is_some());
        (is_due && all).then(|| self.joints.map(|joint| joint.position.unwrap_or_default()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_joint_that_is_not_commanded_any_more_is_not_driven_back() {
        let mut commands = Commands::new(2);
        commands.command(0, 0.1);
        assert_eq!(commands.take(), None);
        commands.command(0, 0.1);
        commands.command(1, 0.2);
        assert_eq!(
            commands.take().map(|all| all[..2].to_vec()),
            Some(vec![0.1, 0.2])
        );
        // Something moves the second one, and goes on to.
        for (at, stays) in [(0.5, 0.5), (0.7, 0.5)] {
            commands.measure(1, at);
            commands.command(0, 0.11);
            let sent = commands.take().map(|all| all[..2].to_vec());
            assert_eq!(sent, Some(vec![0.11, stays]));
        }
        assert_eq!(commands.take(), None);
        // Commanded again it goes where it is told.
        commands.command(0, 0.11);
        commands.command(1, 0.7);
        assert_eq!(commands.take().map(|all| all[1]), Some(0.7));
        commands.command(7, 1.0);
        commands.measure(MOST_JOINTS, 1.0);
    }
}
