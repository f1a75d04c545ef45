//! Reporters: each receives every event of a run, and shows or stores what it needs.
//!
//! [`Fanout`] owns the [`rtf_model::Record`] and hands each event to each
//! [`Reporter`] in a separate thread. The [`journal`] is the authoritative record, from which
//! every other report can be generated; [`console`] shows the run while it
//! continues; [`text`] and [`junit`] write a file at its end; [`logs`] keeps the output of
//! each process. [`tap`], [`event_stream`], [`github`], [`gitlab`],
//! [`code_quality`] and [`markdown`] are for other programs. [`run_dir`] is the directory of all results.
//! [`merge`] merges several runs.
//! [`predecessor`] has the output formats of robot-testing-framework 2.x.
//!
//! This crate starts nothing and decides nothing about a run.

pub mod background_writer;
mod backlog;
mod cases;
mod cause;
pub mod code_quality;
pub mod console;
mod disconnect;
pub mod episode_results;
pub mod escape;
pub mod event_stream;
mod explain;
mod fanout;
mod finding;
mod fnv;
pub mod github;
pub mod gitlab;
mod growth;
pub mod journal;
pub mod junit;
mod known_failure;
pub mod local_time;
pub mod logs;
pub mod markdown;
pub mod merge;
pub mod otlp;
mod outcome;
pub mod output_file;
pub mod predecessor;
mod private_resources;
mod progress_bar;
pub mod repetition_summary;
mod report_file;
mod reporter;
mod retried;
pub mod run_dir;
mod stdout_stream;
pub mod tap;
pub mod text;
mod words;

pub use disconnect::is_disconnect;
pub use fanout::{Fanout, FanoutHandle, FanoutResult};
pub use report_file::{
    AnnotationReporter, FailureNotice, PrintAnnotations, ReportFile, WriteReport,
};
pub use reporter::{ReportError, Reporter};
pub use words::{count as format_count, p_value as format_p_value, time as format_duration};
