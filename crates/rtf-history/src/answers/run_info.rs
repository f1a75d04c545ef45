//! The runs.

use jiff::Timestamp;
use rtf_model::Verdict;
use serde::{Serialize, Serializer};
use utoipa::ToSchema;

use crate::entry::RunEnd;
use crate::{RunSelection, Store, StoreError};

/// A stored run.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = HistoryRun)]
pub struct RunInfo {
    /// The identity.
    pub id: String,
    /// The name of its directory.
    pub name: String,
    /// When it started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// The time from its first to its last event, in seconds.
    pub duration: f64,
    /// How it ended.
    pub end: RunEnd,
    /// Whether it is green.
    pub green: bool,
    /// Number of tests by verdict.
    #[serde(rename = "tests")]
    #[schema(value_type = HashMap<String, u32>)]
    pub counts: RunCounts,
    /// The commit of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The branch of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<String>,
    /// Whether the sources differed from the commit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dirty: Option<bool>,
    /// The author time of the commit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author_time: Option<String>,
    /// The address of the CI job.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ci_job: Option<String>,
    /// The machine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub host: Option<String>,
    /// The number of its CPUs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cpus: Option<u32>,
    /// Its load when the run started, in percent of its CPUs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub load_percent: Option<u32>,
    /// The profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The parameters of the command line, as `NAME=VALUE`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<String>,
    /// The version of the runner.
    pub rtf: String,
}

impl RunInfo {
    /// Its commit, if the sources are those of the commit, so that runs of it are comparable.
    /// Where Git did not answer, that is assumed only if the sources are not known otherwise.
    #[must_use]
    pub fn compared_commit(&self, has_sources: bool) -> Option<&str> {
        let commit = self.commit.as_deref();
        commit.filter(|_| self.dirty.map_or(!has_sources, |is_dirty| !is_dirty))
    }
}

/// Number of tests by verdict. Serialised as a map without zeros.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RunCounts(pub(crate) [u32; Verdict::ALL.len()]);

impl RunCounts {
    /// Adds a test.
    pub fn add(&mut self, verdict: Verdict) {
        self.0[verdict as usize] += 1;
    }

    /// The numbers that are not zero, in the order of [`Verdict::ALL`].
    pub fn present(&self) -> impl Iterator<Item = (Verdict, u32)> {
        Verdict::ALL.into_iter().zip(self.0).filter(|(_, count)| *count > 0)
    }

    /// Number of tests.
    #[must_use]
    pub fn total(&self) -> u32 {
        self.0.iter().sum()
    }

    /// Number of tests with this verdict.
    #[must_use]
    pub fn of(&self, verdict: Verdict) -> u32 {
        self.0[verdict as usize]
    }
}

impl Serialize for RunCounts {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.present().map(|(verdict, count)| (verdict.as_str(), count)))
    }
}

impl Store {
    /// The selected runs, the newest first. The robot of a selection is that of results: it
    /// does not apply to runs.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn runs(&self, selection: &RunSelection) -> Result<Vec<RunInfo>, StoreError> {
        let runs = self.selected_runs(selection)?;
        Ok(runs.into_iter().rev().map(|(_, run)| run).collect())
    }
}
