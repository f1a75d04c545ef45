//! The syntax tree of the filter language.

use regex::Regex;
use rtf_model::Label;

use crate::plan::{SuitePlan, TestPlan};

/// A condition on a test.
#[derive(Clone, Debug)]
pub enum Filter {
    /// Every test.
    All,
    /// No test.
    None,
    /// Tests that the inner filter does not match.
    Not(Box<Filter>),
    /// Tests that both filters match.
    And(Box<Filter>, Box<Filter>),
    /// Tests that at least one filter matches.
    Or(Box<Filter>, Box<Filter>),
    /// Tests with a value of the subject that matches.
    Has(Subject, Matcher),
}

/// The property of a test that a filter compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    /// Each of its tags.
    Tag,
    /// The type of its plug-in: `dll`, `lua`, …
    Type,
    /// The name of its suite.
    Suite,
    /// Its own name.
    Name,
    /// Its suite's file, as the user named it.
    File,
}

/// All subjects, in the order of their discriminants.
pub const SUBJECTS: [Subject; 5] =
    [Subject::Tag, Subject::Type, Subject::Suite, Subject::Name, Subject::File];

/// A comparison with a value.
#[derive(Clone, Debug)]
pub enum Matcher {
    /// The value equals the text, whose position is the label.
    Equals(String, Label),
    /// The value contains the text.
    Contains(String),
    /// A part of the value matches.
    Matches(Regex),
}

/// A test and its suite.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'p> {
    /// The suite.
    pub suite: &'p SuitePlan,
    /// The test.
    pub test: &'p TestPlan,
}

impl Subject {
    /// Returns the keyword in the filter language.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Tag => "tag",
            Self::Type => "type",
            Self::Suite => "suite",
            Self::Name => "name",
            Self::File => "file",
        }
    }

    /// Returns the noun for messages.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Suite => "suite",
            Self::File => "suite file",
            other => other.word(),
        }
    }

    /// Checks whether a bare text is compared with the whole value: true for tags
    /// and types; of names, users often know only a part.
    #[must_use]
    pub fn is_whole_word(self) -> bool {
        matches!(self, Self::Tag | Self::Type)
    }
}

impl<'p> Candidate<'p> {
    /// Calls `visit` with each value of a subject.
    pub fn for_each_value(self, subject: Subject, mut visit: impl FnMut(&'p str)) {
        match subject {
            Subject::Tag => self.test.tags.iter().for_each(|tag| visit(tag)),
            Subject::Type => visit(&self.test.plugin.plugin_type),
            Subject::Suite => visit(&self.suite.name),
            Subject::Name => visit(&self.test.name),
            Subject::File => visit(&self.suite.file),
        }
    }
}

impl Filter {
    /// Checks whether the filter matches a test.
    #[must_use]
    pub fn matches(&self, candidate: &Candidate<'_>) -> bool {
        match self {
            Self::All => true,
            Self::None => false,
            Self::Not(inner) => !inner.matches(candidate),
            Self::And(left, right) => left.matches(candidate) && right.matches(candidate),
            Self::Or(left, right) => left.matches(candidate) || right.matches(candidate),
            Self::Has(subject, matcher) => {
                let mut found = false;
                candidate.for_each_value(*subject, |value| found |= matcher.matches(value));
                found
            }
        }
    }

    /// Calls `visit` with each text that is compared with whole values, and its position.
    pub fn for_each_equals(&self, visit: &mut impl FnMut(Subject, &str, &Label)) {
        match self {
            Self::Not(inner) => inner.for_each_equals(visit),
            Self::And(left, right) | Self::Or(left, right) => {
                left.for_each_equals(visit);
                right.for_each_equals(visit);
            }
            Self::Has(subject, Matcher::Equals(text, label)) => visit(*subject, text, label),
            Self::All | Self::None | Self::Has(..) => {}
        }
    }
}

impl Matcher {
    fn matches(&self, value: &str) -> bool {
        match self {
            Self::Equals(text, _) => value == text,
            Self::Contains(part) => value.contains(part.as_str()),
            Self::Matches(pattern) => pattern.is_match(value),
        }
    }
}
