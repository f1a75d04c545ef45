//! Times of day in a run.

use chrono::{DateTime, FixedOffset};
use rtf_model::{Micros, Record};

/// The time of day of a moment of the run, when the run's start is known.
pub(super) fn at(record: &Record, at: Micros) -> Option<DateTime<FixedOffset>> {
    let started = &record.run.as_ref()?.started_at;
    let started = DateTime::parse_from_rfc3339(started).ok()?;
    started.checked_add_signed(chrono::Duration::from_std(at.as_duration()).ok()?)
}
