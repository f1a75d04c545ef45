//! The messages between the runner and a host process.
//!
//! JSON-RPC 2.0, one message a line, over the channel that the host inherits.
//! `spec/protocol.md` documents it; these types are the same in code.
//! Both sides ignore unknown fields and refuse unknown methods.

mod fork;
mod notification;
mod observed;
mod rpc;
mod variables;

use serde::{Deserialize, Serialize};
use serde_json::Value;

pub use self::fork::{ForkReply, ForkRequest};
pub use self::notification::Notification;
pub use self::observed::{
    MonitorDeclaration, Subscription, TestAttempt, TestEndedParams, TestFinishedParams, TestReport,
    TestReportedParams, TestStartedParams,
};
pub use self::rpc::{Reply, RpcError, RpcMessage};
pub use self::variables::{
    CHANNEL_VARIABLE, CLOCK_FILE_VARIABLE, CLOCK_VARIABLE, ENVIRONMENT_VARIABLE,
    FORK_SERVER_VARIABLE, FORK_VARIABLE, OWNER_VARIABLE, PROGRAM_FORKS_VARIABLE, RUN_DIR_VARIABLE,
    SCOPE_VARIABLE, SESSION_VARIABLE, STACK_FILE_VARIABLE,
};
use crate::{Episode, Outcome, Parameter};

/// The protocol version of this crate. Runner and host must agree on it.
pub const PROTOCOL_VERSION: u32 = 1;

/// JSON-RPC error code: the method is not known.
pub const METHOD_NOT_FOUND: i32 = -32601;

/// JSON-RPC error code: the parameters do not fit the method.
pub const INVALID_PARAMS: i32 = -32602;

/// JSON-RPC error code: runner and host speak different protocol versions.
pub const VERSION_MISMATCH: i32 = -32001;

/// A request of the runner. The host answers all but `test-reported`, `interrupt`,
/// `question-closed`, `episodes`, `end-of-episodes` and `dump-stack`.
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
    /// A notification: further episodes for a test with slots.
    Episodes {
        /// Those to run.
        episodes: Vec<Episode>,
    },
    /// A notification: no further episode follows.
    EndOfEpisodes {},
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
                | Self::Episodes { .. }
                | Self::EndOfEpisodes {}
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
    /// Whether it supports [`Plugin::episodes`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub runs_episodes: bool,
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
    /// For such a host: whether it also serves further tests after this one has failed or skipped
    /// itself.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub continues_after_failure: bool,
    /// For such a host: environment variables that it sets before it loads the plug-in.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub variables: Vec<Parameter>,
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
    /// Of a test that runs many episodes: how.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub episodes: Option<EpisodeSlots>,
}

/// How a test runs many episodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct EpisodeSlots {
    /// How many it runs at the same time, from 1.
    pub slots: u32,
    /// The limit of an episode in steps, from 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_steps: Option<u64>,
    /// The limit of an episode in simulated time, in microseconds.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub max_time_us: Option<u64>,
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
