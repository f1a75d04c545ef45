//! `rtf history`: questions to the results of many runs.

mod accept;
mod campaigns;
mod changes;
mod compare;
mod doctor;
mod export;
mod flaky;
mod gate;
mod import;
mod prune;
mod runs;
mod select;
mod show;
mod slow;
mod text;
mod trend;

use std::io::Write;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_history::{Location, Store, StoreError};
use rtf_run::error::Failure;
use rtf_run::{history, terminal};
use serde::Serialize;

use super::VerbResult;
use crate::cli::{HistoryArgs, HistoryFileArgs, HistoryFormat, HistoryVerb, ResultsArgs};
use crate::request::config;

/// The version of the JSON documents.
const VERSION: u32 = 1;

/// Answers a question.
pub fn run(verb: HistoryVerb, matches: &ArgMatches) -> VerbResult {
    let matches = matches.subcommand().map_or(matches, |(_, matches)| matches);
    match verb {
        HistoryVerb::Runs(args) => runs::run(args, matches),
        HistoryVerb::Show(args) => show::run(args, matches),
        HistoryVerb::Flaky(args) => flaky::run(args, matches),
        HistoryVerb::Slow(args) => slow::run(args, matches),
        HistoryVerb::Trend(args) => trend::run(args, matches),
        HistoryVerb::Campaigns(args) => campaigns::list(args, matches),
        HistoryVerb::Rates(args) => campaigns::rates(args, matches),
        HistoryVerb::Changes(args) => changes::run(args, matches),
        HistoryVerb::Compare(args) => compare::run(args, matches),
        HistoryVerb::Gate(args) => gate::run(args, matches),
        HistoryVerb::Accept(args) => accept::run(args, matches),
        HistoryVerb::Export(args) => export::run(args, matches),
        HistoryVerb::Prune(args) => prune::run(args, matches),
        HistoryVerb::Import(args) => import::run(args, matches),
        HistoryVerb::Doctor(args) => doctor::run(args, matches),
    }
}

/// Fills in the arguments from `rtf.toml`, and resolves the database.
fn resolve(
    results: &mut ResultsArgs,
    file: &mut HistoryFileArgs,
    matches: &ArgMatches,
) -> Result<Location, Failure> {
    config::fill_history(results, file, matches)?;
    history::resolve(file.history.as_deref(), &results.results)
}

/// Opens the database for questions.
fn open(args: &mut HistoryArgs, matches: &ArgMatches) -> Result<Store, Failure> {
    let path = resolve(&mut args.results, &mut args.file, matches)?;
    Store::open_existing(&path).map_err(failure)
}

/// An error of the database: bad input, unless it cannot be written.
fn failure(error: StoreError) -> Failure {
    let hint = error.hint();
    match error {
        StoreError::Io { .. } | StoreError::Locked { .. } => Failure::internal(error),
        error => Failure::input(error),
    }
    .maybe_hint(hint)
}

/// Prints an answer as text, or as a JSON document in the field `name`.
fn print<T: Serialize>(
    format: HistoryFormat,
    name: &str,
    answer: &T,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> VerbResult {
    match format {
        HistoryFormat::Text => terminal::stdout(write)?,
        HistoryFormat::Json => terminal::raw_stdout(|out| write_json(out, name, answer))?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Prints an answer of two parts: two fields of the JSON document.
fn print_both<A: Serialize, B: Serialize>(
    format: HistoryFormat,
    (name, answer): (&str, &A),
    (other_name, other): (&str, &B),
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> VerbResult {
    match format {
        HistoryFormat::Text => terminal::stdout(write)?,
        HistoryFormat::Json => terminal::raw_stdout(|out| {
            write!(out, "{{\"version\":{VERSION},\"{name}\":")?;
            serde_json::to_writer(&mut *out, answer)?;
            write!(out, ",\"{other_name}\":")?;
            serde_json::to_writer(&mut *out, other)?;
            writeln!(out, "}}")
        })?,
    }
    Ok(ExitCode::SUCCESS)
}

fn write_json<T: Serialize>(out: &mut dyn Write, name: &str, answer: &T) -> std::io::Result<()> {
    write!(out, "{{\"version\":{VERSION},\"{name}\":")?;
    serde_json::to_writer(&mut *out, answer)?;
    writeln!(out, "}}")
}
