//! A problem of a running test that a fixture has found.

use serde::{Deserialize, Serialize};

use crate::{Location, Message, MessageKind, SignalInterval, TestId, Verdict};

/// The effect of a [`Finding`] on the test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum FindingSeverity {
    /// The robot is wrong: a failure. The test continues.
    Fail,
    /// The bench is wrong: an error. The test continues.
    Error,
    /// A failure that ends the test at once.
    Stop,
    /// A failure that ends the test at once; the rest of the suite is skipped.
    Critical,
}

impl FindingSeverity {
    /// Every severity, with its word in suites.
    pub const ALL: [(&'static str, Self); 4] = [
        ("fail", Self::Fail),
        ("error", Self::Error),
        ("stop", Self::Stop),
        ("critical", Self::Critical),
    ];

    /// Its word in suites.
    #[must_use]
    pub fn word(self) -> &'static str {
        let found = Self::ALL.iter().find(|(_, severity)| *severity == self);
        found.map_or("", |(word, _)| word)
    }

    /// The verdict of the test, if nothing worse happens.
    #[must_use]
    pub fn verdict(self) -> Verdict {
        match self {
            Self::Error => Verdict::Error,
            Self::Fail | Self::Stop | Self::Critical => Verdict::Failed,
        }
    }

    /// Whether the test ends at once.
    #[must_use]
    pub fn ends_test(self) -> bool {
        matches!(self, Self::Stop | Self::Critical)
    }
}

/// A problem of a running test that a fixture has found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Finding {
    /// The test.
    pub test: TestId,
    /// Its effect on the test.
    pub severity: FindingSeverity,
    /// The problem; the reason of the verdict if it decides it.
    pub text: String,
    /// Where the violated rule is written: in the suite, or in the plug-in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    /// When it holds, if that is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub interval: Option<Box<SignalInterval>>,
}

impl Finding {
    /// The message of the test that reports it.
    #[must_use]
    pub fn message(&self) -> Message {
        let kind = match self.severity {
            FindingSeverity::Error => MessageKind::Error,
            FindingSeverity::Fail | FindingSeverity::Stop | FindingSeverity::Critical => {
                MessageKind::Failure
            }
        };
        let (text, location) = (self.text.clone(), self.location.clone());
        let critical = self.severity == FindingSeverity::Critical;
        Message {
            kind,
            text,
            location,
            comparison: None,
            critical,
            case: None,
            interval: self.interval.clone(),
        }
    }
}
