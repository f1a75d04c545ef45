//! The record of a run, or of a campaign, → the rows to store.

mod campaign;
mod number;
mod results;

use jiff::Timestamp;
use rtf_model::{Record, RunStarted, RunState, Verdict};
use serde::{Deserialize, Serialize};

pub use campaign::{CampaignEnd, CampaignEntry, CampaignInfo, EpisodeEntry, interval};
pub use number::{NumberKind, NumberSummary, SeriesName};
pub use results::ResultEntry;

/// Everything that the store keeps of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunEntry {
    /// The identity.
    pub id: String,
    /// The first event.
    pub started: RunStarted,
    /// When it started.
    pub started_at: Timestamp,
    /// The time from its first to its last event, in microseconds.
    pub duration_us: i64,
    /// How it ended.
    pub end: RunEnd,
    /// Whether it is green.
    pub is_green: bool,
    /// Number of tests by verdict, in the order of [`Verdict::ALL`].
    pub counts: [u32; Verdict::ALL.len()],
    /// Number of events. A journal with more events than another one is more complete.
    pub events: u64,
    /// The results of its tests and cases.
    pub results: Vec<ResultEntry>,
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, utoipa::ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum RunEnd {
    /// By itself.
    Finished,
    /// By a signal or a request.
    Interrupted,
    /// Its runner died; the guard completed the journal.
    Died,
    /// The journal has no end.
    Unfinished,
}

impl RunEnd {
    /// The word, as in the store and in JSON.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Interrupted => "interrupted",
            Self::Died => "died",
            Self::Unfinished => "unfinished",
        }
    }
}

/// A record that cannot be stored.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum EntryError {
    /// The journal has no `run-started` event.
    #[error("the journal has no first event")]
    NoStart,
    /// The journal is damaged.
    #[error("the journal is damaged: {0}")]
    Damaged(String),
    /// The start of the run is not a time.
    #[error("the run started at `{0}`, which is not a time")]
    Time(String),
}

impl RunEntry {
    /// Summarises the record of a run that has ended.
    ///
    /// # Errors
    /// The record is damaged or has no first event.
    pub fn new(record: &Record) -> Result<Self, EntryError> {
        if let Some(damage) = record.damages.first() {
            return Err(EntryError::Damaged(damage.to_string()));
        }
        let started = record.run.clone().ok_or(EntryError::NoStart)?;
        let started_at = started.started_at.parse::<Timestamp>();
        let started_at = started_at.map_err(|_| EntryError::Time(started.started_at.clone()))?;
        let end = match &record.state {
            RunState::Running => RunEnd::Unfinished,
            RunState::Died { .. } => RunEnd::Died,
            RunState::Finished { interrupted: Some(_) } => RunEnd::Interrupted,
            RunState::Finished { interrupted: None } => RunEnd::Finished,
        };
        let totals = record.final_totals();
        Ok(Self {
            id: started.id(),
            started_at,
            duration_us: i64::try_from(record.last_at.0).unwrap_or(i64::MAX),
            end,
            is_green: record.is_green(),
            counts: Verdict::ALL.map(|verdict| totals.of(verdict)),
            events: record.events,
            results: results::without_nul(results::of_tests(record, &started)),
            started,
        })
    }
}
