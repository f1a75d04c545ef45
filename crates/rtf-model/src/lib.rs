//! The vocabulary that every other part of the Robot Testing Framework shares.
//!
//! An [`Event`] is the only message from a run to its reporters;
//! [`Record::apply`] is the only place that counts events;
//! [`OrderChecker`] checks that a sequence of events is legal. The
//! [`protocol`] module holds the messages between the runner and the host
//! processes that load plug-ins.
//!
//! This crate is plain data: no I/O, no threads, no clock. [`plain_text()`] and [`FailureLine`] read
//! what a program printed.

#![warn(missing_docs)]

mod clock;
mod diagnostic;
mod event;
pub mod exit_code;
mod failure_line;
mod fault;
mod finding;
mod ids;
mod interpreter;
mod journal;
mod manifest;
mod order;
mod plain_text;
mod private_resources;
pub mod protocol;
mod question;
mod record;
mod report;
mod samples;
mod signals;
mod trajectory;
mod trend;
mod usage;
mod verdict;

pub use clock::parse_clock;
pub use diagnostic::{Diagnostic, Label, Severity};
pub use event::{
    CaseEpisode, CaseFinished, CaseStart, CaseStarted, Episode, EpisodeEnd, EpisodeStarted, Event,
    EventKind, ExitStatus, ExpectedFailure, FixturePlanned, FixtureProvided, HookPlanned,
    LeakedProcess, LearnedLimits, Output, Parameter, Phase, RunStarted, Significance, Source,
    StopCause, Stream, SuitePlanned, TestFinished, TestPlanned, Trigger, masked, signal_name,
    value_text,
};
pub use failure_line::{FailureLine, explain_failure};
pub use fault::{
    FaultAction, FaultAmount, FaultConfig, FaultInjected, FaultKind, FaultRecord, FaultTarget,
    FaultTime, FaultsConfig, NetworkFault, ValuesFault,
};
pub use finding::{Finding, FindingSeverity};
pub use ids::{CaseId, FixtureId, HookId, Micros, SuiteId, TestId};
pub use interpreter::{INTERPRETER_BYTES, Interpreter, InterpreterProblem};
pub use journal::{Damage, EventCheck, LineCheck, LineChecker, LineSealer, StreamChecker};
pub use manifest::{Manifest, Origin, Revision};
pub use order::{OrderChecker, OrderError};
pub use plain_text::plain_text;
pub use private_resources::{SuiteNetwork, SuitePort, SuitePrepared, SuiteVariable};
pub use question::{AnswerChannel, Question, QuestionAsked, QuestionClosed, Respondent};
pub use record::{
    AttemptCases, AttemptCounts, AttemptRecord, CaseRecord, EpisodeOutcome, EpisodeRecord,
    FixtureLife, FixtureRecord, FixtureState, HookRecord, HookRunRecord, HostRecord, PlannedCases,
    QuestionRecord, Record, RunState, SignalSummary, SuiteRecord, TestAttempt, TestRecord,
    TestTotals,
};
pub use report::{
    Attachment, Comparison, Location, Measurement, Message, MessageKind, PictureCheck,
    SignalInterval, format_number, format_rounded,
};
pub use samples::{Samples, SignalOutline};
pub use signals::{
    MeasuredFixture, MonitorConfig, ProcessQuantity, SignalConfig, SignalProgram, SignalRecording,
    SignalSource, SignalTime, SignalsConfig, TestQuantity, TestSignal,
};
pub use trajectory::{Alignment, TrajectoryCheck};
pub use usage::{Growth, Resource, Usage, UsageSeries};
pub use verdict::{Outcome, Verdict};

/// The version of the event stream that this crate reads and writes. It increases
/// when a reader of the old version could misunderstand a new stream.
pub const EVENTS_VERSION: u32 = 1;
