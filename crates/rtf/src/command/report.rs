//! `rtf report`: writes a report of a past run.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_report::journal::{self, JournalError};
use rtf_report::{ReportError, output_file};
use rtf_run::error::Failure;
use rtf_run::formats::ReportFormat;
use rtf_run::request::past_run;
use rtf_run::{exit, reports, terminal};

use super::VerbResult;
use crate::cli::ReportArgs;
use crate::request::config;

/// Writes a report. The exit code is about the report, not about the run; it is 1 for
/// a damaged journal, whose report is incomplete.
pub fn run(mut args: ReportArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let journal = past_run::find_journal(&args.results.results, &args.run)?;
    let damages = journal::find_damage(&journal).map_err(past_run::unreadable)?;
    terminal::stderr(|err| {
        let (red, reset) = ("\u{1b}[1;31m", "\u{1b}[0m");
        damages.iter().try_for_each(|damage| {
            writeln!(err, "{red}error{reset}: the journal is damaged: {damage}")
        })
    })?;
    match args.format {
        ReportFormat::Json => {
            let mut unreadable = None;
            let written = write(&args, |out| copy_events(&journal, out, &mut unreadable));
            unreadable.map_or(written, |error| Err(past_run::unreadable(error)))?;
        }
        format => {
            let record = journal::read(&journal).map_err(past_run::unreadable)?.record;
            reports::check_build(format)?;
            let (output, url) = (args.output.as_deref(), args.link.as_deref());
            let place = reports::Place { journal: Some(&journal), output, url };
            write(&args, |out| reports::write(format, out, &record, &place))?;
        }
    }
    Ok(ExitCode::from(if damages.is_empty() { exit::PASSED } else { exit::FAILED }))
}

fn write(
    args: &ReportArgs,
    fill: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), Failure> {
    let Some(path) = &args.output else { return terminal::raw_stdout(|out| fill(out)) };
    let title = reports::title(args.format);
    output_file::probe(title, path)
        .map_err(|error| Failure::input(error).hint("choose another path with `-o PATH`"))?;
    output_file::write(title, path, |out| fill(out)).map_err(Failure::internal)
}

/// Copies the readable lines of the journal unchanged, so that damage is found in the
/// copy, too.
fn copy_events(
    journal: &Path,
    out: &mut dyn Write,
    unreadable: &mut Option<JournalError>,
) -> io::Result<()> {
    let failed = |source| ReportError { what: "the events", path: "the output".into(), source };
    let copied = journal::read_lines(journal, |line| {
        out.write_all(line).and_then(|()| out.write_all(b"\n")).map_err(failed)
    });
    match copied {
        Ok(_) => Ok(()),
        Err(JournalError::Report(error)) => Err(error.source),
        Err(error) => {
            *unreadable = Some(error);
            Err(io::ErrorKind::InvalidData.into())
        }
    }
}
