//! The columns of each table, and the cells of a row.

use std::borrow::Cow;
use std::io;

use jiff::Timestamp;
use rtf_history::answers::{PointLine, ResultLine, RunInfo};
use rtf_model::Verdict;
use serde::Serialize;

use CellType::{Flag, Integer, Number, Text, Time};

/// What the cells of a column contain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellType {
    Text,
    Integer,
    Number,
    Flag,
    /// In UTC.
    Time,
}

/// The name of a column, what it contains, and its cell of a row.
pub type Column<R> = (&'static str, CellType, fn(&R) -> Cell<'_>);

/// A value; `None` is unknown.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell<'a> {
    Text(Option<Cow<'a, str>>),
    Integer(Option<u64>),
    Number(Option<f64>),
    Flag(Option<bool>),
    Time(Option<Timestamp>),
    /// A time with an offset, as it was written; in a column of times.
    OffsetTime(Option<&'a str>),
}

/// A row of a table.
pub trait ExportRow: Serialize + Sized + 'static {
    /// The name of the table.
    const TABLE: &'static str;

    const COLUMNS: &'static [Column<Self>];

    /// The values, in the order of the columns.
    fn cells(&self) -> impl Iterator<Item = Cell<'_>> {
        Self::COLUMNS.iter().map(|(_, _, cell)| cell(self))
    }
}

/// Writes rows in a format.
pub trait RowWriter {
    /// Writes a row, or keeps it for later.
    fn add(&mut self, row: &impl ExportRow) -> io::Result<()>;

    /// Writes the end of the document.
    fn finish(self) -> io::Result<()>;
}

pub fn text(text: &str) -> Cell<'_> {
    Cell::Text(Some(text.into()))
}

pub fn maybe_text(text: Option<&String>) -> Cell<'_> {
    Cell::Text(text.map(|text| text.as_str().into()))
}

pub fn integer(number: impl Into<u64>) -> Cell<'static> {
    Cell::Integer(Some(number.into()))
}

impl ExportRow for ResultLine {
    const TABLE: &'static str = "results";
    const COLUMNS: &'static [Column<Self>] = &[
        ("suite_file", Text, |it| text(&it.identity.suite_file)),
        ("suite", Text, |it| text(&it.identity.suite)),
        ("test", Text, |it| text(&it.identity.test)),
        ("case", Text, |it| text(&it.identity.case)),
        ("run", Text, |it| text(&it.result.run)),
        ("name", Text, |it| text(&it.result.name)),
        ("started", Time, |it| Cell::Time(Some(it.result.started))),
        ("commit", Text, |it| maybe_text(it.result.commit.as_ref())),
        ("branch", Text, |it| maybe_text(it.result.branch.as_ref())),
        ("robot", Text, |it| text(&it.result.robot)),
        ("verdict", Text, |it| text(it.result.verdict.as_str())),
        ("flaky", Flag, |it| Cell::Flag(Some(it.result.flaky))),
        ("attempts", Integer, |it| integer(it.result.attempts)),
        ("problems", Integer, |it| integer(it.result.problems)),
        ("duration", Number, |it| Cell::Number(it.result.duration)),
        ("reason", Text, |it| maybe_text(it.result.reason.as_ref())),
        ("plugin_hash", Text, |it| maybe_text(it.result.plugin_hash.as_ref())),
        ("source_hash", Text, |it| maybe_text(it.result.source_hash.as_ref())),
    ];
}

impl ExportRow for PointLine {
    const TABLE: &'static str = "points";
    const COLUMNS: &'static [Column<Self>] = &[
        ("suite_file", Text, |it| text(&it.identity.suite_file)),
        ("suite", Text, |it| text(&it.identity.suite)),
        ("test", Text, |it| text(&it.identity.test)),
        ("case", Text, |it| text(&it.identity.case)),
        ("kind", Text, |it| text(it.series.kind.as_str())),
        ("name", Text, |it| text(&it.series.name)),
        ("unit", Text, |it| text(&it.series.unit)),
        ("run", Text, |it| text(&it.point.run)),
        ("started", Time, |it| Cell::Time(Some(it.point.started))),
        ("commit", Text, |it| maybe_text(it.point.commit.as_ref())),
        ("value", Number, |it| Cell::Number(it.point.value)),
        ("min", Number, |it| Cell::Number(it.point.min)),
        ("max", Number, |it| Cell::Number(it.point.max)),
        ("count", Integer, |it| integer(it.point.count)),
        ("not_finite", Integer, |it| integer(it.point.not_finite)),
        ("outside", Integer, |it| integer(it.point.outside)),
        ("low", Number, |it| Cell::Number(it.point.low)),
        ("high", Number, |it| Cell::Number(it.point.high)),
    ];
}

impl ExportRow for RunInfo {
    const TABLE: &'static str = "runs";
    const COLUMNS: &'static [Column<Self>] = &[
        ("id", Text, |it| text(&it.id)),
        ("name", Text, |it| text(&it.name)),
        ("started", Time, |it| Cell::Time(Some(it.started))),
        ("duration", Number, |it| Cell::Number(Some(it.duration))),
        ("end", Text, |it| text(it.end.as_str())),
        ("green", Flag, |it| Cell::Flag(Some(it.green))),
        ("commit", Text, |it| maybe_text(it.commit.as_ref())),
        ("branch", Text, |it| maybe_text(it.branch.as_ref())),
        ("dirty", Flag, |it| Cell::Flag(it.dirty)),
        ("author_time", Time, |it| Cell::OffsetTime(it.author_time.as_deref())),
        ("ci_job", Text, |it| maybe_text(it.ci_job.as_ref())),
        ("host", Text, |it| maybe_text(it.host.as_ref())),
        ("cpus", Integer, |it| Cell::Integer(it.cpus.map(u64::from))),
        ("load_percent", Integer, |it| Cell::Integer(it.load_percent.map(u64::from))),
        ("profile", Text, |it| maybe_text(it.profile.as_ref())),
        ("parameters", Text, |it| Cell::Text(Some(it.parameters.join(" ").into()))),
        ("rtf", Text, |it| text(&it.rtf)),
        ("passed", Integer, |it| integer(it.counts.of(Verdict::Passed))),
        ("failed", Integer, |it| integer(it.counts.of(Verdict::Failed))),
        ("error", Integer, |it| integer(it.counts.of(Verdict::Error))),
        ("crashed", Integer, |it| integer(it.counts.of(Verdict::Crashed))),
        ("timed-out", Integer, |it| integer(it.counts.of(Verdict::TimedOut))),
        ("collapsed", Integer, |it| integer(it.counts.of(Verdict::Collapsed))),
        ("skipped", Integer, |it| integer(it.counts.of(Verdict::Skipped))),
        ("interrupted", Integer, |it| integer(it.counts.of(Verdict::Interrupted))),
    ];
}
