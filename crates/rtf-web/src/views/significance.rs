//! What the verdict of a test means for its run.

use serde::Serialize;
use utoipa::ToSchema;

/// What a final verdict means, if it does not count like that of any other test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Significance {
    /// It is a known failure, and green.
    Expected,
    /// It does not count: the test is quarantined.
    Quarantined,
    /// The test passed although a failure is expected, which is red.
    UnexpectedPass,
    /// The test skipped itself, which is green unless skips fail.
    SkippedItself,
}

impl Significance {
    /// `None` if the verdict counts.
    #[must_use]
    pub fn of(significance: rtf_model::Significance) -> Option<Self> {
        match significance {
            rtf_model::Significance::Counts => None,
            rtf_model::Significance::Expected => Some(Self::Expected),
            rtf_model::Significance::Quarantined => Some(Self::Quarantined),
            rtf_model::Significance::UnexpectedPass => Some(Self::UnexpectedPass),
            rtf_model::Significance::SkippedItself => Some(Self::SkippedItself),
        }
    }
}
