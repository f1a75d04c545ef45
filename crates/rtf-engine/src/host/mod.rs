//! Processes: how they are started, spoken to, watched and ended.
//!
//! - [`spawner`]: one thread that starts every process.
//! - [`task`]: one task around each process, from its start to the sweep of
//!   what it left behind.
//! - [`launch`]: a process that is to be started, or was started ahead.
//! - [`attached`]: a task like that around what runs already.
//! - [`fork`]: hosts that are forked instead of executed.
//! - [`remote`]: process fixtures on another machine.
//! - [`cgroup`]: control groups, where there are any.
//! - [`codec`]: lines of the protocol.
//! - [`dying`]: whether a process is about to end.
//! - [`tree`]: everything below a process, and orphans.
//! - [`resources`]: descriptors and memory.
//! - [`stack`]: stack dumps of processes that hang.
//! - [`unix`]: the system calls.

pub mod attached;
pub mod cgroup;
pub mod codec;
mod dying;
pub mod fork;
pub mod launch;
pub mod remote;
pub mod resources;
pub mod spawner;
pub mod stack;
pub mod task;
pub mod tree;
mod unix;
mod usage;

pub use unix::{prepare_process, unreadable_proc};
