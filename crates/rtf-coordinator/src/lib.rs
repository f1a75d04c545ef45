//! Runs the episodes of a campaign on workers, each of which is an `rtf run` with a guard and a
//! journal.
//!
//! - [`coordinator`]: assigns episodes to the workers of a pool, and judges their results.
//! - [`pool`]: the workers, as processes on this machine or tasks of a cluster.
//! - [`stream_pool`]: workers that get episodes while they run, for searches.
//! - [`worker`]: the command of a worker; [`task`]: a worker as a task of a cluster.
//! - `questions`: those of tests, which the operator answers at the terminal.
//! - [`progress`], [`summary`]: the text on standard output.

mod assignment;
pub mod coordinator;
pub mod pool;
pub mod progress;
mod questions;
pub mod stream_pool;
pub mod summary;
pub mod task;
pub mod worker;
