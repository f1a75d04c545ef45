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
#[derive(Debug, thiserror::Error)]
#[error(transparent)]
pub enum ExportError {
    Store(#[from] StoreError),
    Output(#[from] io::Error),
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
        let Self { store, runs, is_exported, .. } = self;
        match self.table {
            Table::Runs => {
                self.write::<RunInfo>(out, |visit| store.runs(runs)?.iter().try_for_each(visit))
            }
            Table::Results => self.write::<ResultLine>(out, |visit| {
                store.for_each_result(runs, is_exported, |line| visit(&line))
            }),
            Table::Points => self.write::<PointLine>(out, |visit| {
                store.for_each_point(runs, is_exported, |line| visit(&line))
            }),
            Table::Campaigns => self.write::<CampaignInfo>(out, |visit| {
                store.campaigns(runs, None)?.iter().try_for_each(visit)
            }),
            Table::Episodes => self.write::<EpisodeLine>(out, |visit| {
                store.for_each_episode(runs, |line| visit(&line))
            }),
        }
    }

    /// Writes the rows with which `read` calls its argument.
    fn write<R: ExportRow>(
        &self,
        out: &mut (dyn Write + Send),
        read: impl FnOnce(Visit<'_, R>) -> Result<(), ExportError>,
    ) -> Result<(), ExportError> {
        match self.format {
            Format::Csv => write_with(csv::CsvWriter::new::<R>(out)?, read),
            Format::Json => write_with(json::JsonWriter::new(out)?, read),
            Format::Parquet => {
                write_with(parquet::ParquetWriter::new::<R>(out, parquet::GROUP)?, read)
            }
        }
    }
}

/// Called with each row of the answer.
type Visit<'v, R> = &'v mut dyn FnMut(&R) -> Result<(), ExportError>;

fn write_with<R: ExportRow>(
    mut writer: impl RowWriter,
    read: impl FnOnce(Visit<'_, R>) -> Result<(), ExportError>,
) -> Result<(), ExportError> {
    read(&mut |row| Ok(writer.add(row)?))?;
    Ok(writer.finish()?)
}
