//! The vocabulary that every other part of the Robot Testing Framework shares.
//!
//! An [`Event`] is the only thing that travels from a run to whoever wants to
//! know about it; [`Record::apply`] is the only place that counts events;
//! [`OrderChecker`] says which sequences of events are legal. The
//! [`protocol`] module holds the messages between the runner and the host
//! processes that load plug-ins.
//!
//! This crate is plain data: no I/O, no threads, no clock.

mod clock;
mod diagnostic;
mod event;
mod ids;
mod journal;
mod manifest;
mod order;
mod prepared;
pub mod protocol;
mod record;
mod report;
mod samples;
mod trend;
mod usage;
mod verdict;

pub use clock::parse_clock;
pub use diagnostic::{Diagnostic, Label, Severity};
pub use event::{
    Event, EventKind, ExitStatus, FixturePlanned, HookPlanned, LeakedProcess, Output, Phase,
    RunStarted, Source, StopCause, Stream, SuitePlanned, TestFinished, TestPlanned, Trigger,
};
pub use ids::{FixtureId, HookId, Micros, SuiteId, TestId};
pub use journal::{Checked, Damage, LineCheck, LineChecker, LineSealer, StreamChecker};
pub use manifest::{Manifest, Revision};
pub use order::{OrderChecker, OrderError};
pub use prepared::{SuiteNetwork, SuitePort, SuitePrepared, SuiteVariable};
pub use record::{
    AttemptRecord, Counts, FixtureLife, FixtureRecord, FixtureState, HookRecord, HookRun,
    HostRecord, Record, RunState, Series, SuiteRecord, TestRecord, Totals,
};
pub use report::{
    Attachment, Comparison, Location, Measurement, Message, MessageKind, format_number,
    format_rounded,
};
pub use samples::{Curve, Samples};
pub use usage::{Growth, Resource, Usage, UsageSeries};
pub use verdict::{Outcome, Verdict};

/// The version of the event stream that this crate reads and writes. It grows
/// when a reader of the old version could misunderstand a new stream.
pub const EVENTS_VERSION: u32 = 1;
