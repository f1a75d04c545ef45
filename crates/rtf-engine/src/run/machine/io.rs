//! The inputs and effects of the state machine.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::{OWNER_VARIABLE, Plugin, Request, StackSupport};
use rtf_model::{Episode, EventKind, Source, TestId};

use rtf_plan::plan::{HostPlan, ProbePlans, ProcessPlan, SuitePlan};

use crate::fixture_values::FixtureValues;

pub use crate::control::{QuestionReply, Stop, StopLevel};
pub use rtf_process::probe::ProbeSelection;
pub use rtf_process::task::{HostId, ProcessEvent};
pub use rtf_process::tree::SignalReach;

#[derive(Debug)]
pub enum Input {
    /// The suite starts; once. Only `Stop` and `Skip` may come earlier.
    Start,
    Host(HostId, ProcessEvent),
    /// A deadline has passed.
    Deadline(Deadline),
    /// A reading of the suite's simulated clock.
    Clock(Duration),
    /// The suite must end early.
    Stop(Stop),
    /// A user stops this test, if it runs; the user's name.
    StopTest(TestId, String),
    /// An operator answers a question of a test, or declines to.
    Answer(TestId, QuestionReply),
    /// A user skips the rest of the suite; the user's name.
    Skip(String),
    /// A further episode of a stream; `None` at its end.
    Episode(Option<Episode>),
}

/// A timer of the machine. Setting it again moves it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Deadline {
    /// The suite's `timeout`.
    Suite,
    /// The limit of a stop request.
    Shutdown,
    Test(TestId, TestTimer),
    /// A timer of a fixture, by its index in the suite's plan.
    Fixture(usize, FixtureTimer),
    /// The delay of a retry.
    Retry(TestId),
    /// The limit of the running hook, or of a step that stops it.
    Hook,
    /// The end of an idle shared host that was killed.
    SharedHost,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum TestTimer {
    /// The limit of the phase, or of a step that stops it.
    Limit,
    /// From then on, it counts as slow.
    Slow,
    /// The end of the question with this number.
    Question(u32),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum FixtureTimer {
    /// The limit of set-up or tear-down, or of a step that stops it.
    Limit,
    /// The limit of `check` or an examination.
    Check,
    /// The limit of `test-started` or `test-finished`.
    Notification,
    /// The interval of `check`.
    CheckDue,
    /// The limit of `<reset>`.
    Reset,
    /// The delay of a restart.
    RestartDue,
    /// The limit for the end of its dying process.
    Death,
    /// The interval at which a line that has no end yet is searched.
    UnfinishedLine,
}

#[derive(Clone, Debug)]
pub struct StartRequest {
    pub what: Program,
    /// Environment variables; later ones win.
    pub env: Vec<(String, String)>,
    /// Its working directory.
    pub folder: PathBuf,
}

/// The environment of a process: variables of the suite, of the process, and its owner.
pub(super) fn environment(
    suite: &SuitePlan,
    own: &[(String, String)],
    (kind, name): (&str, &str),
    values: &FixtureValues,
) -> Vec<(String, String)> {
    let owner = (OWNER_VARIABLE.to_owned(), format!("{kind} {}/{name}", suite.name));
    let mut env: Vec<_> = suite.env.iter().chain(own).cloned().collect();
    values.extend_env(&mut env);
    env.push(owner);
    env
}

#[derive(Clone, Debug)]
pub enum Program {
    /// A host with a channel.
    Host(Arc<HostPlan>),
    /// A process fixture, with its probes.
    Process(Arc<ProcessPlan>),
    /// Nothing: an attached fixture is only monitored. Monitoring ends when its channel is
    /// closed, or it is signalled or killed.
    Attached(Arc<ProbePlans>),
    /// A command, without a channel.
    Command(Vec<String>),
}

/// An action for the task of the suite.
#[derive(Debug)]
pub enum Effect {
    Spawn {
        /// The id of the new process.
        host: HostId,
        /// Its owner.
        source: Source,
        start: StartRequest,
    },
    /// Assign a further test to a shared host.
    Join {
        /// The host's id from the begin of that test.
        host: HostId,
        /// The host's id until then.
        on: HostId,
        /// The test.
        source: Source,
        /// The number of the request.
        request: u64,
        plugin: Box<Plugin>,
    },
    /// Start these hosts ahead, for later `Spawn`s of the same. Hosts that were started
    /// ahead and are not in this list are no longer needed.
    SpawnAhead(Vec<StartRequest>),
    /// Send a request or a notification.
    Send(HostId, Option<u64>, Box<Request>),
    /// Close the channel: the host ends after the present request.
    CloseChannel(HostId),
    /// Take a stack dump, with a debugger if the host has not sent a `stack` notification in
    /// this time. Answered by [`ProcessEvent::StackDumped`] or that notification.
    DumpStack(HostId, StackSupport, Duration),
    /// Send a signal to the process and its group, or to more of its tree.
    Signal(HostId, i32, SignalReach),
    /// Kill the process and all descendants.
    KillTree(HostId),
    /// Run the `alive` probes of a fixture periodically from now on.
    WatchAlive(HostId),
    /// Check whether the process is alive and its `alive` probes succeed. Answered by
    /// [`ProcessEvent::Alive`], [`ProcessEvent::Dying`], [`ProcessEvent::ProbeFailed`] or its end.
    CheckAlive(HostId, ProbeSelection),
    /// Set a deadline, as a time of the run.
    SetDeadline(Deadline, Duration),
    ClearDeadline(Deadline),
    /// An operator is asked: the limit and the `slow` limit of the test are paused.
    PauseLimits(TestId),
    ResumeLimits(TestId),
    /// Keep these values of fixtures for hooks that the guard runs.
    KeepValues(Box<FixtureValues>),
    Emit(EventKind),
    /// The suite has finished. The last effect.
    Done,
}
