//! `rtf report`: a report of a past run.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use rtf_report::journal::{self, JournalError};
use rtf_report::{ReportError, output_file};

use super::show::{find, print_damage, unreadable};
use super::{Outcome, output};
use crate::cli::{Format, ReportArgs};
use crate::error::Failure;
use crate::exit;

const WHAT: &str = "the events";

/// Writes the report. Its exit code is about the writing, not about the run; but
/// a report of a damaged journal is not whole.
pub fn run(args: &ReportArgs) -> Outcome {
    let path = find(&args.results, &args.run)?;
    let damages = journal::find_damage(&path).map_err(unreadable)?;
    print_damage(&damages)?;
    match args.format {
        Format::Json => events(&path, args.output.as_deref())?,
        _ => report(&path, args)?,
    }
    Ok(if damages.is_empty() { ExitCode::SUCCESS } else { ExitCode::from(exit::FAILED) })
}

fn report(journal: &Path, args: &ReportArgs) -> Result<(), Failure> {
    let record = journal::read(journal).map_err(unreadable)?.record;
    match &args.output {
        Some(output) => {
            let report = output::open_report(args.format, output, journal.parent());
            let mut report = report.map_err(elsewhere)?;
            report.finish(&record).map_err(Failure::own)
        }
        None => {
            let mut out = io::stdout().lock();
            let written = output::write(args.format, &mut out, &record, journal.parent());
            Failure::unless_reader_left(written.and_then(|()| out.flush()))
        }
    }
}

fn elsewhere(failure: Failure) -> Failure {
    failure.hint("choose another path with `-o PATH`".to_owned())
}

/// The events themselves: the lines of the journal that can be read, as they are,
/// so that damage can be found in the copy, too.
fn events(journal: &Path, output: Option<&Path>) -> Result<(), Failure> {
    match output {
        None => {
            let mut out = io::BufWriter::new(io::stdout().lock());
            match copy(journal, &mut out) {
                Ok(()) => Failure::unless_reader_left(out.flush()),
                Err(JournalError::Report(error)) => Failure::unless_reader_left(Err(error.source)),
                Err(error) => Err(unreadable(error)),
            }
        }
        Some(path) => {
            let mut events = Vec::new();
            copy(journal, &mut events).map_err(unreadable)?;
            let written = output_file::write(WHAT, path, |out| out.write_all(&events));
            written.map_err(|error| elsewhere(Failure::input(error)))
        }
    }
}

fn copy(journal: &Path, out: &mut impl Write) -> Result<(), JournalError> {
    let failed = |source| ReportError { what: WHAT, path: "standard output".into(), source };
    let copied = journal::read_lines(journal, |line| {
        out.write_all(line).and_then(|()| out.write_all(b"\n")).map_err(failed)
    });
    copied.map(drop)
}
