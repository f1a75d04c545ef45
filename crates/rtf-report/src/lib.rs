//! Reporters: each is given every event of a run and shows or keeps what it wants.
//!
//! [`Fanout`] owns the [`rtf_model::Record`] and hands each event to each
//! [`Reporter`] on a thread of its own. The [`journal`] is the truth from which
//! every other report can be made again; [`console`] talks while the run goes
//! on; [`text`] and [`junit`] write a file when it is over; [`logs`] keeps what
//! each process printed. [`tap`], [`event_stream`], [`github`], [`gitlab`] and
//! [`code_quality`] talk to other programs. [`run_dir`] is where all of it goes.
//! [`merge`] makes one run of several.
//! [`predecessor`] tells and writes what robot-testing-framework 2.x did.
//!
//! This crate starts nothing and decides nothing about a run.

pub mod background_writer;
mod backlog;
mod cause;
pub mod code_quality;
pub mod console;
mod disconnect;
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
pub mod output_file;
pub mod predecessor;
mod prepared;
pub mod repeated;
mod report_file;
mod reporter;
pub mod run_dir;
mod stream;
pub mod tap;
pub mod text;
mod words;

pub use disconnect::is_disconnect;
pub use fanout::{Fanout, FanoutHandle, FanoutResult};
pub use report_file::{
    AnnotationReporter, FailureNotice, PrintAnnotations, ReportFile, WriteReport,
};
pub use reporter::{ReportError, Reporter};
