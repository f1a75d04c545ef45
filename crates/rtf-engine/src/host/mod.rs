//! Processes: how they are started, spoken to, watched and ended.
//!
//! - [`spawner`]: one thread that starts every process.
//! - [`task`]: one task around each process, from its start to the sweep of
//!   what it left behind.
//! - [`launch`]: a process that is to be started, or was started ahead.
//! - [`codec`]: lines of the protocol.
//! - [`tree`]: everything below a process, and orphans.
//! - [`stack`]: stack dumps of processes that hang.
//! - [`unix`]: the system calls.

pub mod codec;
pub mod launch;
pub mod spawner;
pub mod stack;
pub mod task;
pub mod tree;
mod unix;

pub use unix::prepare_process;
