//! `${fixture:name.value}`: a reference to a value of a fixture.
//!
//! The planner checks references, because only it knows all fixtures. `rtf-engine` replaces
//! them whenever a process starts.

use std::borrow::Cow;

use super::Span;
use crate::placeholder::{self, Segment, segments};

pub(super) const OPEN: &str = "${fixture:";

#[derive(Clone, Debug)]
pub struct FixtureReference {
    pub fixture: String,
    pub value: String,
    pub span: Span,
    pub user: ReferenceUser,
}

#[derive(Clone, Debug, Default)]
pub struct FixtureReferences {
    /// The well-formed references.
    pub found: Vec<FixtureReference>,
    /// Whether a text contains one, or an escaped one.
    pub any: bool,
}

/// The element that contains a reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ReferenceUser {
    /// The suite itself, whose settings also apply to its fixtures.
    #[default]
    Suite,
    /// A fixture, by its index in the file.
    Fixture(usize),
    TestOrHook,
}

/// Checks whether a text refers to a value of a fixture, or escapes such a reference.
#[must_use]
pub fn mentions(text: &str) -> bool {
    text.contains(OPEN)
}

/// Replaces each reference by the result of `value`, which gets its name, `simulator.port`.
/// A reference without a result is kept.
pub fn expand<'v>(text: &str, value: impl Fn(&str) -> Option<Cow<'v, str>>) -> String {
    placeholder::replace(text, OPEN, value)
}

/// Returns the names of all references of a text: `simulator.port`.
pub fn names(text: &str) -> impl Iterator<Item = &str> {
    let names = segments(text, OPEN).into_iter().filter_map(|segment| match segment {
        Segment::Placeholder(name, _) => Some(name),
        Segment::Text(_) | Segment::Unclosed(_) => None,
    });
    names.collect::<Vec<_>>().into_iter()
}

#[cfg(test)]
mod tests {
    use std::borrow::Cow;

    use super::*;

    #[test]
    fn known_values_are_replaced_and_the_rest_is_kept() {
        let value = |name: &str| (name == "sim.port").then_some(Cow::Borrowed("40123"));
        let filled = |text: &str| expand(text, value);
        assert_eq!(filled("tcp:${fixture:sim.port}!"), "tcp:40123!");
        assert_eq!(filled("${fixture:sim.pid} ${port:a}"), "${fixture:sim.pid} ${port:a}");
        assert_eq!(filled("$${fixture:sim.port}"), "${fixture:sim.port}");
        assert_eq!(filled("${fixture:sim.port"), "${fixture:sim.port");
        assert_eq!(names("${fixture:a.b}-${fixture:c.d.e}").collect::<Vec<_>>(), ["a.b", "c.d.e"]);
    }
}
