//! What `rtf run` prints: the run in the requested format, and annotations.

use std::io::{self, Write};
use std::path::Path;

use rtf_model::Record;
use rtf_report::background_writer::BackgroundWriter;
use rtf_report::console::{Console, ConsoleOptions, Operator, Verbosity};
use rtf_report::event_stream::EventStream;
use rtf_report::gitlab::Sections;
use rtf_report::run_dir::RunDir;
use rtf_report::tap::TapStream;
use rtf_report::{AnnotationReporter, FailureNotice, Reporter, escape};

use crate::formats::{Annotations, OutputFormat, ReportFormat};
use crate::reports::Place;
use crate::request::OutputRequest;
use crate::{reports, rerun_command, terminal};

/// The reporters that print a run.
pub fn reporters(
    request: &OutputRequest,
    dir: &RunDir,
    stdout: &BackgroundWriter,
    operator: Option<Operator>,
) -> Vec<Box<dyn Reporter>> {
    let printer: Box<dyn Reporter> = match request.format {
        OutputFormat::Json => Box::new(EventStream::new(Box::new(stdout.for_stream()))),
        OutputFormat::Tap => Box::new(TapStream::new(Box::new(stdout.for_stream()))),
        OutputFormat::Console => {
            let options = ConsoleOptions {
                progress: request.progress,
                ..console_options(&dir.path, request.verbose)
            };
            let console = Console::over(stdout, options);
            let console = Box::new(match operator {
                Some(operator) => console.with_operator(operator),
                None => console,
            });
            match request.annotations {
                Annotations::Gitlab => {
                    Box::new(Sections::around(console, Box::new(stdout.clone())))
                }
                _ => console,
            }
        }
    };
    let mut reporters = vec![printer];
    if request.format != OutputFormat::Console {
        reporters.push(Box::new(FailureNotice));
    }
    if request.annotations == Annotations::Github {
        // GitHub reads both outputs, and standard output may be data.
        reporters.push(Box::new(AnnotationReporter(Box::new(annotate))));
    }
    reporters
}

/// Completes reports and standard output after the runner died.
pub fn complete(request: &OutputRequest, journal: &Path, record: &Record) {
    for (format, path) in &request.reports {
        reports::finish(reports::open(*format, path, &request.results), record);
    }
    let completed = terminal::raw_stdout(|out| {
        complete_stdout(request.format, out, journal, record)?;
        if request.annotations == Annotations::Github { annotate(record) } else { Ok(()) }
    });
    if let Err(failure) = completed {
        failure.print();
    }
}

/// Standard output may end within a line.
fn complete_stdout(
    format: OutputFormat,
    out: &mut dyn Write,
    journal: &Path,
    record: &Record,
) -> io::Result<()> {
    match format {
        OutputFormat::Console => Ok(()),
        OutputFormat::Json => {
            let text = std::fs::read_to_string(journal)?;
            writeln!(out, "\n{}", text.lines().next_back().unwrap_or_default())
        }
        OutputFormat::Tap => {
            let reason = record.runner_death().unwrap_or("the runner died");
            writeln!(out, "\nBail out! {}", escape::line(reason))
        }
    }
}

/// The options of a console that prints a run in the directory `dir`.
pub fn console_options(dir: &Path, verbose: bool) -> ConsoleOptions {
    ConsoleOptions {
        verbosity: if verbose { Verbosity::Verbose } else { Verbosity::Normal },
        folder: Some(dir.to_owned()),
        rerun: rerun_command::for_run(),
        replay: rerun_command::for_replay(),
        ..ConsoleOptions::default()
    }
}

fn annotate(record: &Record) -> io::Result<()> {
    reports::write(ReportFormat::Github, &mut io::stderr(), record, &Place::default())
}
