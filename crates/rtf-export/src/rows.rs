//! The columns of each table, and the cells of a row.

use std::borrow::Cow;
use std::io;

use jiff::Timestamp;
use rtf_history::answers::{PointLine, ResultLine, RunInfo};
use rtf_model::Verdict;
use serde::Serialize;

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

/// The name of a column, and what it contains.
pub type Column = (&'static str, CellType);

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

/// A row of a table: its cells are those of the columns, in their order.
pub trait ExportRow: Serialize {
    /// The name of the table.
    const TABLE: &'static str;

    /// The columns of the table.
    fn columns() -> Vec<Column>;

    /// The values.
    fn cells(&self) -> Vec<Cell<'_>>;
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

    fn columns() -> Vec<Column> {
        use CellType::{Flag, Integer, Number, Text, Time};
        vec![
            ("suite_file", Text),
            ("suite", Text),
            ("test", Text),
            ("case", Text),
            ("run", Text),
            ("name", Text),
            ("started", Time),
            ("commit", Text),
            ("branch", Text),
            ("robot", Text),
            ("verdict", Text),
            ("flaky", Flag),
            ("attempts", Integer),
            ("problems", Integer),
            ("duration", Number),
            ("reason", Text),
            ("plugin_hash", Text),
            ("source_hash", Text),
        ]
    }

    fn cells(&self) -> Vec<Cell<'_>> {
        let Self { identity, result } = self;
        vec![
            text(&identity.suite_file),
            text(&identity.suite),
            text(&identity.test),
            text(&identity.case),
            text(&result.run),
            text(&result.name),
            Cell::Time(Some(result.started)),
            maybe_text(result.commit.as_ref()),
            maybe_text(result.branch.as_ref()),
            text(&result.robot),
            text(result.verdict.as_str()),
            Cell::Flag(Some(result.flaky)),
            integer(result.attempts),
            integer(result.problems),
            Cell::Number(result.duration),
            maybe_text(result.reason.as_ref()),
            maybe_text(result.plugin_hash.as_ref()),
            maybe_text(result.source_hash.as_ref()),
        ]
    }
}

impl ExportRow for PointLine {
    const TABLE: &'static str = "points";

    fn columns() -> Vec<Column> {
        use CellType::{Integer, Number, Text, Time};
        vec![
            ("suite_file", Text),
            ("suite", Text),
            ("test", Text),
            ("case", Text),
            ("kind", Text),
            ("name", Text),
            ("unit", Text),
            ("run", Text),
            ("started", Time),
            ("commit", Text),
            ("value", Number),
            ("min", Number),
            ("max", Number),
            ("count", Integer),
            ("not_finite", Integer),
            ("outside", Integer),
            ("low", Number),
            ("high", Number),
        ]
    }

    fn cells(&self) -> Vec<Cell<'_>> {
        let Self { identity, series, point } = self;
        vec![
            text(&identity.suite_file),
            text(&identity.suite),
            text(&identity.test),
            text(&identity.case),
            text(series.kind.as_str()),
            text(&series.name),
            text(&series.unit),
            text(&point.run),
            Cell::Time(Some(point.started)),
            maybe_text(point.commit.as_ref()),
            Cell::Number(point.value),
            Cell::Number(point.min),
            Cell::Number(point.max),
            integer(point.count),
            integer(point.not_finite),
            integer(point.outside),
            Cell::Number(point.low),
            Cell::Number(point.high),
        ]
    }
}

impl ExportRow for RunInfo {
    const TABLE: &'static str = "runs";

    fn columns() -> Vec<Column> {
        use CellType::{Flag, Integer, Number, Text, Time};
        let attributes = [
            ("id", Text),
            ("name", Text),
            ("started", Time),
            ("duration", Number),
            ("end", Text),
            ("green", Flag),
            ("commit", Text),
            ("branch", Text),
            ("dirty", Flag),
            ("author_time", Time),
            ("ci_job", Text),
            ("host", Text),
            ("cpus", Integer),
            ("load_percent", Integer),
            ("profile", Text),
            ("parameters", Text),
            ("rtf", Text),
        ];
        let verdicts = Verdict::ALL.into_iter().map(|verdict| (verdict.as_str(), Integer));
        attributes.into_iter().chain(verdicts).collect()
    }

    fn cells(&self) -> Vec<Cell<'_>> {
        let mut cells = vec![
            text(&self.id),
            text(&self.name),
            Cell::Time(Some(self.started)),
            Cell::Number(Some(self.duration)),
            text(self.end.as_str()),
            Cell::Flag(Some(self.green)),
            maybe_text(self.commit.as_ref()),
            maybe_text(self.branch.as_ref()),
            Cell::Flag(self.dirty),
            Cell::OffsetTime(self.author_time.as_deref()),
            maybe_text(self.ci_job.as_ref()),
            maybe_text(self.host.as_ref()),
            Cell::Integer(self.cpus.map(u64::from)),
            Cell::Integer(self.load_percent.map(u64::from)),
            maybe_text(self.profile.as_ref()),
            Cell::Text(Some(self.parameters.join(" ").into())),
            text(&self.rtf),
        ];
        cells.extend(Verdict::ALL.map(|verdict| integer(self.counts.of(verdict))));
        cells
    }
}
