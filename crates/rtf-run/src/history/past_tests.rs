//! Past results of the tests of a plan, for their order and for shards.

use std::collections::HashMap;
use std::path::Path;
use std::time::Duration;

use rtf_history::answers::RecentResults;
use rtf_history::{Location, Store, StoreError, SuiteFileBase, TestIdentity};
use rtf_plan::plan::Plan;
use rtf_plan::select::{PastResult, PastResults};
use serde::Deserialize;

use crate::error::Failure;
use crate::revision;

/// Past results of tests.
#[derive(Debug)]
pub struct PastTests {
    base: SuiteFileBase,
    tests: HashMap<TestIdentity, RecentResults>,
}

/// The answer of `rtf history slow --format json`.
#[derive(Deserialize)]
struct Durations {
    tests: Vec<TestDuration>,
}

#[derive(Deserialize)]
struct TestDuration {
    #[serde(default)]
    suite_file: String,
    suite: String,
    test: String,
    #[serde(default)]
    case: String,
    median: f64,
}

impl PastTests {
    /// Reads the history: runs with this profile.
    pub fn of_history(
        history: &Location,
        profile: Option<&str>,
        working_dir: &Path,
    ) -> Result<Self, StoreError> {
        let tests = Store::open_existing(history)?.recent_results(profile)?;
        Ok(Self { base: base(working_dir), tests })
    }

    /// Reads durations from the answer of `rtf history slow --format json`.
    pub fn of_durations(file: &Path, working_dir: &Path) -> Result<Self, Failure> {
        let invalid = |problem: String| {
            let error = format!("cannot read durations from `{}`: {problem}", file.display());
            Failure::input(error)
                .hint("`rtf history slow --format json > FILE.json` writes such a file")
        };
        let text = std::fs::read(file).map_err(|error| invalid(error.to_string()))?;
        let durations: Durations =
            serde_json::from_slice(&text).map_err(|error| invalid(error.to_string()))?;
        let tests = durations.tests.into_iter().map(|test| {
            let TestDuration { suite_file, suite, test, case, median } = test;
            let results = RecentResults { failed: false, duration: Some(median) };
            (TestIdentity { suite_file, suite, test, case }, results)
        });
        Ok(Self { base: base(working_dir), tests: tests.collect() })
    }

    /// The results of the tests of a plan.
    pub fn of_plan(&self, plan: &Plan) -> PastResults {
        let mut found = PastResults::new();
        for suite in &plan.suites {
            let suite_file = self.base.normalize(&suite.file);
            for test in &suite.tests {
                let find = |name: &str| {
                    self.tests.get(&TestIdentity {
                        suite_file: suite_file.clone(),
                        suite: suite.name.clone(),
                        test: name.to_owned(),
                        case: String::new(),
                    })
                };
                let results = find(&test.name).or_else(|| find(test.was.as_deref()?));
                let Some(results) = results else { continue };
                let duration = results.duration.and_then(|it| Duration::try_from_secs_f64(it).ok());
                let times = test.settings.repetitions;
                let duration = duration.map(|duration| duration.saturating_mul(times));
                let past = PastResult { failed: results.failed, duration };
                found.insert((suite.name.clone(), test.name.clone()), past);
            }
        }
        found
    }
}

fn base(working_dir: &Path) -> SuiteFileBase {
    let dir = revision::dir_in_repository(working_dir).unwrap_or_default();
    SuiteFileBase::of_dir(working_dir, Path::new(&dir))
}
