//! `rtf report`: a report of a past run.

use std::io::Write;
use std::process::ExitCode;

use rtf_report::{Reporter, journal, junit, text};

use super::Outcome;
use super::show::{find, tell_damage, unreadable};
use crate::cli::{Format, ReportArgs};
use crate::error::Failure;

/// Writes the report. Its exit code is about the writing, not about the run.
pub fn run(args: &ReportArgs) -> Outcome {
    let path = find(&args.results, &args.run)?;
    let folder = path.parent();
    let stored = journal::read(&path).map_err(unreadable)?;
    tell_damage(&stored)?;
    match &args.output {
        Some(output) => {
            let mut report: Box<dyn Reporter> = match args.format {
                Format::Text => Box::new(text::TextFile::new(output).map_err(Failure::input)?),
                Format::Junit => {
                    Box::new(junit::JunitFile::new(output, folder).map_err(Failure::input)?)
                }
            };
            report.finish(&stored.record).map_err(Failure::own)?;
        }
        None => {
            let mut out = std::io::stdout().lock();
            let written = match args.format {
                Format::Text => text::write(&mut out, &stored.record),
                Format::Junit => junit::write(&mut out, &stored.record, folder),
            };
            Failure::unless_reader_left(written.and_then(|()| out.flush()))?;
        }
    }
    Ok(ExitCode::SUCCESS)
}
