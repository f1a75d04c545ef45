//! Paths + options → [`Plan`]: what will be done.
//!
//! Responsible for finding every suite, plug-in, host and program, for unique
//! names, and for reporting *all* problems at once. It starts nothing but the
//! hosts' own check of plug-ins (`--check`), so a plan that comes out without
//! errors can fail only by the world, not by what was written.

mod build;
mod clock;
mod context;
pub(crate) mod defaults;
mod depends;
mod fixture;
mod hook;
mod hosts;
mod inputs;
mod middleware;
mod names;
mod plugin;
mod program;
mod scope;
mod suite;
mod surroundings;
mod there;
mod types;
mod unix;
mod verify;

pub use build::{Manner, Options, Outcome, Request, build, build_requests};
pub use surroundings::Surroundings;
pub use there::{HostThere, fixtures_there, hosts_there, program_there};
pub use types::*;
