//! `rtf report`: a report of a past run.

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use rtf_report::event_stream::{self, EventStream};
use rtf_report::{ReportError, journal, output_file};

use super::show::{find, tell_damage, unreadable};
use super::{Outcome, output};
use crate::cli::{Format, ReportArgs};
use crate::error::Failure;

/// Writes the report. Its exit code is about the writing, not about the run.
pub fn run(args: &ReportArgs) -> Outcome {
    let path = find(&args.results, &args.run)?;
    if args.format == Format::Json {
        return events(&path, args.output.as_deref());
    }
    let stored = journal::read(&path).map_err(unreadable)?;
    tell_damage(&stored)?;
    match &args.output {
        Some(output) => {
            let report = output::open_report(args.format, output, path.parent());
            let mut report = report.map_err(elsewhere)?;
            report.finish(&stored.record).map_err(Failure::own)?;
        }
        None => {
            let mut out = std::io::stdout().lock();
            let written = output::write(args.format, &mut out, &stored.record, path.parent());
            Failure::unless_reader_left(written.and_then(|()| out.flush()))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn elsewhere(failure: Failure) -> Failure {
    failure.hint("choose another path with `-o PATH`".to_owned())
}

/// The events themselves: those of a journal that can be read.
fn events(journal: &Path, output: Option<&Path>) -> Outcome {
    let stored = match output {
        None => journal::replay(journal, &mut EventStream::new(Box::new(std::io::stdout()))),
        Some(path) => {
            let mut events = Vec::new();
            let stored = journal::read_with(journal, |event, _| {
                event_stream::write(&mut events, event).map_err(|source| ReportError {
                    what: "the events",
                    path: path.to_owned(),
                    source,
                })
            });
            output_file::write("the events", path, |out| out.write_all(&events))
                .map_err(|error| elsewhere(Failure::input(error)))?;
            stored
        }
    };
    tell_damage(&stored.map_err(unreadable)?)?;
    Ok(ExitCode::SUCCESS)
}
