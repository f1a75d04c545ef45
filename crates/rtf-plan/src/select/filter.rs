//! The syntax tree of the filter language.

use std::borrow::Cow;

use regex::Regex;
use rtf_model::Label;
use rtf_model::protocol::CaseSelector;

use crate::plan::{SuitePlan, TestPlan};

/// A condition on a test.
#[derive(Clone, Debug)]
pub enum Filter {
    All,
    None,
    Not(Box<Filter>),
    And(Box<Filter>, Box<Filter>),
    Or(Box<Filter>, Box<Filter>),
    /// Tests with a value of the subject that matches.
    Has(Subject, Matcher),
    /// Of every test, the cases that match. The parser refuses this condition inside
    /// [`Filter::Not`], and on both sides of [`Filter::And`].
    Case(CaseSelector),
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub enum FilterMatch {
    None,
    /// The test is selected with all its cases.
    All,
    /// The test is selected with the cases that match any of these selectors.
    Cases(Vec<CaseSelector>),
}

impl FilterMatch {
    fn new(matches: bool) -> Self {
        if matches { Self::All } else { Self::None }
    }

    /// Returns the union of two results.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        match (self, other) {
            (Self::All, _) | (_, Self::All) => Self::All,
            (Self::None, one) | (one, Self::None) => one,
            (Self::Cases(mut cases), Self::Cases(more)) => {
                cases.extend(more);
                Self::Cases(cases)
            }
        }
    }

    fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::All, one) | (one, Self::All) => one,
            // The parser refuses two conditions on cases.
            (Self::None, _) | (_, Self::None) | (Self::Cases(_), Self::Cases(_)) => Self::None,
        }
    }
}

/// The property of a test that a filter compares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Subject {
    Tag,
    /// The type of its plug-in: `dll`, `lua`, …
    Type,
    /// The name of its suite.
    Suite,
    Name,
    /// Its suite's file, as the user named it.
    File,
    /// The names of its matrix's parameters (`joint`), and their values (`joint=0`).
    Param,
}

/// All subjects, in the order of their discriminants.
pub const SUBJECTS: [Subject; 6] =
    [Subject::Tag, Subject::Type, Subject::Suite, Subject::Name, Subject::File, Subject::Param];

#[derive(Clone, Debug)]
pub enum Matcher {
    /// The value equals the text, whose position is the label.
    Equals(String, Label),
    Contains(String),
    /// A part of the value matches.
    Matches(Regex),
}

/// A test, planned or stored, whose values a filter compares.
pub trait FilterSubject {
    fn visit_values(&self, subject: Subject, visit: &mut dyn FnMut(&str));
}

impl FilterSubject for Candidate<'_> {
    fn visit_values(&self, subject: Subject, visit: &mut dyn FnMut(&str)) {
        self.for_each_value(subject, |value| visit(&value));
    }
}

#[derive(Clone, Copy, Debug)]
pub struct Candidate<'p> {
    pub suite: &'p SuitePlan,
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
            Self::Param => "param",
        }
    }

    /// Returns the noun for messages.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Suite => "suite",
            Self::File => "suite file",
            Self::Param => "parameter",
            other => other.word(),
        }
    }

    /// Checks whether a bare text is compared with the whole value: true for tags,
    /// types and parameters; of names, users often know only a part.
    #[must_use]
    pub fn is_whole_word(self) -> bool {
        matches!(self, Self::Tag | Self::Type | Self::Param)
    }
}

impl<'p> Candidate<'p> {
    pub fn for_each_value(self, subject: Subject, mut visit: impl FnMut(Cow<'p, str>)) {
        match subject {
            Subject::Tag => self.test.tags.iter().for_each(|tag| visit(tag.into())),
            Subject::Type => visit(Cow::Borrowed(&self.test.plugin.plugin_type)),
            Subject::Suite => visit(Cow::Borrowed(&self.suite.name)),
            Subject::Name => visit(Cow::Borrowed(&self.test.name)),
            Subject::File => visit(Cow::Borrowed(&self.suite.file)),
            Subject::Param => self.test.parameters().iter().for_each(|parameter| {
                visit(Cow::Borrowed(&parameter.name));
                visit(format!("{}={}", parameter.name, parameter.value).into());
            }),
        }
    }
}

impl Filter {
    #[must_use]
    pub fn apply(&self, candidate: &impl FilterSubject) -> FilterMatch {
        match self {
            Self::All => FilterMatch::All,
            Self::None => FilterMatch::None,
            Self::Not(inner) => FilterMatch::new(inner.apply(candidate) == FilterMatch::None),
            Self::And(left, right) => left.apply(candidate).and(right.apply(candidate)),
            Self::Or(left, right) => left.apply(candidate).or(right.apply(candidate)),
            Self::Has(subject, matcher) => {
                let mut found = false;
                candidate.visit_values(*subject, &mut |value| found |= matcher.matches(value));
                FilterMatch::new(found)
            }
            Self::Case(selector) => FilterMatch::Cases(vec![selector.clone()]),
        }
    }

    /// Checks whether the filter can match a test of the suite, regardless of the test's
    /// own properties.
    #[must_use]
    pub fn can_match(&self, suite: &SuitePlan) -> bool {
        self.known_match(suite) != Some(false)
    }

    /// Returns the result as far as the suite determines it.
    fn known_match(&self, suite: &SuitePlan) -> Option<bool> {
        match self {
            Self::All => Some(true),
            Self::None => Some(false),
            Self::Not(inner) => inner.known_match(suite).map(|matches| !matches),
            Self::And(left, right) => match (left.known_match(suite), right.known_match(suite)) {
                (Some(false), _) | (_, Some(false)) => Some(false),
                (left, right) => left.zip(right).map(|_| true),
            },
            Self::Or(left, right) => match (left.known_match(suite), right.known_match(suite)) {
                (Some(true), _) | (_, Some(true)) => Some(true),
                (left, right) => left.zip(right).map(|_| false),
            },
            Self::Has(Subject::Suite, matcher) => Some(matcher.matches(&suite.name)),
            Self::Has(Subject::File, matcher) => Some(matcher.matches(&suite.file)),
            Self::Has(..) | Self::Case(_) => None,
        }
    }

    #[must_use]
    pub fn has_cases(&self) -> bool {
        match self {
            Self::Not(inner) => inner.has_cases(),
            Self::And(left, right) | Self::Or(left, right) => left.has_cases() || right.has_cases(),
            Self::Case(_) => true,
            Self::All | Self::None | Self::Has(..) => false,
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
            Self::All | Self::None | Self::Has(..) | Self::Case(_) => {}
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
