//! Suites, and the snapshot of a whole run.

use rtf_model::{Diagnostic, LeakedProcess, Record, SuitePrepared, SuiteRecord};
use serde::Serialize;
use utoipa::ToSchema;

use super::{Fixture, Hook, RunInfo, Test, Totals, model};
use crate::index::Index;

/// All that a page needs to draw a run, without messages and outputs.
#[derive(Debug, Serialize, ToSchema)]
pub struct Snapshot {
    /// The run as a whole.
    pub info: RunInfo,
    /// The suites, by their ids.
    pub suites: Vec<Suite>,
    /// The fixtures, by their ids.
    pub fixtures: Vec<Fixture>,
    /// The hooks, by their ids.
    pub hooks: Vec<Hook>,
    /// The tests, by their ids.
    pub tests: Vec<Test>,
    /// Warnings.
    #[schema(value_type = Vec<model::Diagnostic>)]
    pub warnings: Vec<Diagnostic>,
    /// The processes that a dead runner left and that were killed.
    #[schema(value_type = Vec<model::LeakedProcess>)]
    pub leaked: Vec<LeakedProcess>,
}

/// Where a suite is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum SuiteState {
    /// Not started yet.
    Pending,
    /// It runs.
    Running,
    /// It has finished.
    Finished,
}

/// A suite.
#[derive(Debug, Serialize, ToSchema)]
pub struct Suite {
    /// Its id.
    pub id: u32,
    /// Its name, unique in the run.
    pub name: String,
    /// Its file; empty for plug-ins given on the command line.
    pub file: String,
    /// Its description.
    pub description: String,
    /// Its environment string.
    pub environment: String,
    /// Whether a collapse leaves it green.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub tolerates_collapse: bool,
    /// Whether a test or case that skips itself makes the run red.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    #[schema(required = false)]
    pub skips_fail: bool,
    /// Its state.
    pub state: SuiteState,
    /// When it started.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub started: Option<u64>,
    /// When it ended.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub finished: Option<u64>,
    /// How many of its tests are in which state.
    pub totals: Totals,
    /// Problems outside its tests.
    pub problems: Vec<String>,
    /// Its fixtures.
    pub fixtures: Vec<u32>,
    /// Its hooks.
    pub hooks: Vec<u32>,
    /// What it got for itself.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::SuitePrepared>)]
    pub prepared: Option<SuitePrepared>,
}

/// All suites of a run.
#[derive(Debug, Serialize, ToSchema)]
pub struct Suites {
    /// The suites, by their ids.
    pub suites: Vec<Suite>,
}

impl Suite {
    /// A view of a suite.
    #[must_use]
    pub fn of(suite: &SuiteRecord, record: &Record, over: bool) -> Self {
        let plan = &suite.plan;
        let totals = record.suite_totals(plan.suite);
        let totals = if over { settled(suite, record) } else { Totals::from(&totals) };
        Self {
            id: plan.suite.0,
            name: plan.name.clone(),
            file: plan.file.clone(),
            description: plan.description.clone(),
            environment: plan.environment.clone(),
            tolerates_collapse: plan.tolerates_collapse,
            skips_fail: plan.skips_fail
                || record.run.as_ref().is_some_and(|run| run.manifest.no_skips),
            state: match (suite.started, suite.finished) {
                (_, Some(_)) => SuiteState::Finished,
                (Some(_), None) if !over => SuiteState::Running,
                (Some(_), None) => SuiteState::Finished,
                (None, None) => SuiteState::Pending,
            },
            started: suite.started.map(|at| at.0),
            finished: suite.finished.map(|at| at.0),
            totals,
            problems: record.suite_problems(plan.suite),
            fixtures: suite.fixtures.iter().map(|id| id.0).collect(),
            hooks: suite.hooks.iter().map(|id| id.0).collect(),
            prepared: suite.prepared.clone(),
        }
    }
}

/// The totals of a suite in a run that has ended.
fn settled(suite: &SuiteRecord, record: &Record) -> Totals {
    let mut totals = Totals::from(&rtf_model::TestTotals::default());
    for test in suite.tests.iter().filter_map(|id| record.tests.get(id.index())) {
        totals.planned += 1;
        totals.done += 1;
        *totals.verdicts.entry(test.final_verdict().as_str()).or_default() += 1;
    }
    totals
}

impl Snapshot {
    /// A view of a whole run.
    #[must_use]
    pub fn of(name: &str, index: &Index) -> Self {
        let (info, record) = (RunInfo::of(name, index), &index.record);
        let over = info.state.is_over();
        Self {
            suites: record.suites.iter().map(|suite| Suite::of(suite, record, over)).collect(),
            fixtures: record.fixtures.iter().map(Fixture::of).collect(),
            hooks: record.hooks.iter().map(Hook::of).collect(),
            tests: record.tests.iter().map(|test| Test::of(test, record, over)).collect(),
            warnings: record.warnings.clone(),
            leaked: record.leaked.clone(),
            info,
        }
    }
}
