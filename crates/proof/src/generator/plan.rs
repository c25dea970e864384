//! What a case hides, in numbers of effects and the table that they are of.

use super::random::Draw;
use crate::kind::Kind;

/// A table of what can be hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// Effects of the catalogue, as the textbook has them.
    Catalogue,
    /// Effects of the catalogue whose law has another shape.
    Shaped,
    /// What the mixture of kinds has outside the catalogue.
    Strange,
    /// All that is outside the catalogue.
    Outside,
}

/// What a case hides.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plan {
    /// How many effects.
    pub effects: usize,
    /// Of which table.
    pub table: Table,
    /// The kind that was asked for; absent in the mixture, where a case may hide less than was planned.
    pub kind: Option<Kind>,
}

impl Plan {
    /// For one kind, or by the shares of the mixture.
    pub fn draw(draw: &mut Draw, kind: Option<Kind>) -> Self {
        let (effects, table) = match kind {
            Some(kind) => (kind.effects(), Self::table(kind)),
            None => match draw.uniform(0.0, 1.0) {
                x if x < 0.20 => (0, Table::Catalogue),
                x if x < 0.72 => (1, Table::Catalogue),
                x if x < 0.86 => (2, Table::Catalogue),
                _ => (1, Table::Strange),
            },
        };
        Self {
            effects,
            table,
            kind,
        }
    }

    fn table(kind: Kind) -> Table {
        match kind {
            Kind::Shaped => Table::Shaped,
            Kind::Outside => Table::Outside,
            _ => Table::Catalogue,
        }
    }

    /// Whether this many hidden effects are enough.
    pub fn is_met_by(&self, hidden: usize) -> bool {
        self.kind.is_none() || hidden == self.effects
    }
}
