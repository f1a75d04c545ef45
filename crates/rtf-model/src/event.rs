//! What happens in a run, as one owned and serialisable value per fact.
//!
//! The legal order of events is checked by [`crate::OrderChecker`] and written
//! down in `spec/events.md`.

use serde::{Deserialize, Serialize};

use crate::{
    Attachment, Diagnostic, FixtureId, HookId, Manifest, Measurement, Message, Micros, SuiteId,
    SuitePrepared, TestId, Usage, Verdict,
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
    Used {
        /// A fixture, whose process it is, or the test that a shared host has
        /// just served.
        source: Source,
        /// What it uses.
        usage: Usage,
        /// How many tests the shared host has served, this one included.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        served: Option<u32>,
    },
    /// Processes that should have ended and did not; they were killed.
    ProcessesLeft {
        /// Who started them.
        source: Source,
        /// The processes.
        processes: Vec<LeftProcess>,
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
        left: Vec<LeftProcess>,
    },
}

/// The first event of a run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunStarted {
    /// The version of this event stream, see [`crate::EVENTS_VERSION`].
    pub version: u32,
    /// The run's name, which is also its folder's.
    pub run: String,
    /// The version of the runner.
    pub rtf: String,
    /// The time of day, as RFC 3339 with an offset.
    pub started_at: String,
    /// The command line, program first.
    pub command: Vec<String>,
    /// The folder in which the command was given.
    pub folder: String,
    /// How many suites are planned.
    pub suites: u32,
    /// How many tests are planned.
    pub tests: u32,
    /// What was asked for.
    #[serde(default)]
    pub manifest: Box<Manifest>,
}

/// A suite that will be run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SuitePlanned {
    /// The suite.
    pub suite: SuiteId,
    /// Its name, unique in the run.
    pub name: String,
    /// Its file as the user named it; empty for plug-ins given on the command line.
    #[serde(default)]
    pub file: String,
    /// Its description, with white space folded.
    #[serde(default)]
    pub description: String,
    /// Its environment string (`--robot simulator`).
    #[serde(default)]
    pub environment: String,
    /// Whether a collapse of a fixture leaves the suite green.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub tolerates_collapse: bool,
    /// How many of its tests may run at once.
    #[serde(default = "one", skip_serializing_if = "is_one")]
    pub parallel: u32,
}

/// A fixture that will be set up.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FixturePlanned {
    /// The fixture.
    pub fixture: FixtureId,
    /// Its suite.
    pub suite: SuiteId,
    /// Its name, unique in the suite.
    pub name: String,
    /// The plug-in's type (`dll`, `lua`, `python`, `ruby`, `process`).
    pub plugin_type: String,
}

/// A hook: what brings the robot into a safe state.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HookPlanned {
    /// The hook.
    pub hook: HookId,
    /// Its suite.
    pub suite: SuiteId,
    /// Its name, unique in the suite.
    pub name: String,
    /// What calls for it.
    pub on: Vec<Trigger>,
}

/// What calls for a hook.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Trigger {
    /// A test failed, went wrong, or crashed.
    Failure,
    /// A fixture collapsed.
    Collapse,
    /// A test, or the suite, reached its limit.
    Timeout,
    /// The run is cut short: by a signal, or because the runner died.
    Interrupt,
    /// A fixture will not be started again.
    FixtureBroken,
    /// The suite ends, whatever happened.
    End,
}

impl Trigger {
    /// Every trigger.
    pub const ALL: [Self; 6] = [
        Self::Failure,
        Self::Collapse,
        Self::Timeout,
        Self::Interrupt,
        Self::FixtureBroken,
        Self::End,
    ];

    /// The word for this trigger, as in a suite.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Failure => "failure",
            Self::Collapse => "collapse",
            Self::Timeout => "timeout",
            Self::Interrupt => "interrupt",
            Self::FixtureBroken => "fixture-broken",
            Self::End => "end",
        }
    }
}

impl std::fmt::Display for Trigger {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.as_str())
    }
}

/// A test that will be run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestPlanned {
    /// The test.
    pub test: TestId,
    /// Its suite.
    pub suite: SuiteId,
    /// Its name, unique in the suite.
    pub name: String,
    /// The plug-in's type (`dll`, `lua`, `python`, `ruby`).
    pub plugin_type: String,
    /// The plug-in's file.
    pub plugin: String,
    /// How often it is run; when `timed`, in each round.
    pub repetitions: u32,
    /// Whether it is repeated, round by round, until a time is over.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub timed: bool,
    /// The tags given in the suite.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tags: Vec<String>,
}

impl TestPlanned {
    /// Whether there is more than one repetition, or may be.
    #[must_use]
    pub fn is_repeated(&self) -> bool {
        self.repetitions > 1 || self.timed
    }
}

/// A phase of a test, in the order in which they happen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Phase {
    /// The host starts and loads the plug-in.
    Load,
    /// The plug-in's `setup`.
    Setup,
    /// The plug-in's `run`.
    Run,
    /// The plug-in's `tearDown`.
    TearDown,
    /// The host ends, after it has answered.
    Exit,
    /// The attempt is judged, and fixtures are told.
    Notice,
}

impl Phase {
    /// The phase as people say it: `set-up`.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Load => "load",
            Self::Setup => "set-up",
            Self::Run => "run",
            Self::TearDown => "tear-down",
            Self::Exit => "exit",
            Self::Notice => "notice",
        }
    }
}

impl std::fmt::Display for Phase {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.as_str())
    }
}

/// Whose message, output or process it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Source {
    /// The running attempt of a test.
    Test(TestId),
    /// A fixture.
    Fixture(FixtureId),
    /// A hook.
    Hook(HookId),
}

/// Which of its outputs a process used.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Stream {
    /// Standard output.
    Stdout,
    /// Standard error.
    Stderr,
}

/// A piece of what a process printed; joined, the pieces of a stream are its text.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Output {
    /// Whose process printed it.
    pub source: Source,
    /// Where to.
    pub stream: Stream,
    /// The number of bytes left out just before `text`.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub omitted: u64,
    /// The text; bytes that are not UTF-8 are replaced by U+FFFD.
    pub text: String,
}

fn one() -> u32 {
    1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it with a reference")]
fn is_one(number: &u32) -> bool {
    *number == 1
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde calls it with a reference")]
fn is_zero(number: &u64) -> bool {
    *number == 0
}

/// Why a test was asked to stop.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StopCause {
    /// A phase reached its limit.
    Timeout,
    /// A fixture collapsed.
    Collapse,
    /// The user asked for the end of the run.
    Interrupt,
    /// The host broke the protocol.
    Protocol,
}

/// How a process ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ExitStatus {
    /// It returned this exit code.
    Code(i32),
    /// This signal ended it.
    Signal(i32),
}

impl std::fmt::Display for ExitStatus {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Code(code) => write!(f, "exit code {code}"),
            Self::Signal(signal) => match signal_name(*signal) {
                Some(name) => write!(f, "signal {signal} ({name})"),
                None => write!(f, "signal {signal}"),
            },
        }
    }
}

/// The name of a signal on Linux.
fn signal_name(signal: i32) -> Option<&'static str> {
    const NAMES: [&str; 15] = [
        "SIGHUP", "SIGINT", "SIGQUIT", "SIGILL", "SIGTRAP", "SIGABRT", "SIGBUS", "SIGFPE",
        "SIGKILL", "SIGUSR1", "SIGSEGV", "SIGUSR2", "SIGPIPE", "SIGALRM", "SIGTERM",
    ];
    let index = usize::try_from(signal.checked_sub(1)?).ok()?;
    match signal {
        24 => Some("SIGXCPU"),
        25 => Some("SIGXFSZ"),
        31 => Some("SIGSYS"),
        _ => NAMES.get(index).copied(),
    }
}

/// A process that should have ended with its test or fixture and did not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftProcess {
    /// Its process id.
    pub pid: i32,
    /// Its command line.
    pub command: String,
    /// Who started it, where that is not plain: `test arm/EncoderTest`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub owner: Option<String>,
}

/// The end of one attempt of a test.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestFinished {
    /// The test.
    pub test: TestId,
    /// The judgement.
    pub verdict: Verdict,
    /// Why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The phase in which it was decided.
    pub phase: Phase,
    /// How the host's process ended, when it was started and its test's own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exit: Option<ExitStatus>,
    /// Whether the same repetition will be run again.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub rerun: bool,
}
