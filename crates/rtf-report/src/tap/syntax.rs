//! The indentation of subtests, and the description of a test point.

use rtf_model::Verdict;

use crate::escape;

/// A subtest is written four columns further in than its parent.
pub(super) const SUBTEST: usize = 4;

/// One line in which `#` does not begin a directive.
pub(super) fn description(text: &str) -> String {
    escape::line(text).replace('\\', "\\\\").replace('#', "\\#")
}

pub(super) fn severity(verdict: Verdict) -> &'static str {
    if verdict == Verdict::Failed { "fail" } else { "error" }
}
