//! Options of the console.

use std::path::{Path, PathBuf};

use rtf_model::{Record, TestId};

use crate::{escape, words};

/// How much is shown during the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verbosity {
    /// Only problems.
    Quiet,
    /// Each suite, test and fixture.
    #[default]
    Normal,
    /// Also each message, measurement, and line of output.
    Verbose,
}

/// Returns the command that reruns a test, or only its case with this path; `None` if
/// there is none.
pub type RerunCommand = Box<dyn Fn(&Record, TestId, Option<&str>) -> Option<String> + Send>;

/// Returns the command that runs a test with a recording of it in place of the live source;
/// the path is that of the recording. `None` if there is no suite for that.
pub type ReplayCommand = Box<dyn Fn(&Record, TestId, &Path) -> Option<String> + Send>;

pub struct TestCommands {
    pub rerun: RerunCommand,
    pub replay: ReplayCommand,
}

impl TestCommands {
    /// Only commands that rerun tests.
    #[must_use]
    pub fn without_replay(rerun: RerunCommand) -> Self {
        Self { rerun, replay: Box::new(|_, _, _| None) }
    }
}

pub struct ConsoleOptions {
    pub verbosity: Verbosity,
    /// The run's directory for display; it contains the logs. `None` if
    /// nothing is kept.
    pub folder: Option<PathBuf>,
    /// Whether a progress bar is shown if standard error is a terminal.
    pub progress: bool,
    pub rerun: RerunCommand,
    pub replay: ReplayCommand,
}

impl ConsoleOptions {
    /// The advice that shows what a console that is not verbose leaves out.
    pub(super) fn everything(&self) -> Option<String> {
        let how = match &self.folder {
            Some(dir) => format!("rtf show --verbose {}", words::quoted(&dir.to_string_lossy())),
            None => "--verbose".to_owned(),
        };
        (self.verbosity < Verbosity::Verbose).then(|| format!("`{}` shows all", escape::line(&how)))
    }

    /// A path in the run's directory, for display.
    pub(super) fn shown(&self, path: &Path) -> Option<String> {
        let path = self.folder.as_ref()?.join(path);
        Some(escape::line(&path.display().to_string()).into_owned())
    }
}

impl Default for ConsoleOptions {
    fn default() -> Self {
        Self {
            verbosity: Verbosity::default(),
            folder: None,
            progress: true,
            rerun: Box::new(rerun_suite),
            replay: Box::new(|_, _, _| None),
        }
    }
}

/// The options, and the run that is shown.
#[derive(Clone, Copy)]
pub(super) struct View<'a> {
    pub options: &'a ConsoleOptions,
    pub record: &'a Record,
}

/// `rtf run SUITE::TEST` or `rtf run SUITE::TEST/CASE`, or `rtf run PLUGIN` for a plug-in
/// given on the command line.
#[must_use]
pub fn rerun_suite(record: &Record, test: TestId, case: Option<&str>) -> Option<String> {
    let test = record.tests.get(test.index())?;
    let suite = record.suites.get(test.plan.suite.index())?;
    let what = match case {
        _ if suite.plan.file.is_empty() => test.plan.plugin.clone(),
        None => format!("{}::{}", suite.plan.file, test.plan.name),
        Some(case) => format!("{}::{}/{case}", suite.plan.file, test.plan.name),
    };
    (!what.is_empty()).then(|| format!("rtf run {}", words::quoted(&what)))
}
