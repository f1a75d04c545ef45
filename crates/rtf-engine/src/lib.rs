//! Runs plans.
//!
//! [`verify`] checks that the hosts can load the plug-ins of a plan. [`run`] runs the plan: a
//! state machine without I/O or clock, with one task around it. [`isolate`] gives a suite
//! exclusive network, ports and ids; [`locks`] waits for shared resources; [`guard`] takes
//! over when the runner dies. Processes are the business of `rtf-process`.

pub mod control;
pub mod events;
mod fixture_values;
pub mod guard;
mod hook;
pub mod isolate;
pub mod locks;
mod log_watch;
mod plan_texts;
mod plugin_request;
pub mod run;
pub mod signal;
mod unbuffered;
pub mod verify;

pub use plan_texts::refers_to_episode;
