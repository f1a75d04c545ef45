//! What a host has to be able to do.

use rtf_model::Location;
use rtf_model::protocol::{
    Initialize, Initialized, Plugin, Subscription, TestFinishedParams, TestStartedParams,
};

use crate::Session;

/// As what a plug-in is loaded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// As a test: `setup`, `run`, `tearDown`.
    Test,
    /// As a fixture: `setup`, `check` as often as the runner asks, `tearDown`.
    Fixture,
}

/// One function of the loaded plug-in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Step {
    /// `setup`, with the arguments of [`Plugin::args`].
    Setup,
    /// `run` of a test.
    Run,
    /// `check` of a fixture. A plug-in that has none is well.
    Check,
    /// `tearDown`.
    TearDown,
}

/// What a fixture is told of a test.
#[derive(Clone, Copy, Debug)]
pub enum Told<'a> {
    /// An attempt is about to begin: `testStarted`.
    Starts(&'a TestStartedParams),
    /// An attempt was judged: `testFinished`.
    Ends(&'a TestFinishedParams),
}

impl Told<'_> {
    /// The function's name, as plug-ins spell it.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Starts(_) => "testStarted",
            Self::Ends(_) => "testFinished",
        }
    }
}

/// How a function of the plug-in ended. What it reported meanwhile has gone
/// through the [`Session`], which knows about failures and errors by itself.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum StepEnd {
    /// It returned.
    Done,
    /// It returned false.
    Refused,
    /// An assertion or an error that it reported stopped it, or it unwound
    /// because it was asked to stop.
    Stopped,
    /// It ended in a way that is not the SDK's: an exception, with its type
    /// and text, and the place where it came from if that is known.
    Broken(String, Option<Location>),
}

/// Why a plug-in could not be loaded.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LoadError {
    /// What is wrong, with the loader's or interpreter's own words.
    pub message: String,
    /// Where, when it is a place in the plug-in's source.
    pub location: Option<Location>,
}

/// What a host does at once when the runner tells it something. Called on the
/// thread that reads the channel, while the plug-in runs on another.
pub type Reaction = Box<dyn Fn(&Session) + Send>;

/// A host. All functions are called on the thread that called [`crate::serve()`].
pub trait HostPlugin {
    /// The host's name and version, and how it dumps stacks.
    fn describe(&self) -> Initialized;

    /// Called once, with the runner's first request, before anything is loaded.
    fn prepare(&mut self, _initialize: &Initialize) {}

    /// Called when the runner has started the host before there is a plug-in for
    /// it: time to get ready for the likely one.
    fn idle(&mut self) {}

    /// Loads a plug-in. At most one is loaded at a time.
    ///
    /// # Errors
    /// The plug-in cannot be loaded; nothing is loaded then.
    fn load(&mut self, role: Role, plugin: &Plugin) -> Result<(), LoadError>;

    /// Calls a function of the loaded plug-in.
    fn step(&mut self, step: Step) -> StepEnd;

    /// What the loaded fixture, which is set up, wants to be told of each test.
    fn subscriptions(&self) -> Vec<Subscription> {
        Vec::new()
    }

    /// Tells the loaded fixture of a test.
    fn tell(&mut self, _told: Told<'_>) -> StepEnd {
        StepEnd::Done
    }

    /// Forgets the loaded plug-in after its `tearDown`.
    fn unload(&mut self) -> StepEnd {
        StepEnd::Done
    }

    /// What to do when the runner sends `dump-stack`: tell where the plug-in is,
    /// by [`Session::stack`].
    fn stack_dumper(&self) -> Option<Reaction> {
        None
    }

    /// What to do when the plug-in was asked to stop and may not notice.
    fn stopper(&self) -> Option<Reaction> {
        None
    }
}
