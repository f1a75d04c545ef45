//! `rtf history export`: rows as CSV, JSON or Parquet.

mod campaign_rows;
mod csv;
mod json;
mod parquet;
mod rows;

use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_history::answers::{EpisodeLine, PointLine, ResultLine, RunInfo};
use rtf_history::entry::CampaignInfo;
use rtf_history::{Store, StoreError, TestAttributes};
use rtf_report::output_file;
use rtf_run::error::Failure;
use rtf_run::terminal;

use self::rows::{ExportRow, RowWriter};
use super::{VERSION, failure, resolve, select};
use crate::cli::{ExportFormat, ExportTable, HistoryExportArgs};
use crate::command::VerbResult;

/// An export that cannot be continued.
#[derive(Debug)]
enum ExportError {
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

/// Exports rows.
pub fn run(mut args: HistoryExportArgs, matches: &ArgMatches) -> VerbResult {
    let path = resolve(&mut args.results, &mut args.file, matches)?;
    if args.format == ExportFormat::Parquet && args.output.is_none() && io::stdout().is_terminal() {
        return Err(Failure::input("Parquet is binary, and standard output is a terminal")
            .hint("write it to a file with `--output PATH`"));
    }
    let store = Store::open_existing(&path).map_err(failure)?;
    let question = Question::new(&args, &store)?;
    let mut unreadable = None;
    let fill = |out: &mut (dyn Write + Send)| match question.answer(out) {
        Err(ExportError::Output(error)) => Err(error),
        Err(ExportError::Store(error)) => {
            unreadable = Some(error);
            Err(io::ErrorKind::InvalidData.into())
        }
        Ok(()) => Ok(()),
    };
    let written = write(&args, fill);
    unreadable.map_or(written, |error| Err(failure(error)))?;
    Ok(ExitCode::SUCCESS)
}

fn write(
    args: &HistoryExportArgs,
    fill: impl FnOnce(&mut (dyn Write + Send)) -> io::Result<()>,
) -> Result<(), Failure> {
    let Some(path) = &args.output else { return terminal::raw_stdout(fill) };
    output_file::probe("the export", path)
        .map_err(|error| Failure::input(error).hint("choose another file with `--output PATH`"))?;
    output_file::write("the export", path, fill).map_err(Failure::internal)
}

/// Which rows to export, from where.
struct Question<'a> {
    format: ExportFormat,
    table: ExportTable,
    store: &'a Store,
    runs: rtf_history::RunSelection,
    filter: rtf_run::history::TestFilter,
}

impl<'a> Question<'a> {
    fn new(args: &HistoryExportArgs, store: &'a Store) -> Result<Self, Failure> {
        let (runs, filter) = select::results(&args.select)?;
        Ok(Self { format: args.format, table: args.table, store, runs, filter })
    }

    fn answer(&self, out: &mut (dyn Write + Send)) -> Result<(), ExportError> {
        match self.table {
            ExportTable::Runs => self.write_rows::<RunInfo>(out),
            ExportTable::Results => self.write_rows::<ResultLine>(out),
            ExportTable::Points => self.write_rows::<PointLine>(out),
            ExportTable::Campaigns => self.write_rows::<CampaignInfo>(out),
            ExportTable::Episodes => self.write_rows::<EpisodeLine>(out),
        }
    }

    fn write_rows<R: ReadRows>(&self, out: &mut (dyn Write + Send)) -> Result<(), ExportError> {
        match self.format {
            ExportFormat::Csv => self.write_with::<R>(csv::CsvWriter::new::<R>(out)?),
            ExportFormat::Json => self.write_with::<R>(json::JsonWriter::new(out)?),
            ExportFormat::Parquet => {
                self.write_with::<R>(parquet::ParquetWriter::new::<R>(out, parquet::GROUP)?)
            }
        }
    }

    fn write_with<R: ReadRows>(&self, mut writer: impl RowWriter) -> Result<(), ExportError> {
        R::for_each(self, |row| Ok(writer.add(row)?))?;
        Ok(writer.finish()?)
    }

    fn is_meant(&self, test: &TestAttributes) -> bool {
        self.filter.matches(test)
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
