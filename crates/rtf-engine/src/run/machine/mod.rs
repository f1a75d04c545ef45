//! The state machine of one suite: (state, input, now) → effects.
//!
//! It has no I/O, clock or threads. [`crate::run::suite_task`] feeds it with inputs and
//! carries out its effects.

mod context;
mod fixture;
mod fixture_graph;
mod hook;
mod hook_queue;
mod host_replies;
mod io;
mod judge;
pub(super) mod kill_escalation;
mod line_buffer;
mod output_capture;
mod suite;
mod test;
#[cfg(test)]
pub(crate) mod tests;

pub use io::{
    Deadline, Effect, FixtureTimer, HostId, Input, ProbeSelection, ProcessEvent, Program,
    QuestionReply, SignalReach, StartRequest, Stop, StopLevel, TestTimer,
};
pub use suite::SuiteMachine;
