//! One module a verb of the command line.

mod again;
pub mod check;
mod child;
mod choosing;
pub mod completions;
pub mod config;
pub mod doctor;
pub mod job;
pub mod list;
pub mod locks;
pub mod man;
pub mod merge;
pub mod output;
pub mod planning;
pub mod report;
mod rerun;
mod revision;
pub mod run;
pub mod serve;
pub mod show;
pub mod watch;
pub mod web;

use std::process::ExitCode;

use crate::error::Failure;

/// What a verb comes to: an exit code, or an error to be shown.
pub type Outcome = Result<ExitCode, Failure>;
