//! What a server can do in addition to showing runs. The program that contains the
//! server implements it.

use std::path::Path;
use std::sync::Arc;

use rtf_model::{Respondent, SuiteId, TestId};

/// Controls the run of this process.
pub trait RunControl: Send + Sync {
    /// End the run as SIGINT does.
    fn stop_run(&self);
    fn stop_test(&self, test: TestId);
    /// Skip the rest of a suite.
    fn skip_suite(&self, suite: SuiteId);
    fn answer(&self, answer: AnswerRequest);
}

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AnswerRequest {
    pub test: TestId,
    pub question: u32,
    pub answer: String,
    pub by: Respondent,
}

/// Reruns runs of the results directory, one at a time.
pub trait RunStarter: Send + Sync {
    /// Reruns the failed tests of a run; returns the name of the new run once
    /// its journal exists.
    ///
    /// # Errors
    /// Why it was not started.
    fn rerun_failed(&self, run: &FinishedRun<'_>) -> Result<String, RerunRejected>;

    /// The name of the rerun that is in progress.
    fn started(&self) -> Option<String>;

    /// End this run as SIGINT does.
    fn stop(&self);
}

/// A finished run of the results directory.
#[derive(Clone, Copy, Debug)]
pub struct FinishedRun<'a> {
    pub name: &'a str,
    /// The directory in which it was started.
    pub folder: &'a Path,
}

/// Why a run was not started.
#[derive(Debug)]
pub struct RerunRejected {
    pub reason: String,
    pub hint: Option<String>,
}

/// What a server can do in addition to showing runs.
#[derive(Clone)]
pub enum Capabilities {
    /// It is part of the process that runs this run, which it controls.
    Runner(String, Arc<dyn RunControl>),
    /// It shows the runs of other processes, and can rerun their failed tests.
    Viewer(Arc<dyn RunStarter>),
}

impl Capabilities {
    /// The run of this process.
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
