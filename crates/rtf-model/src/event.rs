//! The events of a run, as owned and serialisable values.
//!
//! [`crate::OrderChecker`] checks the order of events; `spec/events.md`
//! describes it.

mod case;
mod episode;
mod expected;
mod learned;
mod planned;
mod process;
mod provided;
mod test;

use serde::{Deserialize, Serialize};

pub use self::case::{CaseFinished, CaseStart, CaseStarted, Parameter};
pub use self::episode::{CaseEpisode, Episode, EpisodeEnd, EpisodeStarted, masked};
pub use self::expected::{ExpectedFailure, Significance};
pub use self::learned::LearnedLimits;
pub use self::planned::{
    FixturePlanned, HookPlanned, RunStarted, SuitePlanned, TestPlanned, Trigger,
};
pub use self::process::{ExitStatus, LeakedProcess, Output, Source, Stream, signal_name};
pub use self::provided::{FixtureProvided, value_text};
pub use self::test::{Phase, StopCause, TestFinished};
use crate::{
    Attachment, Diagnostic, FaultInjected, FixtureId, HookId, Measurement, Message, Micros,
    QuestionAsked, QuestionClosed, Samples, SuiteId, SuitePrepared, TestId, Usage,
};

/// One event of a run.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Event {
    /// The event's number in its run, from 0, without gaps.
    pub seq: u64,
    /// When it happened, in microseconds since the run started.
    pub at: Micros,
    /// What happened.
    #[serde(flatten)]
    pub kind: EventKind,
}

/// The kind of an event. Every start has exactly one finish, also after a crash or Ctrl-C.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "type", rename_all = "kebab-case")]
pub enum EventKind {
    /// The first event of a run.
    RunStarted(RunStarted),
    /// A suite that will be run. All plans come before the first suite starts.
    SuitePlanned(SuitePlanned),
    /// A fixture of the suite planned last.
    FixturePlanned(FixturePlanned),
    /// A hook of the suite planned last.
    HookPlanned(HookPlanned),
    /// A test of the suite planned last.
    TestPlanned(TestPlanned),
    /// A warning for the user; it does not change a verdict.
    Warning {
        /// The warning.
        diagnostic: Diagnostic,
    },
    /// A suite waits for a lock that it requires. It has not started.
    SuiteWaiting {
        /// The suite.
        suite: SuiteId,
        /// The resource's name.
        lock: String,
        /// The holder of the lock, as text.
        held_by: String,
    },
    /// A suite starts.
    SuiteStarted {
        /// The suite.
        suite: SuiteId,
    },
    /// The private network, ports and variables of a suite. Directly after its start.
    SuitePrepared(SuitePrepared),
    /// A fixture is being set up. `fixture-stopped` is the matching end.
    FixtureStarting {
        /// The fixture.
        fixture: FixtureId,
        /// From 1; each restart counts up.
        attempt: u32,
    },
    /// A fixture provides a value, before `fixture-ready`.
    FixtureProvided(FixtureProvided),
    /// A fixture's set-up succeeded; it is supervised from now on.
    FixtureReady {
        /// The fixture.
        fixture: FixtureId,
    },
    /// A fixture that was ready has failed.
    FixtureCollapsed {
        /// The fixture.
        fixture: FixtureId,
        /// The reason, as the fixture or the kernel reports it.
        reason: String,
        /// The last lines that it printed.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        log_tail: Vec<String>,
    },
    /// A fixture is being torn down.
    FixtureStopping {
        /// The fixture.
        fixture: FixtureId,
    },
    /// A fixture was torn down, or its set-up failed. Matches `fixture-starting`.
    FixtureStopped {
        /// The fixture.
        fixture: FixtureId,
        /// The problem in its set-up or tear-down.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        problem: Option<String>,
        /// The last lines that it printed, if there was a problem.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        log_tail: Vec<String>,
    },
    /// A fixture will not be started again in this run.
    FixtureBroken {
        /// The fixture.
        fixture: FixtureId,
        /// The first cause.
        reason: String,
    },
    /// The reset of a fixture between two episodes has ended.
    FixtureReset {
        /// The fixture.
        fixture: FixtureId,
        /// Why it failed: the fixture is restarted.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        problem: Option<String>,
    },
    /// An episode of a campaign starts.
    EpisodeStarted(EpisodeStarted),
    /// An episode has finished. One that was interrupted never does.
    EpisodeFinished {
        /// The suite.
        suite: SuiteId,
        /// The number of the episode.
        episode: u64,
    },
    /// A test's process is being started. `test-finished` is the matching end.
    TestStarted {
        /// The test.
        test: TestId,
        /// From 1 to the number of repetitions in the suite.
        repetition: u32,
        /// From 1; each retry of the same repetition counts up.
        attempt: u32,
    },
    /// The running test enters a phase.
    TestPhase {
        /// The test.
        test: TestId,
        /// The new phase.
        phase: Phase,
    },
    /// A plug-in reports a message.
    Message {
        /// The reporting test, fixture or hook.
        source: Source,
        /// The message.
        message: Message,
        /// The test whose result it belongs to, when a fixture reports it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        test: Option<TestId>,
    },
    /// A test measured a number.
    Measured {
        /// The test.
        test: TestId,
        /// The fixture, when a fixture measured it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fixture: Option<FixtureId>,
        /// The number, its unit and its limits.
        measurement: Measurement,
    },
    /// A test sampled a signal.
    Sampled {
        /// The test.
        test: TestId,
        /// Some samples of the signal; more may follow.
        samples: Samples,
    },
    /// A fault was injected while a test runs.
    FaultInjected(FaultInjected),
    /// A fault that lasts was removed. It may be missing: no fault outlives its test.
    FaultRemoved {
        /// The test.
        test: TestId,
        /// The name of the fault.
        name: String,
    },
    /// A test attaches a file to its result.
    Attached {
        /// The test.
        test: TestId,
        /// The fixture, when a fixture attached the file.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fixture: Option<FixtureId>,
        /// The file, in the run's directory.
        attachment: Attachment,
    },
    /// A test announces top-level cases that it is going to run.
    CasesPlanned {
        /// The test.
        test: TestId,
        /// Their names, unique in the attempt.
        names: Vec<String>,
    },
    /// A case of a test starts. `case-finished` is the matching end.
    CaseStarted(Box<CaseStarted>),
    /// A case has finished.
    CaseFinished(CaseFinished),
    /// A test asks an operator a question. `question-closed` is the matching end.
    QuestionAsked(Box<QuestionAsked>),
    /// A question was answered, or no operator can answer it any more.
    QuestionClosed(QuestionClosed),
    /// A process printed output.
    Output(Output),
    /// A test has exceeded its `slow` limit. It continues.
    TestSlow {
        /// The test.
        test: TestId,
    },
    /// A test was asked to stop. After a grace period it is killed.
    TestStopping {
        /// The test.
        test: TestId,
        /// Why.
        cause: StopCause,
        /// The cause, as text.
        reason: String,
    },
    /// The stacks of a process that is about to be killed.
    StackDumped {
        /// The owner of the process.
        source: Source,
        /// The stacks of its threads, as the tool or interpreter prints them.
        text: String,
    },
    /// The resources of a process and its descendants, at the end of a test in a
    /// suite in which tests are repeated.
    ResourcesMeasured {
        /// The fixture that owns the process, or the test that a shared host has
        /// just served.
        source: Source,
        /// The resources.
        usage: Usage,
        /// Number of tests that the shared host has served, including this one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        tests_served: Option<u32>,
    },
    /// Processes that outlived their owner, and were killed.
    ProcessesLeaked {
        /// Their owner.
        source: Source,
        /// The processes.
        processes: Vec<LeakedProcess>,
    },
    /// An attempt of a test was judged. Matches `test-started`.
    TestFinished(TestFinished),
    /// A test (or the rest of its repetitions) will not be started.
    TestSkipped {
        /// The test.
        test: TestId,
        /// Why.
        reason: String,
    },
    /// A test that is repeated for a given time has finished: no
    /// repetition follows.
    TestRepeated {
        /// The test.
        test: TestId,
        /// Number of repetitions.
        repetitions: u32,
    },
    /// A hook starts. `hook-finished` is the matching end.
    HookStarted {
        /// The hook.
        hook: HookId,
        /// The trigger.
        trigger: Trigger,
        /// The reason for the trigger, as text.
        reason: String,
        /// The test that triggered it, if there is one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        test: Option<TestId>,
    },
    /// A hook has finished. Matches `hook-started`.
    HookFinished {
        /// The hook.
        hook: HookId,
        /// Why the robot may not be in a safe state; missing when the hook succeeded.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        problem: Option<String>,
    },
    /// A suite has finished. Matches `suite-started`.
    SuiteFinished {
        /// The suite.
        suite: SuiteId,
    },
    /// The last event of a run.
    RunFinished {
        /// The signal or request that interrupted the run.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        interrupted: Option<String>,
    },
    /// The last event of a run whose runner died. The guard writes it after it has
    /// killed leftover processes. Open tests, fixtures and hooks stay open.
    RunnerDied {
        /// How the runner died.
        reason: String,
        /// Its processes that were still alive.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        leaked: Vec<LeakedProcess>,
    },
}

impl EventKind {
    /// A time since the start of the run that the event contains: the zero of other times in it.
    pub fn since_mut(&mut self) -> Option<&mut Micros> {
        match self {
            Self::Sampled { samples, .. } => samples.since.as_mut(),
            Self::Message { message, .. } => message.interval.as_mut()?.since.as_mut(),
            _ => None,
        }
    }
}
