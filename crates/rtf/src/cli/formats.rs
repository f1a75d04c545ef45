//! The forms in which a run is told.

use std::path::PathBuf;

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// A report's format.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Plain text.
    Text,
    /// JUnit XML.
    Junit,
    /// TAP 14.
    Tap,
    /// GitLab's code quality JSON.
    CodeQuality,
    /// Workflow commands of GitHub Actions.
    Github,
    /// The event stream.
    Json,
}

/// What `--report` takes: reports that are made when the run is over.
const REPORTS: [(&str, Format); 5] = [
    ("junit", Format::Junit),
    ("text", Format::Text),
    ("tap", Format::Tap),
    ("code-quality", Format::CodeQuality),
    ("github", Format::Github),
];

/// What standard output has of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Shown {
    /// What happens, in words
    #[default]
    Console,
    /// The events, one a line, as in the journal
    Json,
    /// TAP 14
    Tap,
}

/// What a code host is told in its own words.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Annotations {
    /// As the host that runs this job understands it
    #[default]
    Auto,
    /// Workflow commands, which mark places in the change
    Github,
    /// Sections of the job's log
    Gitlab,
    /// Nothing
    None,
}

/// The parser of `rtf report --format`.
pub fn format_parser() -> impl TypedValueParser<Value = Format> {
    let names = REPORTS.map(|(name, _)| name).into_iter().chain(["json"]);
    PossibleValuesParser::new(names).map(|name| report_format(&name).unwrap_or(Format::Json))
}

fn report_format(name: &str) -> Option<Format> {
    REPORTS.iter().find(|(known, _)| *known == name).map(|(_, format)| *format)
}

/// Reads `junit=PATH`.
///
/// # Errors
/// What is wrong with it.
pub fn parse_report(value: &str) -> Result<(Format, PathBuf), String> {
    let names = REPORTS.map(|(name, _)| format!("`{name}=PATH`")).join(", ");
    let expected = format!("expected {names}");
    let (name, path) = value.split_once('=').ok_or(expected.as_str())?;
    let format =
        report_format(name).ok_or_else(|| format!("unknown format `{name}`, {expected}"))?;
    if path.is_empty() {
        return Err(format!("the path is missing, {expected}"));
    }
    Ok((format, PathBuf::from(path)))
}

#[cfg(test)]
mod tests {
    /// An `rtf.toml` takes what the command line takes.
    #[test]
    fn the_formats_of_a_configuration_are_those_of_the_command_line() {
        assert_eq!(super::REPORTS.map(|(name, _)| name), rtf_plan::config::REPORTS);
    }
}
