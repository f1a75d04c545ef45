//! The protocol between the runner and a host process, from the host's side.
//!
//! A host is a small program that loads plug-ins of one kind. It implements
//! [`HostPlugin`] and is a [`Host`], whose `serve` calls [`serve()`], which does
//! everything that `spec/protocol.md` asks of every host alike: it answers
//! requests in order, announces phases, applies the rule that *the first
//! failure or error decides*, hears a request to stop while the plug-in runs,
//! and ends with the runner. [`check()`] is the other way in: `--check FILE…`.
//!
//! What this crate does not know is any language: loading and calling a
//! plug-in is the host's.

mod check;
mod decode;
mod fork;
mod plugin;
mod program;
mod reader;
mod sampling;
mod serve;
mod session;
mod sharing;
mod unix;
mod verdict;
mod writer;

pub use check::{CheckedFile, check, files_to_check};
pub use plugin::{HostPlugin, LoadError, Reaction, Role, Step, StepEnd, Told};
pub use program::Host;
pub use sampling::Sample;
pub use serve::serve;
pub use session::{OpenError, Session};
