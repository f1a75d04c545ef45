//! The messages between the runner and a host process.
//!
//! JSON-RPC 2.0, one message a line, over the channel that the host inherits.
//! `spec/protocol.md` is the text for people; these types are the same in code.
//! Unknown fields are ignored on both sides, unknown methods are refused.

use std::collections::BTreeMap;
use std::path::PathBuf;

use serde::{Deserialize, Serialize};

use crate::{Attachment, Measurement, Message, Outcome, Phase, Samples, TestId, Verdict};

/// The protocol version of this crate. Runner and host must agree on it.
pub const PROTOCOL_VERSION: u32 = 1;

/// The environment variable that tells a host where its channel is: `fd:N` on Unix.
pub const CHANNEL_VARIABLE: &str = "RTF_CHANNEL";

/// The environment variable that marks every process of a test or fixture.
pub const SCOPE_VARIABLE: &str = "RTF_SCOPE";

/// The environment variable that says for people whose process it is: `test arm/EncoderTest`.
pub const OWNER_VARIABLE: &str = "RTF_OWNER";

/// The environment variable that holds the suite's environment string.
pub const ENVIRONMENT_VARIABLE: &str = "RTF_ENVIRONMENT";

/// The environment variable that names the run's folder, in which the journal is.
pub const RUN_DIR_VARIABLE: &str = "RTF_RUN_DIR";

/// The environment variable that names the file with the simulated time, for tests,
/// which follow it. Empty or not set: they follow the wall clock.
pub const CLOCK_VARIABLE: &str = "RTF_CLOCK";

/// The environment variable that names the same file for fixtures, one of which may
/// write it.
pub const CLOCK_FILE_VARIABLE: &str = "RTF_CLOCK_FILE";

/// The environment variable that makes a host a server that forks hosts:
/// `fd:N`, then blanks as room for the variables of a [`ForkRequest`].
pub const FORK_SERVER_VARIABLE: &str = "RTF_FORK_SERVER";

/// JSON-RPC error code: the method is not known.
pub const METHOD_NOT_FOUND: i32 = -32601;

/// JSON-RPC error code: the parameters do not fit the method.
pub const INVALID_PARAMS: i32 = -32602;

/// JSON-RPC error code: runner and host speak different protocol versions.
pub const VERSION_MISMATCH: i32 = -32001;

/// What the runner asks of a forking host: one more process. Three descriptors
/// come with it: the channel, the standard output, the standard error.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ForkRequest {
    /// The working folder.
    pub working_dir: PathBuf,
    /// Environment variables that only this process has.
    pub env: BTreeMap<String, String>,
}

/// What a forking host answers.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ForkReply {
    /// The id of the new process.
    Pid(i32),
    /// Why there is none.
    Error(String),
}

/// What the runner asks of a host. All but `interrupt` and `dump-stack` are answered.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "method", content = "params", rename_all = "kebab-case")]
pub enum Request {
    /// The first message. Answered with [`Initialized`].
    Initialize(Initialize),
    /// Load a test, set it up, run it, tear it down. Answered with [`Answer`].
    RunTest(Plugin),
    /// Load a fixture and set it up. Answered with [`Answer`].
    SetUpFixture(Plugin),
    /// Ask the fixture whether it is still well. Answered with [`Answer`].
    CheckFixture {},
    /// Tell the fixture that an attempt of a test is about to begin. Only for one that
    /// asked for it in [`Answer::subscriptions`]. Answered with [`Answer`].
    TestStarted(TestStarts),
    /// Tell the fixture how an attempt of a test was judged, in the same way.
    TestFinished(TestEnds),
    /// Tear the fixture down. Answered with [`Answer`].
    TearDownFixture {},
    /// A notification: stop soon, and say so in the answer.
    Interrupt {
        /// Why, in words.
        reason: String,
        /// Which request is to stop; nothing happens when it is another one's turn.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        request: Option<u64>,
    },
    /// A notification: send [`Notification::Stack`] if that can be done.
    DumpStack {},
}

impl Request {
    /// Whether the host answers it.
    #[must_use]
    pub fn is_answered(&self) -> bool {
        !matches!(self, Self::Interrupt { .. } | Self::DumpStack {})
    }
}

/// The first request.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Initialize {
    /// The runner's [`PROTOCOL_VERSION`].
    pub protocol: u32,
    /// The runner's version, for messages.
    pub rtf: String,
    /// Where a host that answers a signal with a stack dump writes it.
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
    /// How the runner gets a stack dump from a host that hangs.
    #[serde(default)]
    pub stack: StackSupport,
    /// Whether it knows [`Plugin::end_marker`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub supports_shared: bool,
}

/// How the runner gets a stack dump from a host that hangs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StackSupport {
    /// Not from the host: a debugger is attached, where there is one.
    #[default]
    None,
    /// The host answers [`Request::DumpStack`] with [`Notification::Stack`].
    Message,
    /// The host writes to [`Initialize::stack_file`] when it gets `SIGUSR2`.
    Signal,
}

/// The plug-in that a request is about.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Plugin {
    /// The plug-in's file, absolute.
    pub file: String,
    /// The name under which the suite knows it.
    pub name: String,
    /// The parameter string as the suite has it.
    #[serde(default)]
    pub param: String,
    /// The parameter string, split into arguments; without a program's name.
    #[serde(default)]
    pub args: Vec<String>,
    /// The suite's environment string.
    #[serde(default)]
    pub environment: String,
    /// The repetition, from 1.
    #[serde(default)]
    pub repetition: u32,
    /// Whether this is the host's only request: it ends after the answer.
    #[serde(default)]
    pub is_last: bool,
    /// For a test whose host may serve further tests: what the host then writes
    /// to both outputs at the end of this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end_marker: Option<String>,
    /// A test's folder for what it attaches. The host makes it when it is needed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attachments_dir: Option<String>,
}

/// What a fixture may be told of each test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Subscription {
    /// An attempt is about to begin: [`Request::TestStarted`].
    TestStarted,
    /// An attempt was judged: [`Request::TestFinished`].
    TestFinished,
}

/// The attempt of a test that a fixture is told of.
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

/// An attempt of a test is about to begin.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestStarts {
    /// Which one.
    pub test: TestAttempt,
}

/// An attempt of a test was judged.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct TestEnds {
    /// Which one.
    pub test: TestAttempt,
    /// The judgement.
    pub verdict: Verdict,
    /// Why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The folder for what the fixture attaches. The host makes it when it is needed.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub attachments_dir: Option<String>,
}

/// The answer to a request that carries out something.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Answer {
    /// How it went. For a test, what its first failure or error was.
    pub outcome: Outcome,
    /// Why it did not pass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// After a fixture's set-up: what it wants to be told of each test.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub subscriptions: Vec<Subscription>,
    /// The host has written [`Plugin::end_marker`] and takes the next test. Else it
    /// ends.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub continues: bool,
}

/// What a host tells without being asked.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(tag = "method", content = "params", rename_all = "kebab-case")]
pub enum Notification {
    /// A test enters `setup`, `run` or `tear-down`; in a host that several tests
    /// share also `load`.
    Phase {
        /// The phase that begins.
        phase: Phase,
    },
    /// The plug-in reports something.
    Message(Message),
    /// A test measured a number, or a fixture did for the test of which it is told.
    Measured(Measurement),
    /// Some samples of a signal, by a test.
    Sampled(Samples),
    /// A test keeps a file, or a fixture does for the test of which it is told.
    Attached(Attachment),
    /// A fixture is not well any more. May come at any time.
    Collapsed {
        /// Why, in words.
        reason: String,
    },
    /// The stacks of the host's threads.
    Stack {
        /// As the interpreter prints them.
        text: String,
    },
}

/// A message as it stands on a line. `id` with `method` is a request, `method`
/// alone a notification, `id` alone an answer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Line<T> {
    /// Always `2.0`.
    pub jsonrpc: String,
    /// The request's number.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub id: Option<u64>,
    /// The message.
    #[serde(flatten)]
    pub body: T,
}

impl<T> Line<T> {
    /// A line with or without a number.
    #[must_use]
    pub fn new(id: Option<u64>, body: T) -> Self {
        Self { jsonrpc: "2.0".to_owned(), id, body }
    }
}

/// The body of an answer.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Reply<T> {
    /// The request was carried out.
    Result(T),
    /// The request could not be understood.
    Error(RpcError),
}

/// A JSON-RPC error.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RpcError {
    /// One of the codes of this module, or another of JSON-RPC 2.0.
    pub code: i32,
    /// What is wrong.
    pub message: String,
}
