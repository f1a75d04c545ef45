//! Known failures, and which verdicts of a test make a run red.

use serde::{Deserialize, Serialize};

use crate::Verdict;

/// A known failure of a test.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExpectedFailure {
    /// The verdicts that it covers.
    pub verdicts: Vec<Verdict>,
    /// The issue: a URL or a text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub issue: Option<String>,
    /// Why the test fails.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The last day on which it applies: `2027-01-31`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub until: Option<String>,
    /// Whether the test may pass, too: it is quarantined in `rtf.toml`.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub quarantined: bool,
    /// Whether [`ExpectedFailure::until`] has passed: the test counts like any other.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub expired: bool,
}

/// What a verdict means for the run, given the test's known failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Significance {
    /// The verdict counts: only a pass is green.
    Counts,
    /// The verdict is a known failure, and green.
    Expected,
    /// The verdict does not count: the test is quarantined.
    Quarantined,
    /// The test passed although a failure is expected, which is red.
    UnexpectedPass,
    /// The test skipped itself, which is green unless skips fail.
    SkippedItself,
}

impl ExpectedFailure {
    /// Returns what a verdict of the test means; [`Significance::Counts`] if the mark has
    /// expired or does not cover it.
    #[must_use]
    pub fn significance(&self, verdict: Verdict) -> Significance {
        match (verdict, self.quarantined) {
            _ if self.expired => Significance::Counts,
            (Verdict::Passed, false) => Significance::UnexpectedPass,
            (Verdict::Passed, true) => Significance::Quarantined,
            (verdict, _) if !self.verdicts.contains(&verdict) => Significance::Counts,
            (_, false) => Significance::Expected,
            (_, true) => Significance::Quarantined,
        }
    }

    /// Whether this verdict is a known failure, which does not count.
    #[must_use]
    pub fn covers(&self, verdict: Verdict) -> bool {
        !self.expired && verdict.is_problem() && self.verdicts.contains(&verdict)
    }
}
