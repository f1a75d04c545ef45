//! How much the console tells, and what it must be told.

use std::path::{Path, PathBuf};

use rtf_model::{Record, TestId};

use crate::{escape, words};

/// How much is told while the run goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verbosity {
    /// Only what did not go well.
    Quiet,
    /// Each suite, test and fixture.
    #[default]
    Normal,
    /// Also each message, measurement, and what the processes print.
    Verbose,
}

/// Returns the command that runs a test again, `None` when there is none.
pub type RerunCommand = Box<dyn Fn(&Record, TestId) -> Option<String> + Send>;

/// How the console behaves.
pub struct ConsoleOptions {
    /// How much is told while the run goes on.
    pub verbosity: Verbosity,
    /// The run's folder as it is shown; logs are named below it. `None` when
    /// nothing is kept.
    pub folder: Option<PathBuf>,
    /// Whether a progress bar is shown where standard error is a terminal.
    pub progress: bool,
    /// Which command runs a failed test again.
    pub rerun: RerunCommand,
}

impl ConsoleOptions {
    /// A file or folder below the run's folder, as it is shown.
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
        }
    }
}

/// `rtf run SUITE::TEST`, or `rtf run PLUGIN` for a plug-in given on the command line.
#[must_use]
pub fn rerun_suite(record: &Record, test: TestId) -> Option<String> {
    let test = record.tests.get(test.index())?;
    let suite = record.suites.get(test.plan.suite.index())?;
    let what = if suite.plan.file.is_empty() {
        test.plan.plugin.clone()
    } else {
        format!("{}::{}", suite.plan.file, test.plan.name)
    };
    (!what.is_empty()).then(|| format!("rtf run {}", words::quoted(&what)))
}
