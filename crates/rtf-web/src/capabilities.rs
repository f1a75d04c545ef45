//! What a server can do beside showing runs, which is up to the program that it
//! is a part of.

use std::path::Path;
use std::sync::Arc;

use rtf_model::{SuiteId, TestId};

/// What a person may ask of the run that this process makes.
pub trait RunControl: Send + Sync {
    /// End the run as SIGINT does.
    fn stop_run(&self);
    /// Stop a test that runs.
    fn stop_test(&self, test: TestId);
    /// Skip the rest of a suite.
    fn skip_suite(&self, suite: SuiteId);
}

/// What starts runs of the results folder again, one at a time.
pub trait RunStarter: Send + Sync {
    /// Starts the failed tests of a run again; the name of the new run. Takes
    /// until its journal is there.
    ///
    /// # Errors
    /// Why it was not started.
    fn rerun_failed(&self, run: &FinishedRun<'_>) -> Result<String, RerunRejected>;

    /// The name of the run that was started and still goes on.
    fn started(&self) -> Option<String>;

    /// End this run as SIGINT does.
    fn stop(&self);
}

/// A run of the results folder that is over.
#[derive(Clone, Copy, Debug)]
pub struct FinishedRun<'a> {
    /// Its name.
    pub name: &'a str,
    /// The folder in which its command was given.
    pub folder: &'a Path,
}

/// Why a run was not started.
#[derive(Debug)]
pub struct RerunRejected {
    /// Why, in words.
    pub reason: String,
    /// What to do about it.
    pub hint: Option<String>,
}

/// What a server can do beside showing runs.
#[derive(Clone)]
pub enum Capabilities {
    /// It is a part of the process that makes this run.
    Runner(String, Arc<dyn RunControl>),
    /// It shows what others made, and starts some of it again.
    Viewer(Arc<dyn RunStarter>),
}

impl Capabilities {
    /// The run that this process makes.
    #[must_use]
    pub fn own(&self) -> Option<&str> {
        match self {
            Self::Runner(run, _) => Some(run),
            Self::Viewer(_) => None,
        }
    }

    /// The run that can be stopped here.
    #[must_use]
    pub fn controlled(&self) -> Option<String> {
        match self {
            Self::Runner(run, _) => Some(run.clone()),
            Self::Viewer(starter) => starter.started(),
        }
    }
}
