//! Kinds of cases: how many effects are hidden, and whether a catalogue holds them.

use super::truth::Truth;
use serde::Serialize;
use std::str::FromStr;
use thiserror::Error;

/// What kind of case it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// Nothing is hidden.
    Clean,
    /// One effect of the catalogue.
    Single,
    /// Two effects of different families.
    Pair,
    /// Three.
    Triple,
    /// Four.
    Four,
    /// Five.
    Five,
    /// Six, or more.
    Six,
    /// One effect of the catalogue whose law deviates from the textbook's shape.
    Shaped,
    /// A law that no catalogue holds.
    Outside,
}

/// A name that is no kind.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("\"{0}\" is no kind of case; there are {names}", names = Kind::ALL.map(Kind::name).join(", "))]
pub struct UnknownKind(pub String);

impl Kind {
    /// All kinds, in the order of tables.
    pub const ALL: [Self; 9] = [
        Self::Clean,
        Self::Single,
        Self::Pair,
        Self::Triple,
        Self::Four,
        Self::Five,
        Self::Six,
        Self::Shaped,
        Self::Outside,
    ];

    /// Its name in files and tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clean => "clean",
            Self::Single => "single",
            Self::Pair => "pair",
            Self::Triple => "triple",
            Self::Four => "four",
            Self::Five => "five",
            Self::Six => "six",
            Self::Shaped => "shaped",
            Self::Outside => "outside",
        }
    }

    /// What it hides, in a few words.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Clean => "nothing",
            Self::Single => "one effect of the catalogue",
            Self::Pair => "two effects of different families, each seen beside the other",
            Self::Triple => "three such effects",
            Self::Four => "four",
            Self::Five => "five",
            Self::Six => "six",
            Self::Shaped => "one effect whose law has not the textbook's shape",
            Self::Outside => "one law that no catalogue holds",
        }
    }

    /// How many effects it hides.
    pub const fn effects(self) -> usize {
        match self {
            Self::Clean => 0,
            Self::Single | Self::Shaped | Self::Outside => 1,
            Self::Pair => 2,
            Self::Triple => 3,
            Self::Four => 4,
            Self::Five => 5,
            Self::Six => 6,
        }
    }

    /// The kind of a case: a generator marks `shaped` itself, the others follow from the count.
    pub fn of(truth: &Truth) -> Self {
        let said = truth.more.get("kind").and_then(|kind| kind.as_str());
        match truth.effects.len() {
            0 => Self::Clean,
            _ if !truth.in_catalogue => Self::Outside,
            1 if said == Some(Self::Shaped.name()) => Self::Shaped,
            1 => Self::Single,
            2 => Self::Pair,
            3 => Self::Triple,
            4 => Self::Four,
            5 => Self::Five,
            _ => Self::Six,
        }
    }

    /// Whether one name is the whole truth.
    pub fn is_one_name(self) -> bool {
        matches!(self, Self::Single | Self::Shaped)
    }

    /// Whether several effects of the catalogue are hidden.
    pub fn is_several(self) -> bool {
        self.effects() > 1
    }
}

impl FromStr for Kind {
    type Err = UnknownKind;

    fn from_str(name: &str) -> Result<Self, UnknownKind> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| UnknownKind(name.into()))
    }
}
