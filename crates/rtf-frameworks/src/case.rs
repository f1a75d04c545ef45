//! A case of a framework: as it is listed before the run, starts and ends.

use std::time::Duration;

use rtf_model::{Location, Outcome, Parameter};
use serde::Serialize;

/// A case that a framework lists before the run.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct ListedCase {
    /// Its name, unique in the test.
    pub name: String,
    /// Its location, if the framework knows it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<Parameter>,
    /// Whether the framework runs it only on demand.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub disabled: bool,
    /// Why it is disabled; `disabled` if the framework gives no reason.
    #[serde(skip)]
    pub disabled_reason: Option<String>,
    /// How the framework identifies it, if not by its name.
    #[serde(skip)]
    pub id: Option<String>,
    /// The limit that the framework's own configuration sets.
    #[serde(skip)]
    pub timeout: Option<Duration>,
}

impl ListedCase {
    /// The start of the case, as far as it is known before the run.
    #[must_use]
    pub fn start(&self) -> StartedCase {
        StartedCase {
            name: self.name.clone(),
            parameters: self.parameters.clone(),
            tags: self.tags.clone(),
            location: self.location.clone(),
        }
    }
}

/// The start of a case, as a framework reports it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct StartedCase {
    pub name: String,
    pub parameters: Vec<Parameter>,
    pub tags: Vec<String>,
    pub location: Option<Location>,
}

/// How a case ended, for cases that the adapter judges itself.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct CaseResult {
    /// The outcome, if no message reports it.
    pub outcome: Option<Outcome>,
    pub reason: Option<String>,
    /// How long the case took, if the framework measured it. Otherwise it is the time between
    /// the arrivals of its start and its end.
    pub duration: Option<Duration>,
    /// The framework runs this top-level case again, and the next attempt decides.
    pub rerun: bool,
}

impl CaseResult {
    pub fn new(outcome: Outcome, reason: impl Into<String>) -> Self {
        Self { outcome: Some(outcome), reason: Some(reason.into()), ..Self::default() }
    }
}

/// The cases that one process of the program runs.
#[derive(Clone, Copy, Debug)]
pub struct Selection<'a> {
    /// The cases; empty if the framework has no list.
    pub cases: &'a [ListedCase],
    /// Whether these are all cases of the program, so that nothing needs to be selected.
    pub is_all: bool,
}

/// How often the arguments of a framework let it run each case.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Repetition {
    #[default]
    Once,
    /// Until it passes, at most this often; the last attempt counts.
    UntilPass(u32),
    /// Until it ends within its limit, at most this often; the last attempt counts.
    AfterTimeout(u32),
    /// Until it fails, at most this often; each time counts.
    UntilFail(u32),
}

impl Repetition {
    /// How often a case runs at most.
    #[must_use]
    pub fn times(self) -> u32 {
        match self {
            Self::Once => 1,
            Self::UntilPass(times) | Self::AfterTimeout(times) | Self::UntilFail(times) => times,
        }
    }

    /// After which results a case runs again, so that another attempt counts.
    #[must_use]
    pub fn retry(self) -> Option<Retry> {
        match self {
            Self::Once | Self::UntilFail(_) => None,
            Self::UntilPass(_) => Some(Retry::AfterProblem),
            Self::AfterTimeout(_) => Some(Retry::AfterTimeout),
        }
    }
}

/// After which results a case runs again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retry {
    /// It did not pass.
    AfterProblem,
    /// It reached its limit.
    AfterTimeout,
}

impl Retry {
    /// Whether a case with this result runs again.
    #[must_use]
    pub fn follows(self, outcome: Option<Outcome>, has_problem: bool) -> bool {
        match self {
            Self::AfterProblem => has_problem,
            Self::AfterTimeout => outcome == Some(Outcome::TimedOut),
        }
    }
}
