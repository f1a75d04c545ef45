//! Where a run is told: standard output, reports, and the code host.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rtf_model::Record;
use rtf_report::background_writer::BackgroundWriter;
use rtf_report::console::{Console, ConsoleOptions, Verbosity};
use rtf_report::event_stream::EventStream;
use rtf_report::gitlab::Sections;
use rtf_report::junit;
use rtf_report::tap::{self, TapStream};
use rtf_report::text;
use rtf_report::{AnnotationReporter, FailureNotice, ReportError, Reporter, code_quality, github};

use super::again;
use crate::cli::{Annotations, Format, RunArgs, Shown};
use crate::error::Failure;

const REPORT_HINT: &str = "choose another path with `--report FORMAT=PATH`";

/// Finds out before anything is started whether the reports can be written.
pub fn check_reports(reports: &[(Format, PathBuf)]) -> Result<(), Failure> {
    for (index, (format, path)) in reports.iter().enumerate() {
        if reports[..index].iter().any(|(_, earlier)| earlier == path) {
            let message = format!("two reports would be written to `{}`", path.display());
            return Err(Failure::input(message).hint(REPORT_HINT.to_owned()));
        }
        open_report(*format, path, None)?;
    }
    Ok(())
}

/// Opens a report's file. `folder` is the run's.
pub fn open_report(
    format: Format,
    path: &Path,
    folder: Option<&Path>,
) -> Result<Box<dyn Reporter>, Failure> {
    let root = repository();
    let root = root.as_deref();
    let report: Result<Box<dyn Reporter>, ReportError> = match format {
        Format::Text => text::file(path).map(|report| Box::new(report) as _),
        Format::Junit => junit::file(path, folder).map(|report| Box::new(report) as _),
        Format::Tap => tap::file(path).map(|report| Box::new(report) as _),
        Format::CodeQuality => code_quality::file(path, root).map(|report| Box::new(report) as _),
        Format::Github => github::file(path, root).map(|report| Box::new(report) as _),
        Format::Json => return Err(Failure::input("the journal holds the events already")),
    };
    report.map_err(|error| Failure::input(error).hint(REPORT_HINT.to_owned()))
}

/// Writes a report of a past run.
pub fn write(
    format: Format,
    out: &mut dyn Write,
    record: &Record,
    folder: Option<&Path>,
) -> io::Result<()> {
    let root = repository();
    match format {
        Format::Text => text::write(out, record),
        Format::Junit => junit::write(out, record, folder),
        Format::Tap => tap::write(out, record),
        Format::CodeQuality => code_quality::write(out, record, root.as_deref()),
        Format::Github => github::write(out, record, root.as_deref()),
        Format::Json => Err(io::Error::other("a record holds no events")),
    }
}

/// Standard output, which a run does not wait for.
pub fn outlet() -> Result<BackgroundWriter, Failure> {
    BackgroundWriter::new(Box::new(io::stdout())).map_err(Failure::own)
}

/// What goes to standard output, and to the code host.
pub fn shown(args: &RunArgs, folder: &Path, outlet: &BackgroundWriter) -> Vec<Box<dyn Reporter>> {
    let host = host(args.annotations);
    let main: Box<dyn Reporter> = match args.format {
        Shown::Json => Box::new(EventStream::new(Box::new(outlet.for_stream()))),
        Shown::Tap => Box::new(TapStream::new(Box::new(outlet.for_stream()))),
        Shown::Console => {
            let console = Box::new(Console::over(outlet, console_options(args, folder)));
            match host {
                Annotations::Gitlab => {
                    Box::new(Sections::around(console, Box::new(outlet.clone())))
                }
                _ => console,
            }
        }
    };
    let mut shown = vec![main];
    if !matches!(args.format, Shown::Console) {
        shown.push(Box::new(FailureNotice));
    }
    if host == Annotations::Github {
        // GitHub reads both outputs; one of them may be data.
        shown.push(Box::new(AnnotationReporter::new(Box::new(|record| {
            annotate(&mut io::stderr(), record)
        }))));
    }
    shown
}

fn console_options(args: &RunArgs, folder: &Path) -> ConsoleOptions {
    ConsoleOptions {
        verbosity: if args.verbose { Verbosity::Verbose } else { Verbosity::Normal },
        folder: Some(folder.to_owned()),
        rerun: again::command(),
        ..ConsoleOptions::default()
    }
}

/// The end of what [`shown`] began, written by the guard when the runner died:
/// standard output may end in the middle of a line.
pub fn close(args: &RunArgs, journal: &Path, record: &Record) -> io::Result<()> {
    let mut out = io::stdout().lock();
    match args.format {
        Shown::Console => {}
        Shown::Json => {
            let text = std::fs::read_to_string(journal)?;
            writeln!(out, "\n{}", text.lines().next_back().unwrap_or_default())?;
        }
        Shown::Tap => {
            let reason = record.runner_death().unwrap_or("the runner died");
            writeln!(out, "\nBail out! {}", rtf_report::escape::line(reason))?;
        }
    }
    if host(args.annotations) == Annotations::Github {
        annotate(&mut io::stderr(), record)?;
    }
    out.flush()
}

fn annotate(out: &mut dyn Write, record: &Record) -> io::Result<()> {
    github::write(out, record, repository().as_deref())
}

/// The host that this is for: never [`Annotations::Auto`].
fn host(asked: Annotations) -> Annotations {
    let is_true = |name: &str| std::env::var_os(name).is_some_and(|value| value == "true");
    match asked {
        Annotations::Auto if is_true("GITHUB_ACTIONS") => Annotations::Github,
        Annotations::Auto if is_true("GITLAB_CI") => Annotations::Gitlab,
        Annotations::Auto => Annotations::None,
        asked => asked,
    }
}

/// The folder from which a code host names files: the checkout that it says it
/// made, else the repository around the current folder.
fn repository() -> Option<PathBuf> {
    let told = ["GITHUB_WORKSPACE", "CI_PROJECT_DIR"].into_iter().find_map(std::env::var_os);
    if let Some(told) = told.filter(|told| !told.is_empty()) {
        return Some(PathBuf::from(told));
    }
    let current = std::env::current_dir().ok()?;
    current.ancestors().find(|folder| folder.join(".git").exists()).map(Path::to_owned)
}
