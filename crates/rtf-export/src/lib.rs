//! Tables of the history as CSV, JSON and Parquet.

mod campaign_rows;
mod csv;
mod json;
mod parquet;
mod rows;

use std::io::{self, Write};

use rtf_history::answers::{EpisodeLine, PointLine, ResultLine, RunInfo};
use rtf_history::entry::CampaignInfo;
use rtf_history::{RunSelection, Store, StoreError, TestAttributes};

use rows::{ExportRow, RowWriter};

/// The version of the documents, as of those of `rtf history`.
const VERSION: u32 = 1;

/// An export that cannot be continued.
#[derive(Debug)]
pub enum ExportError {
    Store(StoreError),
    Output(io::Error),
}

impl From<StoreError> for ExportError {
    fn from(error: StoreError) -> Self {
        Self::Store(error)
    }
}

impl From<io::Error> for ExportError {
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

/// The format of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    Csv,
    Json,
    Parquet,
}

/// What a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    Runs,
    /// The result of a test or a case in a run.
    Results,
    /// A measurement in a run.
    Points,
    Campaigns,
    Episodes,
}

/// Which rows to export, from where.
pub struct Question<'a> {
    pub format: Format,
    pub table: Table,
    pub store: &'a Store,
    pub runs: RunSelection,
    /// Whether the results and measurements of a test are exported.
    pub is_exported: &'a dyn Fn(&TestAttributes) -> bool,
}

impl Question<'_> {
    /// Writes the rows.
    ///
    /// # Errors
    /// The store cannot be read, or `out` cannot be written.
    pub fn answer(&self, out: &mut (dyn Write + Send)) -> Result<(), ExportError> {
        match self.table {
            Table::Runs => self.write_rows::<RunInfo>(out),
            Table::Results => self.write_rows::<ResultLine>(out),
            Table::Points => self.write_rows::<PointLine>(out),
            Table::Campaigns => self.write_rows::<CampaignInfo>(out),
            Table::Episodes => self.write_rows::<EpisodeLine>(out),
        }
    }

    fn write_rows<R: ReadRows>(&self, out: &mut (dyn Write + Send)) -> Result<(), ExportError> {
        match self.format {
            Format::Csv => self.write_with::<R>(csv::CsvWriter::new::<R>(out)?),
            Format::Json => self.write_with::<R>(json::JsonWriter::new(out)?),
            Format::Parquet => {
                self.write_with::<R>(parquet::ParquetWriter::new::<R>(out, parquet::GROUP)?)
            }
        }
    }

    fn write_with<R: ReadRows>(&self, mut writer: impl RowWriter) -> Result<(), ExportError> {
        R::for_each(self, |row| Ok(writer.add(row)?))?;
        Ok(writer.finish()?)
    }

    fn is_meant(&self, test: &TestAttributes) -> bool {
        (self.is_exported)(test)
    }
}

/// A row that a store has.
trait ReadRows: ExportRow + Sized {
    /// Calls `visit` with each row of the answer.
    fn for_each(
        question: &Question<'_>,
        visit: impl FnMut(&Self) -> Result<(), ExportError>,
    ) -> Result<(), ExportError>;
}

impl ReadRows for RunInfo {
    fn for_each(
        question: &Question<'_>,
        visit: impl FnMut(&Self) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        question.store.runs(&question.runs)?.iter().try_for_each(visit)
    }
}

impl ReadRows for CampaignInfo {
    fn for_each(
        question: &Question<'_>,
        visit: impl FnMut(&Self) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        question.store.campaigns(&question.runs, None)?.iter().try_for_each(visit)
    }
}

impl ReadRows for EpisodeLine {
    fn for_each(
        question: &Question<'_>,
        mut visit: impl FnMut(&Self) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        question.store.for_each_episode(&question.runs, |line| visit(&line))
    }
}

impl ReadRows for ResultLine {
    fn for_each(
        question: &Question<'_>,
        mut visit: impl FnMut(&Self) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let tests = |test: &TestAttributes| question.is_meant(test);
        question.store.for_each_result(&question.runs, &tests, |line| visit(&line))
    }
}

impl ReadRows for PointLine {
    fn for_each(
        question: &Question<'_>,
        mut visit: impl FnMut(&Self) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        let tests = |test: &TestAttributes| question.is_meant(test);
        question.store.for_each_point(&question.runs, &tests, |line| visit(&line))
    }
}
