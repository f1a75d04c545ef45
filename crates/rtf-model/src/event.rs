//! What happens in a run, as one owned and serialisable value per fact.
//!
//! The legal order of events is checked by [`crate::OrderChecker`] and written
//! down in `spec/events.md`.

mod planned;
mod process;
mod test;

use serde::{Deserialize, Serialize};

pub use self::planned::{
    FixturePlanned, HookPlanned, RunStarted, SuitePlanned, TestPlanned, Trigger,
};
pub use self::process::{ExitStatus, LeakedProcess, Output, Source, Stream};
pub use self::test::{Phase, StopCause, TestFinished};
use crate::{
    Attachment, Diagnostic, FixtureId, HookId, Measurement, Message, Micros, Samples, SuiteId,
    SuitePrepared, TestId, Usage,
};

/// One fact about a run.
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

/// What happened. Every start has exactly one finish, also on a crash or Ctrl-C.
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
    /// Something that the user should look at; it does not change a verdict.
    Warning {
        /// What was noticed.
        diagnostic: Diagnostic,
    },
    /// A suite waits for a lock that it requires. It has not begun.
    SuiteWaiting {
        /// The suite.
        suite: SuiteId,
        /// The resource's name.
        lock: String,
        /// Who has it, in words.
        held_by: String,
    },
    /// A suite begins.
    SuiteStarted {
        /// The suite.
        suite: SuiteId,
    },
    /// What a suite got for itself. After its start, before anything of it begins.
    SuitePrepared(SuitePrepared),
    /// A fixture is being set up. Ends with `fixture-stopped`.
    FixtureStarting {
        /// The fixture.
        fixture: FixtureId,
        /// From 1; each restart counts up.
        attempt: u32,
    },
    /// A fixture's set-up succeeded; it is watched from now on.
    FixtureReady {
        /// The fixture.
        fixture: FixtureId,
    },
    /// A fixture that was ready is not there any more.
    FixtureCollapsed {
        /// The fixture.
        fixture: FixtureId,
        /// Why, in the fixture's or the kernel's words.
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
    /// The end of what `fixture-starting` began.
    FixtureStopped {
        /// The fixture.
        fixture: FixtureId,
        /// What went wrong in its set-up or tear-down.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        problem: Option<String>,
        /// The last lines that it printed, when something went wrong.
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
    /// A test's process is being started. Ends with `test-finished`.
    TestStarted {
        /// The test.
        test: TestId,
        /// From 1 to the number of repetitions that the suite asks for.
        repetition: u32,
        /// From 1; a rerun of the same repetition counts up.
        attempt: u32,
    },
    /// The running test begins a phase.
    TestPhase {
        /// The test.
        test: TestId,
        /// The phase that begins.
        phase: Phase,
    },
    /// A plug-in reports something.
    Message {
        /// Who reports.
        source: Source,
        /// What is reported.
        message: Message,
        /// The test with whose result it belongs, when a fixture reports it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        test: Option<TestId>,
    },
    /// A test measured a number.
    Measured {
        /// The test.
        test: TestId,
        /// The fixture, when it is one that measured.
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
    /// A test keeps a file with its result.
    Attached {
        /// The test.
        test: TestId,
        /// The fixture, when it is one that keeps the file.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        fixture: Option<FixtureId>,
        /// The file, in the run's folder.
        attachment: Attachment,
    },
    /// A process printed something.
    Output(Output),
    /// A test takes longer than its `slow` limit. It goes on.
    TestSlow {
        /// The test.
        test: TestId,
    },
    /// A test was asked to stop. What follows is its grace, then force.
    TestStopping {
        /// The test.
        test: TestId,
        /// Why.
        cause: StopCause,
        /// The cause in words.
        reason: String,
    },
    /// Where a process was when it was about to be stopped by force.
    StackDumped {
        /// Whose process it was.
        source: Source,
        /// The stacks of its threads, as the tool or interpreter prints them.
        text: String,
    },
    /// What a process and all that it started uses, at the end of a test in a
    /// suite in which tests are repeated.
    ResourcesMeasured {
        /// A fixture, whose process it is, or the test that a shared host has
        /// just served.
        source: Source,
        /// What it uses.
        usage: Usage,
        /// How many tests the shared host has served, this one included.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        tests_served: Option<u32>,
    },
    /// Processes that should have ended and did not; they were killed.
    ProcessesLeaked {
        /// Who started them.
        source: Source,
        /// The processes.
        processes: Vec<LeakedProcess>,
    },
    /// The end of what `test-started` began.
    TestFinished(TestFinished),
    /// A test (or what is left of its repetitions) that will not be started.
    TestSkipped {
        /// The test.
        test: TestId,
        /// Why.
        reason: String,
    },
    /// The last word on a test that is repeated until a time is over: no
    /// repetition follows.
    TestRepeated {
        /// The test.
        test: TestId,
        /// How often it was repeated.
        repetitions: u32,
    },
    /// A hook is being run. Ends with `hook-finished`.
    HookStarted {
        /// The hook.
        hook: HookId,
        /// What called for it.
        trigger: Trigger,
        /// The same in words.
        reason: String,
        /// The test that it is about, if there is one.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        test: Option<TestId>,
    },
    /// The end of what `hook-started` began.
    HookFinished {
        /// The hook.
        hook: HookId,
        /// Why the robot may not be in a safe state; nothing when the hook did its work.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        problem: Option<String>,
    },
    /// The end of what `suite-started` began.
    SuiteFinished {
        /// The suite.
        suite: SuiteId,
    },
    /// The last event of a run.
    RunFinished {
        /// The signal or request that cut the run short, in words.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        interrupted: Option<String>,
    },
    /// The last event of a run whose runner died: written by the guard, which
    /// stopped what was left. What was open stays open.
    RunnerDied {
        /// How the runner ended.
        reason: String,
        /// What it had started and was still alive.
        #[serde(default, skip_serializing_if = "Vec::is_empty")]
        leaked: Vec<LeakedProcess>,
    },
}
