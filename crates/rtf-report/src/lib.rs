//! Reporters: each is given every event of a run and shows or keeps what it wants.
//!
//! [`Fanout`] owns the [`rtf_model::Record`] and hands each event to each
//! [`Reporter`] on a thread of its own. The [`journal`] is the truth from which
//! every other report can be made again; [`console`] talks while the run goes
//! on; [`text`] and [`junit`] write a file when it is over; [`logs`] keeps what
//! each process printed. [`run_folder`] is where all of it goes.
//!
//! This crate starts nothing and decides nothing about a run.

pub mod console;
pub mod escape;
mod explain;
mod fanout;
pub mod journal;
pub mod junit;
pub mod logs;
pub mod output_file;
mod reporter;
pub mod run_folder;
pub mod text;
mod words;

pub use fanout::{Fanout, FanoutHandle, Finished};
pub use reporter::{ReportError, Reporter};
