//! `rtf history export`: rows as CSV, JSON or Parquet.

use std::io::{self, IsTerminal, Write};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_export::{ExportError, Format, Question, Table};
use rtf_history::Store;
use rtf_report::output_file;
use rtf_run::error::Failure;
use rtf_run::terminal;

use super::{failure, resolve, select};
use crate::cli::{ExportFormat, ExportTable, HistoryExportArgs};
use crate::command::VerbResult;

/// Exports rows.
pub fn run(mut args: HistoryExportArgs, matches: &ArgMatches) -> VerbResult {
    let path = resolve(&mut args.results, &mut args.file, matches)?;
    if args.format == ExportFormat::Parquet && args.output.is_none() && io::stdout().is_terminal() {
        return Err(Failure::input("Parquet is binary, and standard output is a terminal")
            .hint("write it to a file with `--output PATH`"));
    }
    let store = Store::open_existing(&path).map_err(failure)?;
    let (runs, filter) = select::results(&args.select)?;
    let question = Question {
        format: match args.format {
            ExportFormat::Csv => Format::Csv,
            ExportFormat::Json => Format::Json,
            ExportFormat::Parquet => Format::Parquet,
        },
        table: match args.table {
            ExportTable::Runs => Table::Runs,
            ExportTable::Results => Table::Results,
            ExportTable::Points => Table::Points,
            ExportTable::Campaigns => Table::Campaigns,
            ExportTable::Episodes => Table::Episodes,
        },
        store: &store,
        runs,
        is_exported: &|test| filter.matches(test),
    };
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
