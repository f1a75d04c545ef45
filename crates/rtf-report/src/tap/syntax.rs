//! The indentation of subtests, and the description of a test point.

use crate::escape;

/// A subtest is written four columns further in than its parent.
pub(super) const SUBTEST: usize = 4;

/// One line in which `#` does not begin a directive.
pub(super) fn description(text: &str) -> String {
    escape::line(text).replace('\\', "\\\\").replace('#', "\\#")
}
