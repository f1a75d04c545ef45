//! The positions at which suites use plug-ins, and the roles of plug-ins.

use std::sync::Arc;

use rtf_model::Diagnostic;

use crate::suite::{SourceText, Span};

#[derive(Clone, Debug)]
pub(super) enum UseSite {
    Suite(Arc<SourceText>, Span),
    CommandLine,
}

impl UseSite {
    /// Adds this position as a label.
    pub fn label(&self, problem: Diagnostic, text: &str) -> Diagnostic {
        match self {
            Self::Suite(source, span) => problem.label(source.label(*span, text)),
            Self::CommandLine => problem,
        }
    }
}

/// The positions of several uses: the first ones and the total number.
#[derive(Debug, Default)]
pub(super) struct UseSites {
    shown: Vec<UseSite>,
    count: usize,
}

/// The maximum number of uses that a diagnostic labels.
const MAX_LABELS: usize = 3;

impl UseSites {
    pub fn add(&mut self, site: &UseSite) {
        self.count += 1;
        if self.shown.len() < MAX_LABELS {
            self.shown.push(site.clone());
        }
    }

    /// Adds the positions as labels before those of the problem.
    pub fn label(&self, mut problem: Diagnostic, text: &str) -> Diagnostic {
        let last = std::mem::take(&mut problem.labels);
        for site in &self.shown {
            problem = site.label(problem, text);
        }
        problem.labels.extend(last);
        match self.count.saturating_sub(MAX_LABELS) {
            0 => problem,
            1 => problem.note("needed in one more place"),
            more => problem.note(format!("needed in {more} more places")),
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum PluginRole {
    Test,
    Fixture,
    Hook,
}

impl PluginRole {
    /// Returns the required kind of plug-in, as named in the protocol and in messages.
    pub fn kind(self) -> &'static str {
        match self {
            Self::Test | Self::Hook => "test",
            Self::Fixture => "fixture",
        }
    }

    /// Returns the name of its element in suites.
    pub fn element(self) -> &'static str {
        match self {
            Self::Test => "test",
            Self::Fixture => "fixture",
            Self::Hook => "hook",
        }
    }

    /// Returns the hint for a plug-in of the other kind.
    pub fn advice(self) -> &'static str {
        match self {
            Self::Test => "in a suite it is written as `<fixture>`",
            Self::Fixture => "in a suite it is written as `<test>`",
            Self::Hook => "a hook is a test plug-in that succeeds by passing",
        }
    }
}
