//! Selects and orders the tests of a plan.
//!
//! A selection removes and reorders tests, and selects cases of them; it changes nothing
//! else of a test. A suite without
//! selected tests does not run, and neither do its fixtures.
//!
//! - [`filter`]: the syntax tree of the filter language.
//! - [`mod@parse`]: text → syntax tree, with the position of every error.
//! - [`order`]: the order of tests by their past results.
//! - [`shard`]: one of several parts that together contain all tests.

pub mod filter;
mod order;
mod parse;
mod shard;

use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::hash::Hasher;

use rtf_model::Diagnostic;
use rtf_model::protocol::CaseSelector;
use siphasher::sip::SipHasher13;

pub use filter::{Filter, FilterMatch};
pub use order::{PastResult, PastResults, TestOrder};
pub use parse::parse;
pub use shard::{Shard, ShardBy};

use crate::plan::{CaseSelection, CaseSelectionOrigin, Plan, SuitePlan, TestPlan};
use crate::wording::suggest;
use filter::Candidate;

/// The options of a selection; by default all tests, in the order of the plan.
#[derive(Debug, Default)]
pub struct Selection {
    /// Selects a test if any filter matches it; without filters, selects all.
    pub filters: Vec<Filter>,
    /// Further restricts the selection to these names of suites and tests, and to these
    /// cases of them; no cases: all.
    pub only: Option<HashMap<(String, String), Vec<CaseSelector>>>,
    /// The seed for a random order of suites, and of the tests of each.
    pub shuffle: Option<u64>,
    pub order: Option<(TestOrder, PastResults)>,
    /// One part of the selected tests.
    pub shard: Option<Shard>,
}

#[derive(Debug)]
pub struct Selected {
    /// The plan with the selected tests; possibly empty.
    pub plan: Plan,
    /// The number of tests before the selection.
    pub total: usize,
    /// A hash of the assignment of tests to shards, if it depends on past durations.
    pub shard_assignment: Option<u64>,
    /// Warnings about values in filters that no test has, and an error if a test has two
    /// selections of cases.
    pub problems: Vec<Diagnostic>,
}

#[must_use]
pub fn select(plan: Plan, selection: &Selection) -> Selected {
    let mut problems = warn_of_unknown_values(&plan, &selection.filters);
    let total = plan.suites.iter().map(|suite| suite.tests.len()).sum();
    let mut suites = plan.suites;
    let mut conflict = None;
    for suite in &mut suites {
        let mut tests = std::mem::take(&mut suite.tests);
        tests.retain_mut(|test| {
            let Some(selections) = selection.apply(&Candidate { suite, test }) else {
                return false;
            };
            for cases in selections {
                if test.listed_cases().is_some() {
                    if test.narrow_cases(cases).paths.is_empty() {
                        return false;
                    }
                } else if test.cases.is_none() {
                    test.select_cases(cases);
                } else {
                    conflict.get_or_insert_with(|| test.name.clone());
                }
            }
            true
        });
        suite.tests = tests;
    }
    problems.extend(conflict.map(|test| conflicting_cases(&test)));
    let shard_assignment = selection.shard.as_ref().and_then(|shard| shard.apply(&mut suites));
    if let Some((order, past)) = &selection.order {
        order.apply(&mut suites, past);
    }
    if let Some(seed) = selection.shuffle {
        shuffle(&mut suites, seed);
    }
    suites.retain(|suite| !suite.tests.is_empty());
    Selected { plan: Plan::new(suites), total, shard_assignment, problems }
}

impl Selection {
    /// Returns the selections of cases if the test is selected; none for all cases.
    fn apply(&self, candidate: &Candidate<'_>) -> Option<Vec<CaseSelection>> {
        let mut selections = Vec::new();
        let applied = self.filters.iter().map(|filter| filter.apply(candidate));
        match applied.reduce(FilterMatch::or).unwrap_or(FilterMatch::All) {
            FilterMatch::None => return None,
            FilterMatch::All => {}
            FilterMatch::Cases(selectors) => {
                let origin = CaseSelectionOrigin::Filter;
                selections.push(CaseSelection { selectors, origin });
            }
        }
        if let Some(only) = &self.only {
            let key = (candidate.suite.name.clone(), candidate.test.name.clone());
            let selectors = only.get(&key)?.clone();
            if !selectors.is_empty() {
                let origin = CaseSelectionOrigin::Rerun;
                selections.push(CaseSelection { selectors, origin });
            }
        }
        Some(selections)
    }
}

fn conflicting_cases(test: &str) -> Diagnostic {
    let message = format!("two selections of cases apply to the test `{test}`");
    Diagnostic::error("conflicting-cases", message)
        .hint("name the cases with `::`, or with a `case` filter, not with both")
}

fn retain(suites: &mut [SuitePlan], mut keep: impl FnMut(&SuitePlan, &TestPlan) -> bool) {
    for suite in suites {
        let mut tests = std::mem::take(&mut suite.tests);
        tests.retain(|test| keep(suite, test));
        suite.tests = tests;
    }
}

/// Sorts by seed and name, so that the order does not depend on which other tests
/// are selected.
fn shuffle(suites: &mut [SuitePlan], seed: u64) {
    suites.sort_by_cached_key(|suite| hash(seed, &suite.name, ""));
    for suite in suites {
        let name = suite.name.clone();
        suite.tests.sort_by_cached_key(|test| hash(seed, &name, &test.name));
    }
}

/// Hashes a test to the same number on every machine and in every version.
fn hash(seed: u64, suite: &str, test: &str) -> u64 {
    let mut hasher = SipHasher13::new_with_keys(seed, 0);
    hasher.write(suite.as_bytes());
    // A separator that no UTF-8 name contains.
    hasher.write_u8(0xff);
    hasher.write(test.as_bytes());
    hasher.finish()
}

/// Warns about values in filters that no test has: a misspelt tag selects no
/// test, and with `!` all of them.
fn warn_of_unknown_values(plan: &Plan, filters: &[Filter]) -> Vec<Diagnostic> {
    let mut known: [BTreeSet<Cow<'_, str>>; filter::SUBJECTS.len()] = Default::default();
    for suite in &plan.suites {
        for test in &suite.tests {
            for (subject, values) in filter::SUBJECTS.iter().zip(&mut known) {
                Candidate { suite, test }.for_each_value(*subject, |value| {
                    values.insert(value);
                });
            }
        }
    }
    let mut warnings = Vec::new();
    for filter in filters {
        filter.for_each_equals(&mut |subject, value, label| {
            let known = &known[subject as usize];
            if known.contains(value) {
                return;
            }
            let message = format!("no test has the {} `{value}`", subject.noun());
            let warning = Diagnostic::warning("unknown-word", message).label(label.clone());
            warnings.push(suggest(warning, value, known.iter().map(AsRef::as_ref)));
        });
    }
    warnings
}
