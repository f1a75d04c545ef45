//! The functions that each kind of host implements.

use rtf_model::Location;
use rtf_model::protocol::{
    Initialize, Initialized, Plugin, Subscription, TestEndedParams, TestFinishedParams,
    TestReportedParams, TestStartedParams,
};

use crate::Session;

/// Whether a plug-in is loaded as a test or as a fixture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PluginKind {
    /// `setup`, `run`, `tearDown`.
    Test,
    /// `setup`, `check` as often as the runner asks, `tearDown`.
    Fixture,
}

/// One function of the loaded plug-in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// `setup`, with the arguments of [`Plugin::args`].
    Setup,
    /// `run` of a test.
    Run,
    /// `check` of a fixture. A plug-in without it is healthy.
    Check,
    TearDown,
}

impl Step {
    /// The function's name, as plug-ins spell it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Setup => "setup",
            Self::Run => "run",
            Self::Check => "check",
            Self::TearDown => "tearDown",
        }
    }
}

/// A notification to a fixture about a test.
#[derive(Clone, Copy, Debug)]
pub enum TestNotification<'a> {
    /// An attempt is about to start: `testStarted`.
    Started(&'a TestStartedParams),
    /// The process of an attempt has ended: `testEnded`.
    Ended(&'a TestEndedParams),
    /// An attempt has a verdict: `testFinished`.
    Finished(&'a TestFinishedParams),
}

impl TestNotification<'_> {
    /// The function's name, as plug-ins spell it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Started(_) => "testStarted",
            Self::Ended(_) => "testEnded",
            Self::Finished(_) => "testFinished",
        }
    }
}

/// How a function of the plug-in ended. The [`Session`] already has the messages that the
/// function reported.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepEnd {
    /// It returned.
    Done,
    /// It returned false.
    Refused,
    /// An assertion or an error that it reported, or a stop request, ended it.
    Stopped,
    /// An exception that is not the SDK's ended it: type and text, and the location if known.
    Broken(String, Option<Location>),
}

/// Why a plug-in could not be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadError {
    /// The loader's or interpreter's message.
    pub message: String,
    /// The location in the plug-in's source, if there is one.
    pub location: Option<Location>,
}

/// A host's immediate reaction to a notification of the runner. Called on the thread that
/// reads the channel, while the plug-in runs on another.
pub type Reaction = Box<dyn Fn(&Session) + Send>;

/// A host. All functions are called on the thread that called [`crate::serve()`].
pub trait HostPlugin {
    /// The host's name and version, and how it dumps stacks.
    fn describe(&self) -> Initialized;

    /// Called once, with the runner's first request, before anything is loaded.
    fn prepare(&mut self, _initialize: &Initialize) {}

    /// Called when the runner has started the host before there is a plug-in for it, and
    /// between tests that share the host, so that it can prepare for the most likely plug-in.
    fn idle(&mut self) {}

    /// Loads a plug-in. At most one is loaded at a time.
    ///
    /// # Errors
    /// The plug-in cannot be loaded; nothing is loaded then.
    fn load(&mut self, kind: PluginKind, plugin: &Plugin) -> Result<(), LoadError>;

    /// Calls a function of the loaded plug-in.
    fn step(&mut self, step: Step) -> StepEnd;

    /// The notifications that the loaded fixture subscribes to.
    fn subscriptions(&self) -> Vec<Subscription> {
        Vec::new()
    }

    /// Passes a report of a running test to the loaded fixture.
    fn reported(&mut self, _reported: TestReportedParams) {}

    /// Notifies the loaded fixture of a test.
    fn notify(&mut self, _notification: TestNotification<'_>) -> StepEnd {
        StepEnd::Done
    }

    /// Unloads the plug-in after its `tearDown`.
    fn unload(&mut self) -> StepEnd {
        StepEnd::Done
    }

    /// The reaction to `dump-stack`: send the plug-in's stack with [`Session::stack`].
    fn stack_dumper(&self) -> Option<Reaction> {
        None
    }

    /// The reaction to `interrupt`, for plug-ins that do not poll for it.
    fn stopper(&self) -> Option<Reaction> {
        None
    }

    /// The reaction to the end of the channel while a plug-in is loaded, before the process
    /// ends: what no other process would undo.
    fn closer(&self) -> Option<Reaction> {
        None
    }
}
