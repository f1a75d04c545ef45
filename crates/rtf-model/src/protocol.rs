//! The messages between the runner and a host process.
//!
//! JSON-RPC 2.0, one message a line, over the channel that the host inherits.
//! `spec/protocol.md` documents it; these types are the same in code.
//! Both sides ignore unknown fields and refuse unknown methods.

mod rpc;

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use self::rpc::{Reply, RpcError, RpcMessage};
use crate::{
    Attachment, CaseId, CaseStart, FaultInjected, Finding, FindingSeverity, Location, Measurement,
    Message, Outcome, Parameter, Phase, Question, Samples, TestId, TrajectoryCheck, Verdict,
};

/// The protocol version of this crate. Runner and host must agree on it.
pub const PROTOCOL_VERSION: u32 = 1;

/// The environment variable that names a host's channel: `fd:N` on Unix.
pub const CHANNEL_VARIABLE: &str = "RTF_CHANNEL";

/// The environment variable that marks every process of a test or fixture.
pub const SCOPE_VARIABLE: &str = "RTF_SCOPE";

/// The environment variable that names a process's owner for display: `test arm/EncoderTest`.
pub const OWNER_VARIABLE: &str = "RTF_OWNER";

/// The environment variable that holds the suite's environment string.
pub const ENVIRONMENT_VARIABLE: &str = "RTF_ENVIRONMENT";

/// The environment variable that names the run's directory, which contains the journal.
pub const RUN_DIR_VARIABLE: &str = "RTF_RUN_DIR";

/// The environment variable that names the file with the simulated time, for tests,
/// which follow it. If it is empty or not set, they follow the wall clock.
pub const CLOCK_VARIABLE: &str = "RTF_CLOCK";

/// The environment variable that names the same file for fixtures, one of which may
/// write it.
pub const CLOCK_FILE_VARIABLE: &str = "RTF_CLOCK_FILE";

/// The environment variable that makes a host a server that forks hosts:
/// `fd:N`, then blanks as room for the variables of a [`ForkRequest`].
pub const FORK_SERVER_VARIABLE: &str = "RTF_FORK_SERVER";

/// The environment variable with the descriptor at which a program waits to be forked for
/// each of its cases (`spec/frameworks.md`).
pub const PROGRAM_FORKS_VARIABLE: &str = "RTF_PROGRAM_FORKS";

/// Is `never` if the user wants all processes of tests to be executed.
pub const FORK_VARIABLE: &str = "RTF_FORK";

/// The environment variable that names the socket of a program of another framework:
/// `fd:N`. `spec/frameworks.md` documents it.
pub const SESSION_VARIABLE: &str = "RTF_SESSION";

/// The environment variable that names the file to which such a program writes its stacks
/// on `SIGUSR2`, if it can.
pub const STACK_FILE_VARIABLE: &str = "RTF_STACK_FILE";

/// JSON-RPC error code: the method is not known.
pub const METHOD_NOT_FOUND: i32 = -32601;

/// JSON-RPC error code: the parameters do not fit the method.
pub const INVALID_PARAMS: i32 = -32602;

/// JSON-RPC error code: runner and host speak different protocol versions.
pub const VERSION_MISMATCH: i32 = -32001;

/// The runner's request to a fork server: one more process. Three descriptors
/// come with it: the channel, the standard output, the standard error.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForkRequest {
    /// The working directory.
    pub working_dir: PathBuf,
    /// Environment variables of this process only.
    pub env: BTreeMap<String, String>,
}

/// The answer of a fork server.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ForkReply {
    /// The id of the new process.
    Pid(i32),
    /// Why there is no new process.
    Error(String),
}

/// A request of the runner. The host answers all but `test-reported`, `interrupt`,
/// `question-closed` and `dump-stack`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "method", content = "params", rename_all = "kebab-case")]
pub enum Request {
    /// The first message. Answered with [`Initialized`].
    Initialize(Initialize),
    /// Load a test, set it up, run it, tear it down. Answered with [`Answer`].
    RunTest(Plugin),
    /// Load a fixture and set it up. Answered with [`Answer`].
    SetUpFixture(Plugin),
    /// Check that the fixture is still healthy. Answered with [`Answer`].
    CheckFixture {},
    /// Notify the fixture that an attempt of a test is about to start, if it has
    /// subscribed with [`Answer::subscriptions`]. Answered with [`Answer`].
    TestStarted(TestStartedParams),
    /// Notify the fixture that the process of an attempt has ended, in the same way. The
    /// verdict waits for the answer.
    TestEnded(TestEndedParams),
    /// Notify the fixture of the verdict of an attempt, in the same way.
    TestFinished(TestFinishedParams),
    /// A notification: a running test reported something that the fixture has subscribed to.
    TestReported(TestReportedParams),
    /// Tear the fixture down. Answered with [`Answer`].
    TearDownFixture {},
    /// A notification: stop soon, and report that in the answer.
    Interrupt {
        /// Why, as text.
        reason: String,
        /// The request to stop; the host ignores it if another one is running.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        request: Option<u64>,
    },
    /// A notification: the end of a question, unless the test is stopped.
    QuestionClosed(QuestionEnd),
    /// A notification: send [`Notification::Stack`] if possible.
    DumpStack {},
}

impl Request {
    /// Whether the host answers it.
    #[must_use]
    pub fn is_answered(&self) -> bool {
        !matches!(
            self,
            Self::TestReported(_)
                | Self::Interrupt { .. }
                | Self::QuestionClosed(_)
                | Self::DumpStack {}
        )
    }
}

/// The end of a question.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct QuestionEnd {
    /// The number that the host has given it.
    pub question: u32,
    /// The answer.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub answer: Option<String>,
    /// Why there is no answer: an error of the test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<String>,
}

/// The first request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Initialize {
    /// The runner's [`PROTOCOL_VERSION`].
    pub protocol: u32,
    /// The runner's version, for messages.
    pub rtf: String,
    /// The file for stack dumps that the host writes on a signal.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stack_file: Option<String>,
}

/// The answer to [`Request::Initialize`].
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Initialized {
    /// The host's protocol version.
    pub protocol: u32,
    /// The host's name and version, for messages: `python 3.11.7`.
    pub host: String,
    /// How the runner gets a stack dump of a host that hangs.
    #[serde(default)]
    pub stack: StackSupport,
    /// Whether it supports [`Plugin::end_marker`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub supports_shared: bool,
    /// Whether it supports [`Plugin::cases`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub selects_cases: bool,
}

/// How the runner gets a stack dump of a host that hangs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StackSupport {
    /// Not from the host: the runner attaches a debugger, if there is one.
    #[default]
    None,
    /// The host answers [`Request::DumpStack`] with [`Notification::Stack`].
    Message,
    /// The host writes to [`Initialize::stack_file`] when it receives `SIGUSR2`.
    Signal,
}

/// The plug-in of a request.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plugin {
    /// The plug-in's file, absolute.
    pub file: String,
    /// Its name in the suite.
    pub name: String,
    /// The parameter string as written in the suite.
    #[serde(default)]
    pub param: String,
    /// The parameter string, split into arguments; without a program name.
    #[serde(default)]
    pub args: Vec<String>,
    /// The suite's environment string.
    #[serde(default)]
    pub environment: String,
    /// The repetition, from 1.
    #[serde(default)]
    pub repetition: u32,
    /// Whether this is the host's last request: it exits after the answer.
    #[serde(default)]
    pub is_last: bool,
    /// For a test whose host may serve further tests: the line that the host writes
    /// to both output streams at the end of this test.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_marker: Option<String>,
    /// The directory for a test's attachments. The host creates it when it is needed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attachments_dir: Option<String>,
    /// A test's values of a matrix.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<Parameter>,
    /// The cases that a test runs; empty: all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cases: Vec<CaseSelector>,
    /// The limit for each case, in milliseconds. Only for hosts that run cases in programs.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case_timeout_ms: Option<u64>,
    /// Whether each case needs a separate process. Only for hosts that run cases in programs.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub separate_cases: bool,
    /// Whether these processes may be forked after the static objects of the program are
    /// constructed.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub fork_at_main: bool,
    /// The values of fixtures that it can use.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub fixture_values: Vec<FixtureValue>,
}

/// A value of a fixture.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FixtureValue {
    /// The name of the fixture, a dot, and the name of the value: `simulator.port`.
    pub name: String,
    /// Any JSON value except `null`.
    pub value: Value,
}

/// Selects cases by their path: names joined with `/`.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum CaseSelector {
    /// The case with this path, the cases in it, and those that contain it.
    Equals(String),
    /// Each case whose path contains this text.
    Contains(String),
}

impl CaseSelector {
    /// Whether the case with this path runs.
    #[must_use]
    pub fn selects(&self, path: &str) -> bool {
        let contains = |outer: &str, inner: &str| {
            inner.strip_prefix(outer).is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        match self {
            Self::Equals(wanted) => contains(wanted, path) || contains(path, wanted),
            Self::Contains(text) => path.contains(text.as_str()),
        }
    }
}

/// The events of tests that a fixture can subscribe to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Subscription {
    /// An attempt is about to start: [`Request::TestStarted`].
    TestStarted,
    /// The process of an attempt has ended: [`Request::TestEnded`].
    TestEnded,
    /// An attempt was judged: [`Request::TestFinished`].
    TestFinished,
    /// A running test reports: [`Request::TestReported`].
    TestReported,
}

/// The attempt of a test that a fixture is notified of.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestAttempt {
    /// The test, as in events.
    pub id: TestId,
    /// Its name in the suite.
    pub name: String,
    /// The repetition, from 1.
    pub repetition: u32,
    /// The attempt at this repetition, from 1.
    pub attempt: u32,
}

/// An attempt of a test is about to start.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestStartedParams {
    /// The attempt.
    pub test: TestAttempt,
}

/// The process of an attempt has ended.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestEndedParams {
    /// The attempt.
    pub test: TestAttempt,
    /// Whether the runner stopped it, which decides the verdict: it did not run to its end.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub stopped: bool,
}

/// A running test has reported something.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestReportedParams {
    /// The test, as in events.
    pub test: TestId,
    /// The report.
    pub report: TestReport,
}

/// What a test reports to fixtures that subscribe to it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TestReport {
    /// The phase `setup` begins: times of samples count from now.
    SetupStarted {},
    /// Samples of a signal.
    Sampled(Samples),
    /// A measurement.
    Measured(Measurement),
    /// A monitor that judges the rest of the test.
    Monitor(MonitorDeclaration),
}

/// A monitor that a test declares.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MonitorDeclaration {
    /// The name, unique in the test and the suite.
    pub name: String,
    /// The formula (`spec/monitors.md`).
    pub formula: String,
    /// What a violation means.
    pub severity: FindingSeverity,
    /// The position in the plug-in.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub location: Option<Location>,
}

impl MonitorDeclaration {
    /// A declaration as plug-ins write it. Without a name, it is the formula; without a severity,
    /// it is a failure.
    ///
    /// # Errors
    /// The severity is unknown.
    pub fn new(
        formula: &str,
        name: &str,
        severity: &str,
        location: Option<Location>,
    ) -> Result<Self, String> {
        let name = if name.is_empty() { formula } else { name };
        let mut all = FindingSeverity::ALL.into_iter();
        let known = all.find(|(known, _)| *known == severity).map(|(_, severity)| severity);
        let severity = known.or(severity.is_empty().then_some(FindingSeverity::Fail));
        let severity = severity.ok_or_else(|| {
            format!("the severity of the monitor `{name}` has to be fail, error, stop or critical")
        })?;
        let (name, formula) = (name.to_owned(), formula.to_owned());
        Ok(Self { name, formula, severity, location })
    }
}

/// An attempt of a test was judged.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestFinishedParams {
    /// The attempt.
    pub test: TestAttempt,
    /// The verdict.
    pub verdict: Verdict,
    /// Why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The directory for the fixture's attachments. The host creates it when it is needed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attachments_dir: Option<String>,
}

/// The answer to a request that loads or runs a plug-in.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Answer {
    /// The outcome. The runner takes the reason of a test from its first reported problem.
    pub outcome: Outcome,
    /// Why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// After a fixture's set-up: the events of tests that it subscribes to.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub subscriptions: Vec<Subscription>,
    /// The host has written [`Plugin::end_marker`] and accepts the next test. Otherwise it
    /// exits.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub continues: bool,
}

/// A notification from a host.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "method", content = "params", rename_all = "kebab-case")]
pub enum Notification {
    /// A test enters `setup`, `run` or `tear-down`; in a host that several tests
    /// share also `load`.
    Phase {
        /// The new phase.
        phase: Phase,
    },
    /// The plug-in reports a message.
    Message(Message),
    /// A test measured a number, or a fixture did for the test that it was notified of.
    Measured(Measurement),
    /// Samples of a signal, by a test.
    Sampled(Samples),
    /// Samples of a signal that a fixture took while a test ran.
    Observed {
        /// The test.
        test: TestId,
        /// The samples.
        samples: Samples,
    },
    /// A fixture found a problem of a running test.
    Finding(Finding),
    /// A test checks a signal against a stored trajectory. The runner compares.
    Trajectory(TrajectoryCheck),
    /// A fixture injected a fault while a test runs.
    FaultInjected(FaultInjected),
    /// A fixture removed such a fault.
    FaultRemoved {
        /// The test.
        test: TestId,
        /// The name of the fault.
        name: String,
    },
    /// A test declares a formula that judges the rest of it.
    Monitor(MonitorDeclaration),
    /// A test attaches a file, or a fixture does for the test that it was notified of.
    Attached(Attachment),
    /// A fixture has failed. May arrive at any time.
    Collapsed {
        /// Why, as text.
        reason: String,
    },
    /// A test announces top-level cases that it is going to run.
    CasesPlanned {
        /// Their names.
        names: Vec<String>,
    },
    /// A test starts a case.
    CaseStarted(CaseStart),
    /// A case has finished.
    CaseFinished {
        /// The case.
        case: CaseId,
        /// The result, if no message reports it.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        outcome: Option<Outcome>,
        /// The reason for this outcome.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        reason: Option<String>,
        /// Its duration in microseconds, if the host knows it better than the time between
        /// the two notifications.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        duration_us: Option<u64>,
    },
    /// A test asks an operator a question. Ends with [`Request::QuestionClosed`] or
    /// [`Request::Interrupt`].
    QuestionAsked(Question),
    /// A fixture provides a value for tests, hooks and other fixtures, in its set-up.
    Provided {
        /// The name of the value.
        name: String,
        /// The value.
        value: Value,
    },
    /// The stacks of the host's threads.
    Stack {
        /// The text, as the interpreter prints it.
        text: String,
    },
}
