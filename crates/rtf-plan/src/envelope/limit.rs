//! The quantities of a joint, and the parts of a limit.

use std::time::Duration;

use rtf_model::FindingSeverity;

use super::bound::Bounds;
use crate::suite::{Span, Spanned};

/// A quantity of a joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Position,
    Velocity,
    Acceleration,
    Torque,
    Temperature,
}

impl Quantity {
    /// All, in the order of monitors.
    pub const ALL: [Self; 5] =
        [Self::Position, Self::Velocity, Self::Acceleration, Self::Torque, Self::Temperature];

    /// The key in the file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Torque => "torque",
            Self::Temperature => "temperature",
        }
    }

    /// Whether the magnitude is limited.
    pub fn is_magnitude(self) -> bool {
        matches!(self, Self::Velocity | Self::Acceleration | Self::Torque)
    }

    /// The quantity whose slope it is.
    pub fn integral(self) -> Option<Self> {
        match self {
            Self::Velocity => Some(Self::Position),
            Self::Acceleration => Some(Self::Velocity),
            _ => None,
        }
    }
}

/// What is limited.
#[derive(Clone, Debug)]
pub(super) enum Input {
    Signal(Spanned<String>),
    /// The slope of a signal.
    RateOf(Spanned<String>),
}

impl Input {
    pub fn signal(&self) -> &Spanned<String> {
        match self {
            Self::Signal(name) | Self::RateOf(name) => name,
        }
    }
}

#[derive(Clone, Debug, Default)]
pub(super) struct DeclaredLimit {
    /// The position of its key.
    pub span: Span,
    pub input: Option<Input>,
    pub bounds: Bounds,
    /// For how long it may be exceeded.
    pub tolerated: Option<Duration>,
    pub severity: Option<FindingSeverity>,
}
