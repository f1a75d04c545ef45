//! Writes the results of the episodes of a campaign to `episodes.jsonl` in the directory of the
//! run, as they arrive, so that a program that follows the campaign needs not read the journal.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};

use rtf_model::{
    CaseId, EpisodeOutcome, EpisodeRecord, Event, EventKind, Record, Source, SuiteId, TestAttempt,
};
use serde::{Deserialize, Serialize};

use crate::{ReportError, Reporter};

pub const EPISODE_RESULTS: &str = "episodes.jsonl";
const WHAT: &str = "the results of the episodes";

/// A line of the file: an episode starts, or has finished.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EpisodeLine {
    pub episode: u64,
    /// Its result; `None`: it starts.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outcome: Option<EpisodeOutcome>,
    /// The first reason why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The test that did not pass, if it was one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<TestAttempt>,
    /// The test that shows it, if it passed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shown: Option<TestAttempt>,
    /// From its start to its end, in microseconds.
    #[serde(default)]
    pub duration_us: u64,
    /// What its tests measured, up to [`EpisodeLine::MEASUREMENTS_KEPT`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub measurements: Vec<EpisodeMeasurement>,
    /// The same text for the same first observation, if its test reported one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_observation: Option<String>,
}

/// A number that a test measured in an episode, outside of cases.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EpisodeMeasurement {
    pub test: String,
    pub name: String,
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// The value; `None` if it is not finite.
    pub value: Option<f64>,
}

impl EpisodeLine {
    /// The most measurements of an episode; the journal has all of them.
    pub const MEASUREMENTS_KEPT: usize = 100;
}

/// Writes the results of a run's episodes.
#[derive(Debug)]
pub struct EpisodeResults {
    path: PathBuf,
    file: File,
}

impl EpisodeResults {
    /// Creates the file in the directory of a run.
    ///
    /// # Errors
    /// The file cannot be created.
    pub fn create(dir: &Path) -> Result<Self, ReportError> {
        let path = dir.join(EPISODE_RESULTS);
        let file = File::create(&path).map_err(ReportError::at(WHAT, &path))?;
        Ok(Self { path, file })
    }

    fn starts(&mut self, episode: u64) -> Result<(), ReportError> {
        self.write(&EpisodeLine { episode, ..EpisodeLine::default() })
    }

    fn write(&mut self, line: &EpisodeLine) -> Result<(), ReportError> {
        // Numbers and texts always serialise.
        let mut text = serde_json::to_string(line).unwrap_or_default();
        text.push('\n');
        self.file.write_all(text.as_bytes()).map_err(ReportError::at(WHAT, &self.path))
    }
}

impl Reporter for EpisodeResults {
    fn event(&mut self, event: &Event, record: &Record) -> Result<(), ReportError> {
        match &event.kind {
            EventKind::EpisodeStarted(started) => self.starts(started.episode.id),
            EventKind::CaseStarted(case) => {
                case.start.episode.map_or(Ok(()), |episode| self.starts(episode.id))
            }
            EventKind::EpisodeFinished { suite, .. } => {
                last(record, *suite, None).map_or(Ok(()), |line| self.write(&line))
            }
            EventKind::CaseFinished(end) => {
                let suite = record.suite_of(Source::Test(end.test));
                let line = suite.and_then(|suite| last(record, suite, Some(end.case)));
                line.map_or(Ok(()), |line| self.write(&line))
            }
            _ => Ok(()),
        }
    }
}

/// The result of the newest episode, if it is this case.
fn last(record: &Record, suite: SuiteId, case: Option<CaseId>) -> Option<EpisodeLine> {
    let episode: &EpisodeRecord = record.suites.get(suite.index())?.episodes.last()?;
    if episode.case() != case {
        return None;
    }
    let (finished, outcome, reason) = episode.finished.clone()?;
    Some(EpisodeLine {
        episode: episode.episode.id,
        outcome: Some(outcome),
        reason,
        problem: record.episode_problem(suite).filter(|_| outcome != EpisodeOutcome::Passed),
        shown: record.episode_shown(suite).filter(|_| outcome == EpisodeOutcome::Passed),
        duration_us: finished.0.saturating_sub(episode.started.0),
        measurements: measurements(record, suite),
        first_observation: episode.first_observation().map(str::to_owned),
    })
}

fn measurements(record: &Record, suite: SuiteId) -> Vec<EpisodeMeasurement> {
    let all = record.episode_measurements(suite).into_iter();
    let kept = all.take(EpisodeLine::MEASUREMENTS_KEPT).map(|(test, it)| EpisodeMeasurement {
        test: test.plan.name.clone(),
        name: it.name.clone(),
        unit: it.unit.clone(),
        value: it.value,
    });
    kept.collect()
}
