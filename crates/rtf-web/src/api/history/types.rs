//! The answers that are not those of `rtf history`.

use jiff::Timestamp;
use rtf_history::TestIdentity;
use rtf_history::answers::{
    CampaignChange, CampaignSeries, Comparison, MatrixRow, RunInfo, SeriesChange, SlowTest,
    TestHistory, TestSeries, VerdictMatrix,
};
use rtf_history::entry::SeriesName;
use serde::Serialize;
use utoipa::ToSchema;

/// Runs, the newest first.
#[derive(Debug, Serialize, ToSchema)]
pub struct HistoryRuns {
    /// The runs.
    pub runs: Vec<RunInfo>,
}

/// The verdicts of tests in runs.
#[derive(Debug, Serialize, ToSchema)]
pub struct HistoryMatrix {
    /// All selected runs, the oldest first.
    pub runs: Vec<MatrixRun>,
    /// A page of the tests.
    pub tests: Vec<MatrixRow>,
    /// The exclusive resources of suites in these runs.
    pub robots: Vec<String>,
    /// Number of selected tests on all pages.
    pub total: usize,
    /// The `after` of the next page.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<usize>,
}

/// A column of the matrix.
#[derive(Debug, Serialize, ToSchema)]
pub struct MatrixRun {
    /// The identity.
    pub id: String,
    /// The name of its directory.
    pub name: String,
    /// When it started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// Whether it is green.
    pub green: bool,
    /// The commit of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The branch of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<String>,
    /// The profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub host: Option<String>,
}

impl HistoryMatrix {
    /// The view of a matrix.
    pub fn of(matrix: VerdictMatrix, end: usize) -> Self {
        let VerdictMatrix { runs, tests, robots, total } = matrix;
        let run = |run: RunInfo| {
            let RunInfo { id, name, started, green, commit, branch, profile, host, .. } = run;
            MatrixRun { id, name, started, green, commit, branch, profile, host }
        };
        Self {
            runs: runs.into_iter().map(run).collect(),
            tests,
            robots: robots.into_iter().collect(),
            total,
            next: (end < total).then_some(end),
        }
    }
}

/// The history of tests of one name.
#[derive(Debug, Serialize, ToSchema)]
pub struct TestHistories {
    /// The tests.
    pub tests: Vec<TestHistory>,
    /// Changes of durations, measurements and signals.
    pub changes: Vec<HistoryChange>,
}

/// A measurement or signal over runs, per test and unit.
#[derive(Debug, Serialize, ToSchema)]
pub struct SeriesTrend {
    /// The series.
    pub series: Vec<TestSeries>,
    /// Their changes.
    pub changes: Vec<HistoryChange>,
}

/// A change point.
#[derive(Debug, Serialize, ToSchema)]
pub struct HistoryChange {
    /// The test or case.
    #[serde(flatten)]
    pub identity: TestIdentity,
    /// The measurement or signal; missing for the duration.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub series: Option<SeriesName>,
    /// The exclusive resources of the suite, separated by spaces.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub robot: String,
    /// The profile of the runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The first run after the change.
    pub run: String,
    /// The mean before it.
    pub before: f64,
    /// The mean after it.
    pub after: f64,
    /// The size as a fraction of the limits' span or of the mean before.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fraction: Option<f64>,
}

impl From<SeriesChange> for HistoryChange {
    fn from(found: SeriesChange) -> Self {
        let SeriesChange { identity, series, robot, profile, run, change, .. } = found;
        let (before, after) = (change.before.mean, change.after.mean);
        let fraction = change.size.map(|size| size.fraction);
        Self { identity, series, robot, profile, run, before, after, fraction }
    }
}

/// Rates of campaigns.
#[derive(Debug, Serialize, ToSchema)]
pub struct HistoryCampaigns {
    /// The campaigns, by series.
    pub rates: Vec<CampaignSeries>,
    /// Since when the rates are different, the newest change first.
    pub changes: Vec<CampaignChange>,
}

/// Tests by duration.
#[derive(Debug, Serialize, ToSchema)]
pub struct SlowTests {
    /// The slowest first.
    pub tests: Vec<SlowTest>,
}

/// Differences between two sets of runs.
#[derive(Debug, Serialize, ToSchema)]
pub struct HistoryComparison {
    /// The differences.
    pub comparison: Comparison,
}
