//! Which tests of a plan are run, and in which order.
//!
//! A selection takes tests away and moves them; it never changes one. A suite
//! of which no test is left is not run, and neither are its fixtures.
//!
//! - [`filter`]: the filter language, as a tree that is asked.
//! - [`mod@parse`]: text → tree, with the place of every mistake.
//! - [`shard`]: a part of the tests, of several that make up the whole.

pub mod filter;
mod parse;
mod shard;

use std::collections::{BTreeSet, HashSet};
use std::hash::Hasher;

use rtf_model::Diagnostic;
use siphasher::sip::SipHasher13;

pub use filter::Filter;
pub use parse::parse;
pub use shard::{Shard, ShardBy};

use crate::plan::{Plan, SuitePlan, TestPlan};
use filter::Candidate;

/// What is selected; by default all tests, in the order of the plan.
#[derive(Debug, Default)]
pub struct Selection {
    /// A test is selected when one of these holds; without any, all are.
    pub filters: Vec<Filter>,
    /// Only these: names of suites and of their tests.
    pub only: Option<HashSet<(String, String)>>,
    /// Suites, and the tests within each, in an order that this number decides.
    pub shuffle: Option<u64>,
    /// One part of what the filters have left.
    pub shard: Option<Shard>,
}

/// What came out of a selection.
#[derive(Debug)]
pub struct Selected {
    /// The tests that are left. It may be empty.
    pub plan: Plan,
    /// How many tests there were before.
    pub of: usize,
    /// What the filters name and no test has.
    pub warnings: Vec<Diagnostic>,
}

/// Applies a selection.
#[must_use]
pub fn select(plan: Plan, selection: &Selection) -> Selected {
    let warnings = unknown_words(&plan, &selection.filters);
    let of = plan.suites.iter().map(|suite| suite.tests.len()).sum();
    let mut suites = plan.suites;
    retain(&mut suites, |suite, test| {
        let candidate = Candidate { suite, test };
        let filters = &selection.filters;
        let named = |only: &HashSet<(String, String)>| {
            only.contains(&(suite.name.clone(), test.name.clone()))
        };
        (filters.is_empty() || filters.iter().any(|filter| filter.holds(&candidate)))
            && selection.only.as_ref().is_none_or(named)
    });
    if let Some(shard) = &selection.shard {
        shard.keep(&mut suites);
    }
    if let Some(seed) = selection.shuffle {
        shuffle(&mut suites, seed);
    }
    suites.retain(|suite| !suite.tests.is_empty());
    Selected { plan: Plan::new(suites), of, warnings }
}

/// Keeps the tests for which the answer is true.
fn retain(suites: &mut [SuitePlan], mut keep: impl FnMut(&SuitePlan, &TestPlan) -> bool) {
    for suite in suites {
        let mut tests = std::mem::take(&mut suite.tests);
        tests.retain(|test| keep(suite, test));
        suite.tests = tests;
    }
}

/// Each suite's and test's place depends on the seed and its name alone: what
/// a filter takes away does not change the order of the rest.
fn shuffle(suites: &mut [SuitePlan], seed: u64) {
    suites.sort_by_cached_key(|suite| hash(seed, &suite.name, ""));
    for suite in suites {
        let name = suite.name.clone();
        suite.tests.sort_by_cached_key(|test| hash(seed, &name, &test.name));
    }
}

/// A number for a test that is the same on every machine and in every version.
fn hash(seed: u64, suite: &str, test: &str) -> u64 {
    let mut hasher = SipHasher13::new_with_keys(seed, 0);
    hasher.write(suite.as_bytes());
    // No name holds this byte.
    hasher.write_u8(0xff);
    hasher.write(test.as_bytes());
    hasher.finish()
}

/// Warns of words that filters compare with as a whole and that nothing has:
/// a misspelt tag selects no test, and with `!` all of them.
fn unknown_words(plan: &Plan, filters: &[Filter]) -> Vec<Diagnostic> {
    let mut known: [BTreeSet<&str>; filter::SUBJECTS.len()] = Default::default();
    for suite in &plan.suites {
        for test in &suite.tests {
            for (subject, words) in filter::SUBJECTS.iter().zip(&mut known) {
                Candidate { suite, test }.words(*subject, |word| {
                    words.insert(word);
                });
            }
        }
    }
    let mut warnings = Vec::new();
    for filter in filters {
        filter.each_word(&mut |subject, word, label| {
            let known = &known[subject as usize];
            if known.contains(word) {
                return;
            }
            let message = format!("no test has the {} `{word}`", subject.noun());
            let warning = Diagnostic::warning("unknown-word", message).label(label.clone());
            let near = crate::suite::nearest(word, known.iter().copied());
            warnings.push(match near {
                Some(near) => warning.hint(format!("did you mean `{near}`?")),
                None => warning,
            });
        });
    }
    warnings
}
