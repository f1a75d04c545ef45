//! The declarations of signals and monitors, before any name is resolved.

use std::time::Duration;

use rtf_model::{FindingSeverity, ProcessQuantity, SignalTime};

use super::{Span, Spanned};

/// A `<signals>`, or a `<signal>` that is not in one.
#[derive(Clone, Debug)]
pub struct DeclaredSource {
    /// Where the samples come from.
    pub kind: DeclaredSourceKind,
    /// The signals, in the order of the values on a line; one for a fixture.
    pub signals: Vec<DeclaredSignal>,
}

/// The kinds of sources.
#[derive(Clone, Debug)]
pub enum DeclaredSourceKind {
    /// A program that writes a line for each sample.
    Program {
        /// The program and its arguments; empty if they are invalid, which was reported.
        command: Spanned<Vec<String>>,
        /// The clock of its times.
        time: SignalTime,
        /// Whether the first test waits for its first line.
        wait: bool,
    },
    /// A field of a ROS 1 topic: `/joint_states.position[elbow]`.
    Ros(Spanned<String>),
    /// The processes of a fixture.
    Fixture {
        /// The name of the fixture.
        name: Spanned<String>,
        /// The quantity.
        quantity: ProcessQuantity,
        /// The interval.
        every: Option<Duration>,
    },
}

/// A `<signal>`.
#[derive(Clone, Debug)]
pub struct DeclaredSignal {
    /// The name.
    pub name: Spanned<String>,
    /// The unit; at its attribute, or at the name without one.
    pub unit: Spanned<String>,
}

/// An `<envelope>`.
#[derive(Clone, Debug)]
pub struct DeclaredEnvelope {
    /// The position of the tag.
    pub span: Span,
    /// The file of limits, relative to the suite.
    pub file: Spanned<String>,
}

/// A `<monitor>`.
#[derive(Clone, Debug)]
pub struct DeclaredMonitor {
    /// The position of the tag.
    pub span: Span,
    /// The name.
    pub name: Spanned<String>,
    /// What a violation means.
    pub severity: FindingSeverity,
    /// The formula.
    pub formula: Spanned<String>,
}
