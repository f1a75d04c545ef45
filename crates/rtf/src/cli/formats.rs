//! Output formats of a run.

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use rtf_run::formats::{REPORTS, ReportFormat, report_format};

/// The format of standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum StdoutFormat {
    /// Text for people
    #[default]
    Console,
    /// The event stream, one event per line, as in the journal
    Json,
    /// TAP 14
    Tap,
}

/// The code host to print annotations for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Annotations {
    /// The code host that runs this job, if any
    #[default]
    Auto,
    /// Workflow commands, which mark lines in the change
    Github,
    /// Collapsible sections of the job log
    Gitlab,
    /// No annotations
    None,
}

/// The parser of `rtf report --format`.
pub fn format_parser() -> impl TypedValueParser<Value = ReportFormat> {
    let names = REPORTS.map(|(name, _)| name).into_iter().chain(["json"]);
    PossibleValuesParser::new(names).map(|name| report_format(&name).unwrap_or(ReportFormat::Json))
}
