//! Reporters: each is given every event of a run and shows or keeps what it wants.
//!
//! [`Fanout`] owns the [`rtf_model::Record`] and hands each event to each
//! [`Reporter`] on a thread of its own. The [`journal`] is the truth from which
//! every other report can be made again; [`console`] talks while the run goes
//! on; [`text`] and [`junit`] write a file when it is over; [`logs`] keeps what
//! each process printed. [`tap`], [`event_stream`], [`github`], [`gitlab`] and
//! [`code_quality`] talk to other programs. [`run_folder`] is where all of it goes.
//! [`merge`] makes one run of several.
//! [`predecessor`] tells and writes what robot-testing-framework 2.x did.
//!
//! This crate starts nothing and decides nothing about a run.

mod backlog;
mod cause;
pub mod code_quality;
pub mod console;
pub mod escape;
pub mod event_stream;
mod explain;
mod fanout;
mod finding;
pub mod github;
pub mod gitlab;
mod growth;
pub mod journal;
pub mod junit;
pub mod logs;
pub mod merge;
pub mod outlet;
pub mod output_file;
pub mod predecessor;
mod prepared;
mod reader_left;
pub mod repeated;
mod report_file;
mod reporter;
pub mod run_folder;
mod stream;
pub mod tap;
pub mod text;
mod words;

pub use fanout::{Fanout, FanoutHandle, Finished};
pub use reader_left::reader_left;
pub use report_file::{AtTheEnd, FailureNotice, ReportFile, Tell, WriteReport};
pub use reporter::{ReportError, Reporter};
