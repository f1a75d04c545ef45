//! `rtf history export`.

use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_history::answers::{PointLine, ResultLine, RunInfo};
use rtf_history::{Store, StoreError, TestAttributes};
use rtf_model::Verdict;
use rtf_report::is_disconnect;
use serde::Serialize;

use super::{VERSION, failure, resolve, select};
use crate::cli::{ExportFormat, ExportTable, HistoryExportArgs};
use crate::command::VerbResult;
use crate::error::Failure;

/// The columns of `--table results`.
const RESULT_COLUMNS: &str = "suite_file,suite,test,case,run,name,started,commit,branch,robot,verdict,flaky,attempts,problems,duration,reason,plugin_hash";
/// The columns of `--table points`.
const POINT_COLUMNS: &str = "suite_file,suite,test,case,kind,name,unit,run,started,commit,value,min,max,count,not_finite,outside,low,high";
/// The columns of `--table runs`, without those of verdicts.
const RUN_COLUMNS: &str = "id,name,started,duration,end,green,commit,branch,dirty,author_time,ci_job,host,cpus,load_percent,profile,parameters,rtf";

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

impl From<csv::Error> for ExportError {
    fn from(error: csv::Error) -> Self {
        Self::Output(error.into())
    }
}

/// Exports rows.
pub fn run(mut args: HistoryExportArgs, matches: &ArgMatches) -> VerbResult {
    let path = resolve(&mut args.results, &mut args.file, matches)?;
    let store = Store::open_existing(&path).map_err(failure)?;
    let exported = match &args.output {
        Some(path) => {
            let file = File::create(path).map_err(|error| {
                Failure::input(format!("cannot write `{}`: {error}", path.display()))
            })?;
            export(&args, &store, BufWriter::new(file))?
        }
        None => export(&args, &store, BufWriter::new(io::stdout().lock()))?,
    };
    match exported {
        Err(ExportError::Store(error)) => Err(failure(error)),
        Err(ExportError::Output(error)) if !is_disconnect(&error) => Err(Failure::internal(error)),
        _ => Ok(ExitCode::SUCCESS),
    }
}

fn export(
    args: &HistoryExportArgs,
    store: &Store,
    out: impl Write,
) -> Result<Result<(), ExportError>, Failure> {
    let (runs, filter) = select::results(&args.select)?;
    let is_meant = |test: &TestAttributes| filter.matches(test);
    let mut rows = match args.format {
        ExportFormat::Csv => Rows::csv(out, args.table),
        ExportFormat::Json => Rows::json(out),
    };
    let written = match args.table {
        ExportTable::Runs => store
            .runs(&runs)
            .map_err(ExportError::from)
            .and_then(|runs| runs.iter().try_for_each(|run| rows.add(run, run_cells))),
        ExportTable::Results => {
            store.for_each_result(&runs, &is_meant, |line| rows.add(&line, result_cells))
        }
        ExportTable::Points => {
            store.for_each_point(&runs, &is_meant, |line| rows.add(&line, point_cells))
        }
    };
    Ok(written.and_then(|()| rows.finish()))
}

/// Writes rows.
enum Rows<W: Write> {
    Csv { writer: Box<csv::Writer<W>>, header: Option<Vec<String>> },
    Json { out: W, rows: u64 },
}

impl<W: Write> Rows<W> {
    fn csv(out: W, table: ExportTable) -> Self {
        let columns = |columns: &str| columns.split(',').map(str::to_owned).collect::<Vec<_>>();
        let header = match table {
            ExportTable::Results => columns(RESULT_COLUMNS),
            ExportTable::Points => columns(POINT_COLUMNS),
            ExportTable::Runs => {
                let verdicts = Verdict::ALL.iter().map(|verdict| verdict.as_str().to_owned());
                columns(RUN_COLUMNS).into_iter().chain(verdicts).collect()
            }
        };
        Self::Csv { writer: Box::new(csv::Writer::from_writer(out)), header: Some(header) }
    }

    fn json(out: W) -> Self {
        Self::Json { out, rows: 0 }
    }

    fn add<T: Serialize>(
        &mut self,
        row: &T,
        cells: fn(&T) -> Vec<String>,
    ) -> Result<(), ExportError> {
        match self {
            Self::Csv { writer, header } => {
                header.take().map_or(Ok(()), |header| writer.write_record(header))?;
                writer.write_record(cells(row))?;
            }
            Self::Json { out, rows } => {
                match *rows {
                    0 => write!(out, "{{\"version\":{VERSION},\"rows\":[")?,
                    _ => write!(out, ",")?,
                }
                *rows += 1;
                serde_json::to_writer(&mut *out, row).map_err(io::Error::from)?;
            }
        }
        Ok(())
    }

    fn finish(self) -> Result<(), ExportError> {
        match self {
            Self::Csv { mut writer, header } => {
                header.map_or(Ok(()), |header| writer.write_record(header))?;
                Ok(writer.flush()?)
            }
            Self::Json { mut out, rows } => {
                if rows == 0 {
                    write!(out, "{{\"version\":{VERSION},\"rows\":[")?;
                }
                writeln!(out, "]}}")?;
                Ok(out.flush()?)
            }
        }
    }
}

/// An empty cell for an unknown value.
fn cell<T: ToString>(value: &Option<T>) -> String {
    value.as_ref().map(ToString::to_string).unwrap_or_default()
}

fn result_cells(line: &ResultLine) -> Vec<String> {
    let ResultLine { identity, result } = line;
    vec![
        identity.suite_file.clone(),
        identity.suite.clone(),
        identity.test.clone(),
        identity.case.clone(),
        result.run.clone(),
        result.name.clone(),
        result.started.to_string(),
        cell(&result.commit),
        cell(&result.branch),
        result.robot.clone(),
        result.verdict.to_string(),
        result.flaky.to_string(),
        result.attempts.to_string(),
        result.problems.to_string(),
        cell(&result.duration),
        cell(&result.reason),
        cell(&result.plugin_hash),
    ]
}

fn point_cells(line: &PointLine) -> Vec<String> {
    let PointLine { identity, series, point } = line;
    vec![
        identity.suite_file.clone(),
        identity.suite.clone(),
        identity.test.clone(),
        identity.case.clone(),
        series.kind.as_str().to_owned(),
        series.name.clone(),
        series.unit.clone(),
        point.run.clone(),
        point.started.to_string(),
        cell(&point.commit),
        cell(&point.value),
        cell(&point.min),
        cell(&point.max),
        point.count.to_string(),
        point.not_finite.to_string(),
        point.outside.to_string(),
        cell(&point.low),
        cell(&point.high),
    ]
}

fn run_cells(run: &RunInfo) -> Vec<String> {
    let mut cells = vec![
        run.id.clone(),
        run.name.clone(),
        run.started.to_string(),
        run.duration.to_string(),
        run.end.as_str().to_owned(),
        run.green.to_string(),
        cell(&run.commit),
        cell(&run.branch),
        cell(&run.dirty),
        cell(&run.author_time),
        cell(&run.ci_job),
        cell(&run.host),
        cell(&run.cpus),
        cell(&run.load_percent),
        cell(&run.profile),
        run.parameters.join(" "),
        run.rtf.clone(),
    ];
    cells.extend(Verdict::ALL.map(|verdict| run.counts.of(verdict).to_string()));
    cells
}
