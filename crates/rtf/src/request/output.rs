//! What a run prints and writes, and where its results go.

use std::path::PathBuf;

use rtf_run::collector::Collector;
use rtf_run::error::Failure;
use rtf_run::finish::ResultTargets;
use rtf_run::formats::{self, OutputFormat, ReportFormat, ReportTarget};
use rtf_run::request::OutputRequest;

use crate::cli::{Annotations, RunArgs, StdoutFormat};

/// What `rtf run` prints and writes.
///
/// A session with a debugger has no progress bar: the test may have the terminal.
pub fn output(args: &RunArgs, is_debugged: bool) -> OutputRequest {
    OutputRequest {
        format: match args.format {
            StdoutFormat::Console => OutputFormat::Console,
            StdoutFormat::Json => OutputFormat::Json,
            StdoutFormat::Tap => OutputFormat::Tap,
        },
        verbose: args.verbose,
        annotations: annotations(args.annotations),
        reports: args.reports.iter().filter_map(report_file).collect(),
        results: args.input.results.results.clone(),
        progress: !is_debugged,
    }
}

fn report_file((format, target): &(ReportFormat, ReportTarget)) -> Option<(ReportFormat, PathBuf)> {
    match target {
        ReportTarget::File(path) => Some((*format, path.clone())),
        ReportTarget::Collector(_) => None,
    }
}

/// Where the results of a run go. A session with a debugger says nothing about the test.
pub fn targets(args: &RunArgs, is_debugged: bool) -> Result<ResultTargets, Failure> {
    let addresses = args.reports.iter().filter_map(|(_, target)| match target {
        ReportTarget::File(_) => None,
        ReportTarget::Collector(address) => Some(address),
    });
    let no_history = args.no_history || is_debugged;
    Ok(ResultTargets {
        history: super::target(no_history, &args.input.history, &args.input.results)?,
        collectors: addresses
            .map(|address| Collector::resolve(address))
            .collect::<Result<_, _>>()?,
    })
}

/// The code host for which annotations are printed, which may be found in the environment.
fn annotations(option: Annotations) -> formats::Annotations {
    let is_true = |name: &str| std::env::var_os(name).is_some_and(|value| value == "true");
    match option {
        Annotations::Github => formats::Annotations::Github,
        Annotations::Gitlab => formats::Annotations::Gitlab,
        Annotations::Auto if is_true("GITHUB_ACTIONS") => formats::Annotations::Github,
        Annotations::Auto if is_true("GITLAB_CI") => formats::Annotations::Gitlab,
        Annotations::Auto | Annotations::None => formats::Annotations::None,
    }
}
