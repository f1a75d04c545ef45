//! Verdicts of tests, and the outcomes that hosts report.

use serde::{Deserialize, Serialize};

/// The runner's judgement of one attempt of a test.
///
/// A failure means that the robot is wrong, an error that the bench is wrong;
/// the two are never mixed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    /// The host reported success at the end of its protocol.
    Passed,
    /// The robot is wrong: a check, an assertion or a measurement's limit did not hold.
    Failed,
    /// The bench is wrong: the plug-in, its set-up, its tear-down or its protocol.
    Error,
    /// The test's process died: a signal, or an exit before the end of its protocol.
    Crashed,
    /// A phase of the test did not end within its limit.
    TimedOut,
    /// A fixture collapsed while the test ran.
    Collapsed,
    /// The test was never started, or it skipped itself.
    Skipped,
    /// The user stopped the run while the test ran.
    Interrupted,
}

impl Verdict {
    /// Every verdict, in the order in which summaries list them.
    pub const ALL: [Self; 8] = [
        Self::Passed,
        Self::Failed,
        Self::Error,
        Self::Crashed,
        Self::TimedOut,
        Self::Collapsed,
        Self::Skipped,
        Self::Interrupted,
    ];

    /// The word for this verdict, as in the event stream.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::Error => "error",
            Self::Crashed => "crashed",
            Self::TimedOut => "timed-out",
            Self::Collapsed => "collapsed",
            Self::Skipped => "skipped",
            Self::Interrupted => "interrupted",
        }
    }

    /// Whether it is neither `passed` nor `skipped`.
    #[must_use]
    pub fn is_problem(self) -> bool {
        self.severity() > 0
    }

    /// How bad it is, for the comparison of a test with its cases: 0 for `passed`.
    #[must_use]
    pub fn severity(self) -> u8 {
        match self {
            Self::Passed | Self::Skipped => 0,
            Self::Failed => 1,
            Self::Error => 2,
            Self::Interrupted => 3,
            Self::Collapsed => 4,
            Self::TimedOut => 5,
            Self::Crashed => 6,
        }
    }

    /// Whether a run with this final verdict can be green.
    #[must_use]
    pub fn is_green(self) -> bool {
        self == Self::Passed
    }
}

impl std::fmt::Display for Verdict {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.as_str())
    }
}

/// A host's report on a request that it has carried out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// Every check held.
    Passed,
    /// A check, an assertion or a measurement's limit did not hold.
    Failed,
    /// The bench is wrong: the plug-in could not run its checks.
    Error,
    /// The plug-in stopped early because it was asked to.
    Interrupted,
    /// The test, or the case, skipped itself.
    Skipped,
    /// A program that runs the test or the case for the host died.
    Crashed,
    /// A program that runs the test or the case for the host exceeded a limit of the host.
    TimedOut,
}
