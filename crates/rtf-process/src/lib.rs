//! Operating-system processes: starts them, exchanges messages with them, probes
//! them, and ends them with everything below them.
//!
//! Knows the host protocol, but no suite and no test. [`task`] supervises one
//! process from its start until its leftover processes are killed; it reports to a
//! [`task::ProcessOwner`] and over a queue of [`task::ProcessEvent`].

pub mod cgroup;
pub mod codec;
pub mod descriptor_passing;
pub mod foreground;
pub mod fork_server;
mod http;
pub mod launch;
mod liveness;
pub mod namespaces;
pub mod network;
mod posix_spawn;
pub mod probe;
pub mod process;
pub mod resources;
pub mod spawn_request;
pub mod spawner;
pub mod ssh;
pub mod stack_dump;
pub mod start_failure;
pub mod start_gate;
pub mod task;
pub mod tree;
mod unix;
mod usage;

pub use posix_spawn::reset_signals;
pub use unix::{adopt_orphans, prepare_process, signal_group, signal_process, unreadable_proc};
