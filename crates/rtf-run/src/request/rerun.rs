//! The tests of a past run that `--rerun` repeats.

use std::path::{Path, PathBuf};

use rtf_model::{Manifest, Record, Significance, TestRecord, Verdict};

use super::{failed_cases, past_run};
use crate::error::Failure;

/// Which tests are repeated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RerunVerdict {
    /// Tests whose verdict is not green.
    Failed,
    /// Tests that were interrupted, skipped, or never started.
    Interrupted,
}

/// The manifest of a past run, restricted to the tests to rerun, and its working
/// directory.
pub fn manifest(
    results: &Path,
    run: &str,
    verdicts: &[RerunVerdict],
) -> Result<(Manifest, PathBuf), Failure> {
    let record =
        past_run::read(results, run).map_err(|failure| match Path::new(run).is_file() {
            true => failure.hint("with `--rerun`, FILE is a past run or its journal"),
            false => failure,
        })?;
    let Some(started) = &record.run else {
        return Err(Failure::input(format!("the journal of `{run}` has no first event")));
    };
    if started.manifest.inputs.is_empty() {
        let error = format!("`{run}` does not record its inputs");
        let hint = "it comes from an older rtf, from `robottestingframework-testrunner`, or from \
                    `rtf merge` of runs with different inputs";
        return Err(Failure::input(error).hint(hint));
    }
    let (only, only_cases) = tests_to_rerun(&record, run, verdicts)?;
    let manifest = Manifest { only: Some(only), only_cases, ..(*started.manifest).clone() };
    Ok((manifest, PathBuf::from(&started.working_dir)))
}

/// Suite and test of each test to rerun; and suite, test and paths of failed cases.
type TestsToRerun = (Vec<(String, String)>, Vec<(String, String, Vec<String>)>);

/// The tests to rerun, and the cases of those of which only some cases failed.
fn tests_to_rerun(
    record: &Record,
    run: &str,
    verdicts: &[RerunVerdict],
) -> Result<TestsToRerun, Failure> {
    let (mut names, mut cases) = (Vec::new(), Vec::new());
    for test in &record.tests {
        if !verdicts.iter().any(|wanted| wanted.matches(record, test)) {
            continue;
        }
        let Some((suite, test_name)) = past_run::names(record, test) else { continue };
        if let Some(paths) = failed_cases::of_test(test) {
            cases.push((suite.clone(), test_name.clone(), paths));
        }
        names.push((suite, test_name));
    }
    if names.is_empty() {
        let verdicts: Vec<_> = verdicts.iter().map(|wanted| wanted.verb()).collect();
        let error = format!("no test of `{run}` {}: nothing to rerun", verdicts.join(" or "));
        return Err(Failure::input(error));
    }
    Ok((names, cases))
}

impl RerunVerdict {
    fn matches(self, record: &Record, test: &TestRecord) -> bool {
        let skipped_itself = test.significance() == Significance::SkippedItself;
        let interrupted = !skipped_itself
            && matches!(test.final_verdict(), Verdict::Interrupted | Verdict::Skipped);
        match self {
            Self::Failed => !record.is_test_green(test) && !interrupted,
            Self::Interrupted => interrupted,
        }
    }

    fn verb(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Interrupted => "was interrupted or skipped",
        }
    }
}
