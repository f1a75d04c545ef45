//! Marks the tests that `[[quarantine]]` tables match, and warns about tables that match
//! nothing or expire.

use std::collections::HashMap;
use std::path::PathBuf;
use std::rc::Rc;

use jiff::civil::Date;
use rtf_model::{Diagnostic, ExpectedFailure};

use super::SuitePlan;
use super::known_failure;
use crate::config::{ConfigFile, ProfileView, Quarantine};
use crate::select::FilterMatch;
use crate::select::filter::Candidate;
use crate::suite::Span;

#[derive(Debug, Default)]
pub(super) struct Quarantines {
    /// The tables that can match a test of a planned suite, by file and position.
    used: HashMap<(PathBuf, Span), QuarantineUse>,
}

#[derive(Debug)]
struct QuarantineUse {
    file: Rc<ConfigFile>,
    quarantine: Quarantine,
    matches: bool,
}

impl Quarantines {
    /// Marks the quarantined tests of a suite. The first table that has not expired applies.
    pub fn apply(&mut self, view: &ProfileView, suite: &mut SuitePlan, today: Date) {
        for quarantine in view.quarantines() {
            // A table about another suite is no mistake if only this suite runs.
            if !quarantine.filter.can_match(suite) {
                continue;
            }
            let key = (view.file.path.clone(), quarantine.span);
            let used = self.used.entry(key).or_insert_with(|| {
                let (file, quarantine) = (Rc::clone(&view.file), quarantine.clone());
                QuarantineUse { file, quarantine, matches: false }
            });
            let failure = known_failure::expect(&quarantine.failure, today);
            let mark = ExpectedFailure { quarantined: true, ..failure };
            let mut tests = std::mem::take(&mut suite.tests);
            for test in &mut tests {
                if quarantine.filter.apply(&Candidate { suite, test }) == FilterMatch::None {
                    continue;
                }
                used.matches = true;
                if is_replaced(test.expected.as_deref(), &mark) {
                    test.expected = Some(Box::new(mark.clone()));
                }
            }
            suite.tests = tests;
        }
    }

    /// Returns the warnings about all tables that have been applied.
    pub fn warnings(&self, today: Date) -> Vec<Diagnostic> {
        let mut used: Vec<_> = self.used.iter().collect();
        used.sort_by_key(|((path, span), _)| (path, span.start));
        let mut warnings = Vec::new();
        for (_, QuarantineUse { file, quarantine, matches }) in used {
            if *matches {
                let failure = &quarantine.failure;
                warnings.extend(known_failure::warn_of_end(failure, today, &file.source));
            } else {
                let message = "this quarantine matches no test";
                warnings.push(file.source.warning("unused-quarantine", quarantine.span, message));
            }
        }
        warnings
    }
}

/// Checks whether a quarantine replaces the known failure of a test: one that applies is
/// not replaced by another quarantine, and no known failure by an expired quarantine.
fn is_replaced(known: Option<&ExpectedFailure>, quarantine: &ExpectedFailure) -> bool {
    known.is_none_or(|known| {
        let applies = known.quarantined && !known.expired;
        !applies && !quarantine.expired
    })
}
