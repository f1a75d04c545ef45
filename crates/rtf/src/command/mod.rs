//! One module a verb of the command line.

mod again;
pub mod check;
pub mod completions;
pub mod list;
pub mod man;
mod planning;
pub mod report;
pub mod run;
pub mod show;

use std::process::ExitCode;

use crate::error::Failure;

/// What a verb comes to: an exit code, or an error to be shown.
pub type Outcome = Result<ExitCode, Failure>;
