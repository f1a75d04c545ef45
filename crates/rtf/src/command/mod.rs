//! The verbs. One function per verb shows its whole way:
//!
//! ```text
//! arguments ─► request ───► plan ───► preflight ─► runner      rtf run
//!   cli         │             │ ├► output                       rtf list, rtf check
//!               │             │ └► watched files ─► rtf run     rtf watch
//!               ├► journal of a past run ─► output              rtf show, report, merge
//!               ├► history ─► answer ─► output                  rtf history
//!               └► web server ─► rtf run --rerun                rtf serve
//! ```
//!
//! Values go from left to right only. [`crate::request`] makes requests, which are plain data, from
//! arguments, `rtf.toml` and past runs; [`rtf_run`] does the rest for all verbs that run tests.
//! [`crate::testrunner`] goes the same way for the command line of robot-testing-framework 2.x, with
//! another request.

pub mod campaign;
pub mod check;
pub mod completions;
pub mod config;
pub mod doctor;
pub mod golden;
mod golden_picture;
pub mod history;
pub mod import;
pub mod init;
pub mod list;
pub mod locks;
pub mod man;
pub mod merge;
pub mod new;
pub mod report;
pub mod run;
pub mod sdk_dir;
pub mod serve;
pub mod show;
pub mod watch;

pub use rtf_run::VerbResult;
