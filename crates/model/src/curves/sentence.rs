//! A learned curve in words.

use super::{Curve, Shape, Trend};
use crate::effects::{Quantity, Slot, Units};

/// Share of energy beyond which a part stands for the whole: the rest has a seventh of the amplitude.
const NEARLY_ALL: f64 = 0.98;

impl Shape {
    /// A sentence on the known properties of a curve, in these units; a number without unit has no unit name.
    pub fn sentence(&self, curve: &Curve, units: &Units) -> String {
        let [coordinate, law] = curve.slot.quantities();
        let unit = |quantity: Quantity| match quantity.unit(units) {
            one if one == "1" => String::new(),
            unit => format!(" {unit}"),
        };
        let per = Quantity {
            force: law.force - coordinate.force,
            position: law.position - coordinate.position,
            time: law.time - coordinate.time,
            input: law.input - coordinate.input,
            reference: law.reference - coordinate.reference,
        };
        let over = curve.slot.coordinate().name();
        let mut said: Vec<String> = Vec::new();
        said.extend(self.parity(curve.slot).map(String::from));
        said.extend(self.jump.map(|jump| {
            format!(
                "jumps by {}{} at the {over} 0",
                digits(jump.value),
                unit(law)
            )
        }));
        said.extend(self.slope.map(|slope| {
            let at = if self.jump.is_some() {
                "beside the jump"
            } else {
                "at 0"
            };
            format!("has the slope {}{} {at}", digits(slope.value), unit(per))
        }));
        said.extend(self.growth.map(|growth| {
            let (near, far) = growth.between;
            let exponent = growth.exponent;
            format!(
                "grows like |{over}|^{} (+-{}) between {} and {}{}",
                digits(exponent.value),
                digits(exponent.band()),
                digits(near),
                digits(far),
                unit(coordinate)
            )
        }));
        said.extend(self.trend.map(|trend| {
            let words = match trend {
                Trend::Rises => "only rises",
                Trend::Falls => "only falls",
                Trend::Both => "rises in places and falls in others",
            };
            words.to_string()
        }));
        said.extend(self.loss(curve, units));
        let title = curve.effect.title;
        match said.split_last() {
            None => format!("Of the {title} nothing is known but its size."),
            Some((only, [])) => format!("The {title} {only}."),
            Some((last, before)) => format!("The {title} {} and {last}.", before.join(", ")),
        }
    }

    fn parity(&self, slot: Slot) -> Option<&'static str> {
        let words = match slot {
            Slot::Friction => [
                "is alike in both directions",
                "acts one way",
                "differs between the directions",
            ],
            _ => ["is odd", "is even", "is neither odd nor even"],
        };
        Some(match self.odd? {
            odd if odd >= NEARLY_ALL => words[0],
            odd if odd <= 1.0 - NEARLY_ALL => words[1],
            _ => words[2],
        })
    }

    fn loss(&self, curve: &Curve, units: &Units) -> Option<String> {
        let loss = self.dissipated?;
        let takes = if loss.value > 0.0 { "takes" } else { "gives" };
        let size = digits(loss.value.abs());
        let energy = Quantity::new(1, 1, 0).unit(units);
        Some(match curve.slot {
            Slot::Friction => {
                let way = Quantity::POSITION.unit(units);
                format!("{takes} on average {size} {energy} of energy for each {way} of way")
            }
            Slot::Hysteresis => format!("{takes} {size} {energy} of energy in the largest loop"),
            _ => format!(
                "{takes} energy, with a mean of {size} {}",
                curve.slot.quantities()[1].unit(units)
            ),
        })
    }
}

/// Three digits.
fn digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.2e}").parse().unwrap_or(value);
    match rounded.abs() {
        size if size == 0.0 || (1e-3..1e6).contains(&size) => format!("{rounded}"),
        _ => format!("{rounded:e}"),
    }
}
