//! The verdicts of tests in runs, as one letter per result.

use std::collections::BTreeSet;
use std::ops::Range;

use rtf_model::Verdict;
use serde::Serialize;
use utoipa::ToSchema;

use super::RunInfo;
use super::columns::{Depth, TestColumns};
use crate::{RunSelection, Store, StoreError, TestIdentity, TestSelection};

/// No result of the test in the run.
const NO_RESULT: u8 = b'-';

/// The verdicts of tests in runs.
#[derive(Clone, Debug, PartialEq)]
pub struct VerdictMatrix {
    /// All selected runs, the oldest first.
    pub runs: Vec<RunInfo>,
    /// A page of the selected tests, without those that have no result in these runs.
    pub tests: Vec<MatrixRow>,
    /// The exclusive resources of suites in these runs.
    pub robots: BTreeSet<String>,
    /// Number of selected tests, on all pages.
    pub total: usize,
}

/// The verdicts of a test.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct MatrixRow {
    /// The test or case.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// A letter per run, see [`letter`].
    #[schema(pattern = "^[pPfectxsi-]*$")]
    pub verdicts: String,
}

impl Store {
    /// The verdicts of a page of the selected tests.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn verdict_matrix(
        &self,
        runs: &RunSelection,
        tests: TestSelection<'_>,
        page: Range<usize>,
    ) -> Result<VerdictMatrix, StoreError> {
        let scope = self.run_scope(runs)?;
        let mut selected = self.selected_tests(tests)?;
        let total = selected.len();
        selected.truncate(page.end);
        let selected = selected.split_off(page.start.min(selected.len()));
        let columns = self.columns(selected, &scope, Depth::Results)?;
        let tests = columns.tests.into_iter().filter(|test| !test.results.is_empty());
        let row = |TestColumns { test, results, .. }: TestColumns| {
            let mut letters = vec![NO_RESULT; scope.runs.len()];
            for result in results {
                letters[result.run] = letter(result.verdict, result.is_flaky);
            }
            let verdicts = letters.into_iter().map(char::from).collect();
            MatrixRow { identity: test.attributes.identity, verdicts }
        };
        let rows = tests.map(row).collect();
        let names = columns.robots.iter().flat_map(|robots| robots.split(' '));
        let robots = names.filter(|name| !name.is_empty()).map(str::to_owned).collect();
        Ok(VerdictMatrix { runs: scope.runs, tests: rows, robots, total })
    }
}

/// The letter of a result; `is_flaky`: it both passed and failed in this run.
#[must_use]
pub fn letter(verdict: Verdict, is_flaky: bool) -> u8 {
    match verdict {
        Verdict::Passed if is_flaky => b'P',
        Verdict::Passed => b'p',
        Verdict::Failed => b'f',
        Verdict::Error => b'e',
        Verdict::Crashed => b'c',
        Verdict::TimedOut => b't',
        Verdict::Collapsed => b'x',
        Verdict::Skipped => b's',
        Verdict::Interrupted => b'i',
    }
}
