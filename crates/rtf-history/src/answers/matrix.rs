//! The verdicts of tests in runs, as one letter per result.

use std::collections::BTreeSet;
use std::ops::Range;

use rtf_model::Verdict;
use serde::Serialize;
use utoipa::ToSchema;

use super::RunInfo;
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
    /// The exclusive resources on which these results depended.
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
        let selected = self.selected_tests(tests)?;
        let total = selected.len();
        let (mut rows, mut robots) = (Vec::new(), BTreeSet::new());
        for test in selected.into_iter().skip(page.start).take(page.len()) {
            let results = self.results(&test, &scope)?;
            if results.is_empty() {
                continue;
            }
            let mut letters = vec![NO_RESULT; scope.runs.len()];
            for result in results {
                letters[result.run] = letter(result.row.verdict, result.row.is_flaky);
                let names = result.row.robot.split(' ').filter(|name| !name.is_empty());
                for name in names {
                    if !robots.contains(name) {
                        robots.insert(name.to_owned());
                    }
                }
            }
            let verdicts = letters.into_iter().map(char::from).collect();
            rows.push(MatrixRow { identity: test.attributes.identity, verdicts });
        }
        Ok(VerdictMatrix { runs: scope.runs, tests: rows, robots, total })
    }
}

/// The letter of a result; `is_flaky`: it passed after an earlier attempt had failed.
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
