//! The description of a process for its task.

use std::fmt;
use std::os::fd::BorrowedFd;
use std::path::PathBuf;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::event::HostId;
use crate::cgroup::Cgroups;
use crate::launch::Launch;
use crate::probe::Probes;
use crate::spawner::Spawner;

/// A stream of a process, of which the runner has one end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ProcessStream {
    Stdout,
    Stderr,
    Channel,
}

/// The owner of a process. Its methods must not block.
pub trait ProcessOwner: fmt::Debug + Send + Sync {
    /// The process was started, but no request was sent yet.
    fn process_started(&self, pid: i32, streams: &[(ProcessStream, BorrowedFd<'_>)]);

    fn process_ended(&self, pid: i32);

    /// The requests of the process wait until a debugger is attached.
    fn debugger_awaited(&self, pid: i32);

    /// How many bytes of the process's messages wait to be reported.
    fn backlog(&self) -> usize;
}

#[derive(Debug)]
pub struct ProcessJob {
    pub host: HostId,
    pub owner: Arc<dyn ProcessOwner>,
    /// How to start it, unless it was started ahead of time.
    pub launch: Launch,
    /// The directory for attachments, relative to the run's.
    pub attachments_dir: String,
    /// Whether it gets a control group, if possible.
    pub is_grouped: bool,
    /// Whether its resource usage is measured: with each liveness check, and at the end of
    /// each assignment of a shared host.
    pub is_measured: bool,
    /// The probes of a process fixture.
    pub probes: Option<Probes>,
    /// Whether its requests wait until a debugger is attached.
    pub waits_for_debugger: bool,
}

/// The resources that the tasks of all processes share.
#[derive(Debug)]
pub struct TaskContext {
    /// The thread that starts processes.
    pub spawner: Spawner,
    pub run_dir: PathBuf,
    /// The control groups, if possible.
    pub cgroups: Option<Cgroups>,
}
