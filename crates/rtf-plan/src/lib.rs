//! Suites and options → [`plan::Plan`], the plan of a run.
//!
//! [`suite`] parses a suite file into declarations with line and column;
//! [`config`] overlays `rtf.toml` and the command line; [`plan`] resolves names,
//! hosts and defaults and reports every problem at once; [`select`] filters,
//! shards and orders the tests of a plan.
//!
//! This crate reads files and starts no process. `rtf-engine` checks whether a
//! plug-in loads, and passes the answers back to a [`plan::PlanDraft`].

pub mod config;
pub mod envelope;
pub mod plan;
pub mod select;
pub mod suite;

mod placeholder;
mod wording;
