//! The notifications of a host.

use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::MonitorDeclaration;
#[cfg(doc)]
use super::Request;
use crate::{
    Attachment, CaseId, CaseStart, EpisodeEnd, FaultInjected, Finding, LeakedProcess, Measurement,
    Message, Outcome, Phase, Question, Samples, TestId, TrajectoryCheck,
};

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
        /// Its framework runs this top-level case again, and the next attempt decides.
        #[serde(default, skip_serializing_if = "std::ops::Not::not")]
        rerun: bool,
        /// What the test reports about an episode.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        episode: Option<Box<EpisodeEnd>>,
    },
    /// A host that runs cases in programs killed what one of these left behind.
    ProcessesLeft {
        /// The case, if the program ran only this one. It is still open.
        #[serde(default, skip_serializing_if = "Option::is_none")]
        case: Option<CaseId>,
        /// The processes.
        processes: Vec<LeakedProcess>,
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
