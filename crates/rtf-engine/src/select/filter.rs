//! The filter language as a tree.

use regex::Regex;
use rtf_model::Label;

use crate::plan::{SuitePlan, TestPlan};

/// A condition that a test meets or not.
#[derive(Clone, Debug)]
pub enum Filter {
    /// Always met.
    All,
    /// Never met.
    None,
    /// Met when the other is not.
    Not(Box<Filter>),
    /// Met when both are.
    And(Box<Filter>, Box<Filter>),
    /// Met when one is.
    Or(Box<Filter>, Box<Filter>),
    /// Met when something of the test matches.
    Has(Subject, Matcher),
}

/// What of a test is looked at.
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

/// All subjects, in the order of their numbers.
pub const SUBJECTS: [Subject; 5] =
    [Subject::Tag, Subject::Type, Subject::Suite, Subject::Name, Subject::File];

/// How it is compared.
#[derive(Clone, Debug)]
pub enum Matcher {
    /// It is this, whole; with the place where that is written.
    Equals(String, Label),
    /// It holds this.
    Contains(String),
    /// A part of it matches.
    Matches(Regex),
}

/// A test, and the suite that it belongs to.
#[derive(Clone, Copy, Debug)]
pub struct Candidate<'p> {
    /// The suite.
    pub suite: &'p SuitePlan,
    /// The test.
    pub test: &'p TestPlan,
}

impl Subject {
    /// The word for it in the filter language.
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

    /// What it is called in a sentence.
    #[must_use]
    pub fn noun(self) -> &'static str {
        match self {
            Self::Suite => "suite",
            Self::File => "suite file",
            other => other.word(),
        }
    }

    /// Whether a bare text means the whole of it. A tag is a word; a name is
    /// often known in part only.
    #[must_use]
    pub fn is_word(self) -> bool {
        matches!(self, Self::Tag | Self::Type)
    }
}

impl<'p> Candidate<'p> {
    /// Tells each text that a subject has.
    pub fn words(self, subject: Subject, mut tell: impl FnMut(&'p str)) {
        match subject {
            Subject::Tag => self.test.tags.iter().for_each(|tag| tell(tag)),
            Subject::Type => tell(&self.test.plugin.plugin_type),
            Subject::Suite => tell(&self.suite.name),
            Subject::Name => tell(&self.test.name),
            Subject::File => tell(&self.suite.file),
        }
    }
}

impl Filter {
    /// Whether a test meets the condition.
    #[must_use]
    pub fn holds(&self, candidate: &Candidate<'_>) -> bool {
        match self {
            Self::All => true,
            Self::None => false,
            Self::Not(inner) => !inner.holds(candidate),
            Self::And(left, right) => left.holds(candidate) && right.holds(candidate),
            Self::Or(left, right) => left.holds(candidate) || right.holds(candidate),
            Self::Has(subject, matcher) => {
                let mut found = false;
                candidate.words(*subject, |word| found |= matcher.matches(word));
                found
            }
        }
    }

    /// Tells each word that is compared as a whole, with its place.
    pub fn each_word(&self, tell: &mut impl FnMut(Subject, &str, &Label)) {
        match self {
            Self::Not(inner) => inner.each_word(tell),
            Self::And(left, right) | Self::Or(left, right) => {
                left.each_word(tell);
                right.each_word(tell);
            }
            Self::Has(subject, Matcher::Equals(word, label)) => tell(*subject, word, label),
            Self::All | Self::None | Self::Has(..) => {}
        }
    }
}

impl Matcher {
    fn matches(&self, word: &str) -> bool {
        match self {
            Self::Equals(wanted, _) => word == wanted,
            Self::Contains(part) => word.contains(part.as_str()),
            Self::Matches(pattern) => pattern.is_match(word),
        }
    }
}
