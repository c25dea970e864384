//! What motor side and link of a recording contradict each other in.

use super::{Direction, StaticRatio};
use quell_recording::{Recording, Role, Wrap};

/// A mistake of sensors or of a manifest that no physics of a joint explains.
#[derive(Clone, Debug, PartialEq)]
pub struct Contradiction {
    /// The motor side that the link contradicts.
    pub motor_side: Role,
    /// The mistake and what to write instead, a sentence without a full stop.
    pub words: String,
}

impl Contradiction {
    /// The first one of: a counter that begins again ([`Wrap`]), a link that moves another way or another distance than its
    /// motor side ([`StaticRatio`]), and a motor side that follows its link ([`Direction`]). A gear between the two makes the
    /// last question meaningless.
    pub fn of(recording: &Recording) -> Option<Self> {
        if let Some(counter) = counter(recording) {
            return Some(counter);
        }
        let ratio = StaticRatio::of(recording);
        let ratio = ratio.and_then(|own| Some((own.motor_side, own.contradiction()?)));
        let direction = || {
            Some((
                Role::MotorPosition,
                Direction::of(recording)?.contradiction()?,
            ))
        };
        let (motor_side, words) = ratio.or_else(direction)?;
        Some(Self { motor_side, words })
    }
}

/// A position in counts, or in a unit that nobody knows, whose counter begins again.
fn counter(recording: &Recording) -> Option<Contradiction> {
    let sides = [Role::MotorPosition, Role::CommandPosition];
    let link = [Role::LinkPosition, Role::Deformation];
    let is_bare = |unit: &str| ["count", "raw"].contains(&unit);
    let mut channels = sides
        .into_iter()
        .chain(link)
        .filter_map(|role| recording.channel(role));
    channels.find_map(|channel| {
        let wrap = Wrap::of(channel.columns.first().filter(|_| is_bare(&channel.unit))?)?;
        let (role, period, jumps) = (channel.role, wrap.period, wrap.jumps);
        let first = quell_recording::plain(channel.time[wrap.first]);
        Some(Contradiction {
            motor_side: sides.into_iter().find(|side| *side == role).unwrap_or(sides[0]),
            words: format!(
                "{role} jumps by {period} {jumps} time(s), first at {first} s, and goes on smoothly without it: its counter begins \
                 again there; write wrap = {period} in its [[channel]] of recording.toml"
            ),
        })
    })
}
