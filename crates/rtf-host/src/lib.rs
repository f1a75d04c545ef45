//! The host's side of the protocol between the runner and a host process.
//!
//! A host is a small program that loads plug-ins of one kind. It implements
//! [`HostPlugin`] and is a [`HostProgram`], whose `serve` calls [`serve()`]. That function
//! does everything that `spec/protocol.md` requires of every host: it answers
//! requests in order, announces phases, reads stop requests while the plug-in runs,
//! and ends with the runner. [`check()`] implements `--check FILE…`.
//!
//! This crate knows no language: the host loads and calls the plug-in.

pub mod added_fixture;
mod cases;
mod check;
mod decode;
mod fork_server;
mod outcome;
mod plugin;
mod process_marks;
mod program;
mod reader;
mod sampling;
mod serve;
mod session;
mod shared_host;
mod suite_clock;
mod unix;
mod writer;
mod yarp;

pub use cases::{CaseEnd, EpisodeResult};
pub use check::{CheckedFile, check, files_to_check};
pub use decode::{Incoming, decode};
pub use plugin::{HostPlugin, LoadError, PluginKind, Reaction, Step, StepEnd, TestNotification};
pub use process_marks::{ProcessMarks, fixture_owner};
pub use program::HostProgram;
pub use sampling::Sample;
pub use serve::serve;
pub use session::{FaultRequest, Inquiry, OpenError, Session, TakenEpisode};
pub use suite_clock::SuiteClock;
pub use unix::{flush_output, reset_signals};
