//! What goes into the state machine and what comes out of it.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::{OWNER_VARIABLE, Plugin, Request, StackSupport};
use rtf_model::{EventKind, Source, TestId};

use rtf_plan::plan::{AttachedPlan, HostPlan, ProcessPlan, SuitePlan};

pub use rtf_process::probe::ProbeSelection as Probes;
pub use rtf_process::task::{HostId, ProcessEvent as HostInput};

/// What happened.
#[derive(Debug)]
pub enum Input {
    /// Begin. The first input, and given once.
    Start,
    /// Something about a process.
    Host(HostId, HostInput),
    /// A deadline that was set has passed.
    Deadline(Deadline),
    /// The clock that the suite follows shows this time.
    Clock(Duration),
    /// The suite must end early.
    Stop(Stop),
    /// This test is to be stopped, if it runs: by whom.
    StopTest(TestId, String),
    /// The rest of the suite is to be skipped: by whom.
    Skip(String),
}

/// How quickly a suite must end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StopLevel {
    /// Stop the test, tear down.
    TearDown,
    /// Kill everything now, without tear-down; hooks run.
    Kill,
    /// Kill the hooks, too.
    KillHooks,
}

/// A request to end the suite early.
#[derive(Clone, Debug)]
pub struct Stop {
    /// How quickly.
    pub level: StopLevel,
    /// Why, in words: `SIGINT`.
    pub reason: String,
    /// How long it may take until it is over, tear-downs and hooks included.
    /// Then it goes on as with [`StopLevel::Kill`].
    pub limit: Duration,
}

/// A point in time that the machine waits for. Setting it again moves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Deadline {
    /// The suite's own limit.
    Suite,
    /// The limit of its end after a stop request.
    Shutdown,
    /// About a test that runs.
    Test(TestId, TestTimer),
    /// About the fixture at this place of the suite's plan.
    Fixture(usize, FixtureTimer),
    /// The next attempt of this test, which failed.
    Retry(TestId),
    /// The limit of the running hook, or of a step of its stop.
    Hook,
    /// The end of a shared host that was killed while it had no test.
    SharedHost,
}

/// What is waited for in a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TestTimer {
    /// The end of the phase, or of the step of its stop.
    Limit,
    /// The moment from which it counts as slow.
    Slow,
}

/// What is waited for in a fixture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FixtureTimer {
    /// The end of set-up or tear-down, or of a step of its stop.
    Limit,
    /// The answer to `check`, and whether its process lives.
    Check,
    /// The answer to `test-started` or `test-finished`.
    Notice,
    /// The next `check`.
    CheckDue,
    /// The next restart.
    RestartDue,
    /// The end of its process, which is dying.
    Death,
}

/// How to start a process.
#[derive(Clone, Debug)]
pub struct Start {
    /// What to start.
    pub what: Program,
    /// Environment variables, later ones win.
    pub env: Vec<(String, String)>,
    /// Its working folder.
    pub folder: PathBuf,
}

/// The environment variables of a process: the suite's, its own, and whose it is.
pub(super) fn environment(
    suite: &SuitePlan,
    own: &[(String, String)],
    kind: &str,
    name: &str,
) -> Vec<(String, String)> {
    let owner = (OWNER_VARIABLE.to_owned(), format!("{kind} {}/{name}", suite.name));
    suite.env.iter().chain(own).cloned().chain([owner]).collect()
}

/// What to start.
#[derive(Clone, Debug)]
pub enum Program {
    /// A host with a channel.
    Host(Arc<HostPlan>),
    /// A process fixture, with its probes.
    Process(Arc<ProcessPlan>),
    /// Nothing: what runs already is watched. It "ends" when its channel is
    /// closed, or it is signalled or killed.
    Attached(Arc<AttachedPlan>),
    /// A command, without a channel.
    Command(Vec<String>),
}

/// What is to be done.
#[derive(Debug)]
pub enum Effect {
    /// Start a process.
    Spawn {
        /// Its id from now on.
        host: HostId,
        /// Whose it is.
        source: Source,
        /// How.
        start: Start,
    },
    /// A host serves a further test, under an id of its own.
    Join {
        /// Its id from the beginning of that test on.
        host: HostId,
        /// Its id until then.
        on: HostId,
        /// The test.
        source: Source,
        /// The number of the request.
        request: u64,
        /// The request.
        plugin: Plugin,
    },
    /// Hosts like these will be needed next, in this order: start them while
    /// tests run. They are used when a later `Spawn` asks for the same. What was
    /// started ahead and is not in this list is not needed any more.
    SpawnAhead(Vec<Start>),
    /// Send a request or a notification.
    Send(HostId, Option<u64>, Request),
    /// No request will follow: the host ends when it is done.
    CloseChannel(HostId),
    /// Ask for a stack dump; answered by [`HostInput::StackTaken`] or a
    /// `stack` notification.
    TakeStack(HostId, StackSupport),
    /// Send a signal to the process and its group.
    Signal(HostId, i32),
    /// Kill the process and everything below it.
    KillTree(HostId),
    /// Ask the `alive` probes of a process fixture from now on.
    WatchAlive(HostId),
    /// Look whether the process lives and its `alive` probes hold: all of them, or those
    /// that are answered without starting a program. Answered by [`HostInput::Lives`],
    /// [`HostInput::Dies`] or [`HostInput::ProbeFailed`], or by its end.
    LookAlive(HostId, Probes),
    /// Wait for a moment, in the time of `now`.
    SetDeadline(Deadline, Duration),
    /// Do not wait for it any more.
    ClearDeadline(Deadline),
    /// Something to report.
    Emit(EventKind),
    /// The suite is over. Nothing follows.
    Done,
}
