//! The declarations of signals and monitors, before any name is resolved.

use std::time::Duration;

use rtf_model::{FindingSeverity, ProcessQuantity, SignalTime, TestQuantity};

use super::{Span, Spanned};

/// A `<signals>`, or a `<signal>` that is not in one.
#[derive(Clone, Debug)]
pub struct DeclaredSource {
    pub kind: DeclaredSourceKind,
    /// The signals, in the order of the values on a line; one for a fixture.
    pub signals: Vec<DeclaredSignal>,
}

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
    /// A value in the messages of a topic or port: `/joint_states.position[elbow]`.
    Topic {
        middleware: SignalMiddleware,
        /// The topic or port, and the value.
        field: Spanned<String>,
    },
    /// A value in a recording.
    Recording {
        /// The file, relative to the suite's directory.
        file: Spanned<String>,
        /// The topic or port, and the value.
        field: Spanned<String>,
    },
    /// What the test reports under the name of the signal.
    Test(TestQuantity),
    /// The processes of a fixture.
    Fixture {
        name: Spanned<String>,
        quantity: ProcessQuantity,
        /// The interval.
        every: Option<Duration>,
    },
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignalMiddleware {
    Ros,
    Ros2,
    Yarp,
}

impl SignalMiddleware {
    /// All, with the attribute that names a topic or port.
    pub(crate) const ALL: [(&str, Self); 3] =
        [("ros", Self::Ros), ("ros2", Self::Ros2), ("yarp", Self::Yarp)];
}

#[derive(Clone, Debug)]
pub struct DeclaredSignal {
    pub name: Spanned<String>,
    /// The unit; at its attribute, or at the name without one.
    pub unit: Spanned<String>,
}

#[derive(Clone, Debug)]
pub struct DeclaredEnvelope {
    /// The position of the tag.
    pub span: Span,
    /// The file of limits, relative to the suite.
    pub file: Spanned<String>,
}

#[derive(Clone, Debug)]
pub struct DeclaredMonitor {
    /// The position of the tag.
    pub span: Span,
    pub name: Spanned<String>,
    pub severity: FindingSeverity,
    pub formula: Spanned<String>,
}
