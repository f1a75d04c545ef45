//! The state machine of one suite: (state, input, now) → effects.
//!
//! No I/O, no clock, no threads. Inputs say what happened, effects say what is
//! to be done; [`crate::run::suite_task`] is the task that connects the two
//! with the world.
//!
//! - [`suite`]: which fixture or test is next, and what a collapse, a stop
//!   request or the suite's limit change about that.
//! - [`fixture`]: one fixture from set-up to tear-down.
//! - [`mod@test`]: one attempt of a test, its phases, limits, and its stop by force.
//! - [`fixtures`]: which of them may be set up or torn down now.
//! - [`hook`], [`hooks`]: one run of a hook; which were called for.
//! - [`judge`]: the verdict over one attempt.
//! - [`capture`]: what is kept of what a process prints.

mod capture;
mod fixture;
mod fixtures;
mod hook;
mod hooks;
mod io;
mod judge;
mod log_watch;
mod suite;
mod test;
#[cfg(test)]
pub(crate) mod tests;

pub use hooks::{HOOK_KILLED, HOOK_NOT_RUN};
pub use io::{
    Deadline, Effect, FixtureTimer, HostId, HostInput, Input, Probes, Program, Start, Stop,
    StopLevel, TestTimer,
};
pub use suite::SuiteMachine;
