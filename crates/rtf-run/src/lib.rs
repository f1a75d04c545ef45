//! From a request to the results of a run: what every verb that runs tests has in common.
//!
//! ```text
//! request ──► plan ──► preflight ──► run ──► finish
//!               │
//!               └► problems, printed
//! ```
//!
//! [`pipeline`] is the whole way. [`request`] is plain data; the binary makes it from arguments,
//! `rtf.toml` and past runs. Values go from left to right only: a stage reads the results of earlier
//! stages and calls no earlier stage. [`guarded`] forks before the request is resolved, so that the
//! guard stays small; the stages from there on are those of the runner process.
//!
//! What they share: [`error`] and [`exit`] end the program; [`terminal`] and [`diagnostics`] print;
//! [`history`] imports and reads results; [`campaign`] reads the files and directories of
//! campaigns. Around runs: [`merge`], [`reruns`] that a browser requests, [`watch`] decides when a
//! changed file starts the next one, [`doctor`] checks the machine.

pub mod campaign;
pub mod collector;
pub mod control;
pub mod debug;
pub mod diagnostics;
pub mod doctor;
pub mod error;
pub mod exit;
pub mod finish;
pub mod formats;
pub mod guarded;
pub mod history;
pub mod merge;
pub mod operator;
pub mod origin;
pub mod outputs;
pub mod pipeline;
pub mod plan;
pub mod preflight;
pub mod reports;
pub mod request;
pub mod rerun_command;
pub mod reruns;
pub mod revision;
pub mod run;
pub mod spawn_self;
pub mod terminal;
pub mod watch;
pub mod web;

use std::process::ExitCode;

use error::Failure;

/// The exit code of a verb, or an error to print.
pub type VerbResult = Result<ExitCode, Failure>;
