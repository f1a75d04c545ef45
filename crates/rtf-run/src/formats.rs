//! The formats of what a run prints and writes.

use std::fmt;
use std::path::PathBuf;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReportFormat {
    /// Plain text.
    Text,
    /// JUnit XML.
    Junit,
    Tap,
    /// GitLab's code quality JSON.
    CodeQuality,
    /// Workflow commands of GitHub Actions.
    Github,
    /// A summary in Markdown.
    Markdown,
    /// The page with the run's data, in one file.
    Html,
    /// A trace of OpenTelemetry.
    Otlp,
    /// The event stream.
    Json,
}

/// Where a report goes.
#[derive(Clone, PartialEq, Eq)]
pub enum ReportTarget {
    File(PathBuf),
    /// The address of a collector, which may contain a password.
    Collector(String),
}

impl fmt::Debug for ReportTarget {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::File(path) => f.debug_tuple("File").field(path).finish(),
            Self::Collector(_) => f.debug_tuple("Collector").finish_non_exhaustive(),
        }
    }
}

/// The formats of `--report`, whose reports are written when the run has ended.
pub const REPORTS: [(&str, ReportFormat); 8] = [
    ("junit", ReportFormat::Junit),
    ("text", ReportFormat::Text),
    ("tap", ReportFormat::Tap),
    ("code-quality", ReportFormat::CodeQuality),
    ("github", ReportFormat::Github),
    ("markdown", ReportFormat::Markdown),
    ("html", ReportFormat::Html),
    ("otlp", ReportFormat::Otlp),
];

/// The format of standard output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutputFormat {
    /// Text for people.
    Console,
    /// The event stream, one event per line, as in the journal.
    Json,
    Tap,
}

/// For which code host annotations are printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Annotations {
    /// Workflow commands, which mark lines in the change.
    Github,
    /// Collapsible sections of the job log.
    Gitlab,
    None,
}

/// The format with a name, unless it is `json`.
pub fn report_format(name: &str) -> Option<ReportFormat> {
    REPORTS.iter().find(|(known, _)| *known == name).map(|(_, format)| *format)
}

/// Parses `junit=PATH` or `otlp=URL`.
///
/// # Errors
/// The format is unknown, or the path is missing.
pub fn parse_report(value: &str) -> Result<(ReportFormat, ReportTarget), String> {
    let names = REPORTS.map(|(name, _)| format!("`{name}=PATH`")).join(", ");
    let expected = format!("expected {names}");
    let (name, path) = value.split_once('=').ok_or(expected.as_str())?;
    let format =
        report_format(name).ok_or_else(|| format!("unknown format `{name}`, {expected}"))?;
    if path.is_empty() {
        return Err(format!("the path is missing, {expected}"));
    }
    let target = match format {
        ReportFormat::Otlp if path.contains("://") => ReportTarget::Collector(path.to_owned()),
        _ => ReportTarget::File(PathBuf::from(path)),
    };
    Ok((format, target))
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_formats_of_a_configuration_are_those_of_the_command_line() {
        assert_eq!(super::REPORTS.map(|(name, _)| name), rtf_plan::config::REPORTS);
    }
}
