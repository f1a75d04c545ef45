//! Reports of a run, in every format.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use rtf_model::Record;
use rtf_report::markdown::{self, MarkdownOptions};
use rtf_report::run_dir::JOURNAL;
use rtf_report::{ReportError, ReportFile, Reporter, code_quality, github, junit, otlp, tap, text};
use rtf_web::html_report::{self, ReportSource};

use crate::error::Failure;
use crate::formats::ReportFormat;
use crate::rerun_command;

/// Opens the reports of a run in `results`. They are written when the run has
/// finished, but this function finds out whether that is possible.
pub fn open_all(
    reports: &[(ReportFormat, PathBuf)],
    results: &Path,
) -> Result<Vec<ReportFile>, Failure> {
    let failure = |error: Box<dyn std::error::Error + Send + Sync>| {
        Failure::input(error).hint("choose another path with `--report FORMAT=PATH`")
    };
    let mut opened = Vec::new();
    for (index, (format, path)) in reports.iter().enumerate() {
        if reports[..index].iter().any(|(_, earlier)| earlier == path) {
            let error = format!("two reports would be written to `{}`", path.display());
            return Err(failure(error.into()));
        }
        check_build(*format)?;
        opened.push(open(*format, path, results).map_err(|error| failure(error.into()))?);
    }
    Ok(opened)
}

/// Opens a report of a run in `results`.
pub fn open(format: ReportFormat, path: &Path, results: &Path) -> Result<ReportFile, ReportError> {
    let (results, output) = (results.to_owned(), path.to_owned());
    let write = move |out: &mut dyn Write, record: &Record| {
        let dir = record.run.as_ref().map(|started| results.join(&started.run));
        let journal = dir.as_ref().map(|dir| dir.join(JOURNAL));
        let journal = journal.as_deref();
        write(format, out, record, &Place { journal, output: Some(&output), url: None })
    };
    ReportFile::new(title(format), path, Box::new(write))
}

/// Checks that this build can write reports of this format.
pub fn check_build(format: ReportFormat) -> Result<(), Failure> {
    if format != ReportFormat::Html || html_report::is_available() {
        return Ok(());
    }
    let hint = "run `make web` in the sources of rtf, then build it again";
    Err(Failure::input("this build of rtf has no page for the HTML report").hint(hint))
}

/// Writes an open report.
pub fn finish(report: Result<impl Reporter, ReportError>, record: &Record) {
    if let Err(error) = report.and_then(|mut report| report.finish(record)) {
        Failure::internal(error).print();
    }
}

/// Where the results of a run are.
#[derive(Clone, Copy, Debug, Default)]
pub struct Place<'a> {
    /// The journal, in the run directory.
    pub journal: Option<&'a Path>,
    /// The report's file; `None`: standard output.
    pub output: Option<&'a Path>,
    /// The address of the results on the web, for links.
    pub url: Option<&'a str>,
}

impl<'a> Place<'a> {
    /// The run directory.
    fn dir(&self) -> Option<&'a Path> {
        self.journal.and_then(Path::parent)
    }
}

/// Writes a report.
pub fn write(
    format: ReportFormat,
    out: &mut dyn Write,
    record: &Record,
    place: &Place<'_>,
) -> io::Result<()> {
    match format {
        ReportFormat::Text => text::write(out, record),
        ReportFormat::Junit => junit::write(out, record, place.dir()),
        ReportFormat::Tap => tap::write(out, record),
        ReportFormat::CodeQuality => code_quality::write(out, record, repository().as_deref()),
        ReportFormat::Github => github::write(out, record, repository().as_deref()),
        ReportFormat::Markdown => markdown::write(
            out,
            record,
            &MarkdownOptions {
                repository: repository().as_deref(),
                dir: place.dir(),
                url: place.url,
                commands: rerun_command::for_tests(),
            },
        ),
        ReportFormat::Otlp => otlp::write(out, record),
        ReportFormat::Html => {
            let missing = || io::Error::other("the run has no journal");
            let journal = place.journal.ok_or_else(missing)?;
            let (commands, output, dir) = (&rerun_command::for_tests(), place.output, place.dir());
            html_report::write(out, &ReportSource { journal, output, commands, dir })
        }
        ReportFormat::Json => Err(io::Error::other("a record contains no events")),
    }
}

/// The name of a report in errors.
pub fn title(format: ReportFormat) -> &'static str {
    match format {
        ReportFormat::Text => "the text report",
        ReportFormat::Junit => "the JUnit report",
        ReportFormat::Tap => "the TAP report",
        ReportFormat::CodeQuality => "the code quality report",
        ReportFormat::Github => "the annotations",
        ReportFormat::Markdown => "the Markdown summary",
        ReportFormat::Html => "the HTML report",
        ReportFormat::Otlp => "the trace",
        ReportFormat::Json => "the events",
    }
}

/// The directory to which code hosts' file names are relative: their checkout, or else
/// the repository that contains the current directory.
fn repository() -> Option<PathBuf> {
    let checkout = ["GITHUB_WORKSPACE", "CI_PROJECT_DIR"].into_iter().find_map(std::env::var_os);
    if let Some(checkout) = checkout.filter(|dir| !dir.is_empty()) {
        return Some(PathBuf::from(checkout));
    }
    let current = std::env::current_dir().ok()?;
    current.ancestors().find(|dir| dir.join(".git").exists()).map(Path::to_owned)
}
