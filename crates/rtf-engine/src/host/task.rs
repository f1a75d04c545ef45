//! The task around one process: from its start to the sweep of what it left.
//!
//! It carries orders to the process, and tells the suite's task what the
//! process said, printed, and how it ended. Everything that the process said
//! and printed is delivered before its end is told.

mod copy;
mod far;
mod input;
mod keep;
mod lines;
pub(super) mod liveness;
mod outgoing;
mod sharing;
mod streams;
mod throttle;

use std::collections::VecDeque;
use std::os::fd::AsFd;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::{Request, StackSupport, TestFinishedParams};
use rtf_model::{ExitStatus, Source, Stream};
use tokio::io::AsyncWriteExt;
use tokio::sync::mpsc;
use tokio::task::JoinSet;

use super::cgroup::Cgroups;
use super::codec::{self, FromHost};
use super::launch::Launch;
use super::spawner::{Process, Spawner};
use super::tree::Effort;
use super::{stack, tree, unix};
use crate::guard::{Kept, Link, gate};
use crate::run::Sink;
use crate::run::machine::{HostId, HostInput, Probes};
use crate::run::probe::{self, Asker, Files, Watch};
use rtf_plan::plan::ProcessPlan;

/// After its end, a process's outputs are read for this long at the most: a
/// descendant that could not be found may hold them open.
const DRAIN_LIMIT: Duration = Duration::from_millis(500);
const SIGKILL: i32 = 9;
/// How long a fixture on another machine may take to be killed there.
const REMOTE_KILL: Duration = Duration::from_secs(1);

use copy::Copy;
use lines::Lines;
use outgoing::Outgoing;
pub use sharing::Next;
use sharing::Sharing;
use streams::{Buffers, read, receive, wait};
use throttle::Throttle;

/// What the suite's task asks of a process's task.
#[derive(Debug)]
pub enum Order {
    /// Let the host serve a further test, when it has done with the present one.
    ServeNext(Next),
    /// Write a request.
    Send(Option<u64>, Request),
    /// Write no more.
    CloseChannel,
    /// Get the stacks of its threads.
    TakeStack(StackSupport),
    /// Send a signal to its group.
    Signal(i32),
    /// Kill it and everything below it.
    KillTree,
    /// Ask the `alive` probes from now on.
    WatchAlive,
    /// Say whether it lives and these probes hold, after all that it has told so far.
    LookAlive(Probes),
}

impl Order {
    /// Whether it is a step of a stop, whose deadlines are not paused.
    #[must_use]
    pub fn stops(&self) -> bool {
        matches!(
            self,
            Self::Send(_, Request::Interrupt { .. })
                | Self::TakeStack(_)
                | Self::Signal(_)
                | Self::KillTree
        )
    }
}

/// What all processes of a run share.
#[derive(Debug)]
pub struct Shared {
    /// The thread that starts processes.
    pub spawner: Spawner,
    /// Where events go.
    pub sink: Arc<dyn Sink>,
    /// The folder of the run, to which paths of attachments are relative.
    pub run_folder: PathBuf,
    /// A folder for files that are gone when the run is over.
    pub scratch: PathBuf,
    /// The way to the guard.
    pub guard: Arc<Link>,
    /// The control groups, where there are any.
    pub cgroups: Option<Cgroups>,
}

/// What one process is.
#[derive(Debug)]
pub struct Job {
    /// Its id in the suite.
    pub host: HostId,
    /// Whose it is.
    pub source: Source,
    /// How to start it, unless it was started ahead.
    pub launch: Launch,
    /// Whether it gets a control group, where there are any.
    pub grouped: bool,
    /// Whether it says what it uses whenever it has to say that it lives, or, shared
    /// by tests, that one of them is over.
    pub measured: bool,
    /// Its probes, when it is a process fixture.
    pub process: Option<Arc<ProcessPlan>>,
}

/// Where a process's task tells what happened.
pub type Inputs = mpsc::Sender<(HostId, HostInput)>;

/// Runs a process to its end.
pub async fn run(
    mut job: Job,
    shared: Arc<Shared>,
    orders: mpsc::UnboundedReceiver<Order>,
    inputs: Inputs,
) {
    let host = job.host;
    if let Some(taken) = probe::already_answers(job.process.as_deref(), &job.launch.request).await {
        let reason = format!("{taken} answers already, before the fixture was started");
        return drop(inputs.send((host, HostInput::SpawnFailed(reason))).await);
    }
    let files = Files::now(job.process.as_ref().map_or(&[], |process| &process.ready));
    let groups = shared.cgroups.as_ref().filter(|_| job.grouped);
    match job.launch.start(&shared.spawner, groups).await {
        Ok(process) => {
            let mut task = Task::new(job, shared, process, inputs);
            task.tell_guard();
            task.open_gate().await;
            task.watch_ready(files);
            task.run(orders).await;
        }
        Err(error) => {
            let program = job.launch.request.command.first().map_or("", String::as_str);
            let reason = format!("`{program}` cannot be started: {error}");
            drop(inputs.send((host, HostInput::SpawnFailed(reason))).await);
        }
    }
}

/// Waits for the end of a copy, if there is one.
async fn copied(copy: &mut Option<Copy>) -> std::io::Result<()> {
    match copy {
        Some(copy) => copy.wait().await,
        None => std::future::pending().await,
    }
}

struct Task {
    job: Job,
    shared: Arc<Shared>,
    process: Process,
    inputs: Inputs,
    lines: Lines,
    outgoing: Outgoing,
    /// What belongs to which test, when several may share the host.
    sharing: Option<Sharing>,
    throttle: Throttle,
    /// What it told behind a file that is being copied.
    held: VecDeque<Result<FromHost, String>>,
    copy: Option<Copy>,
    /// It has to say that it lives, and which probes hold.
    looked_at: Option<Probes>,
    /// Probes and stack dumps; they end with the task.
    side: JoinSet<()>,
}

impl Task {
    fn new(job: Job, shared: Arc<Shared>, process: Process, inputs: Inputs) -> Self {
        Self {
            job,
            shared,
            process,
            inputs,
            lines: Lines::default(),
            outgoing: Outgoing::default(),
            sharing: None,
            throttle: Throttle::default(),
            held: VecDeque::new(),
            copy: None,
            looked_at: None,
            side: JoinSet::new(),
        }
    }

    /// Hooks and fixtures must be able to go on when the runner dies.
    fn tell_guard(&self) {
        let Process { channel, stdout, stderr, .. } = &self.process;
        let channel = channel.as_ref().map(|end| (Kept::Channel, end.as_fd()));
        let stdout = stdout.as_ref().map(|end| (Kept::Stdout, end.as_fd()));
        let stderr = stderr.as_ref().map(|end| (Kept::Stderr, end.as_fd()));
        let streams: Vec<_> = [channel, stdout, stderr].into_iter().flatten().collect();
        self.shared.guard.process_started(self.job.source, self.process.pid, &streams);
    }

    /// The guard knows the process: a hook's command may begin.
    async fn open_gate(&mut self) {
        if let Some(channel) = &mut self.process.channel
            && gate::is_behind(&self.job.launch.request.command)
        {
            // One that has ended is noticed by its exit.
            let _ = channel.write_all(gate::GO).await;
        }
    }

    fn watch_ready(&mut self, before: Files) {
        if let Some(plan) = &self.job.process {
            let probes = plan.ready.clone();
            self.side.spawn(self.watch().until_ready(probes, before));
        }
    }

    fn watch(&self) -> Watch {
        let like = self.job.launch.full_request();
        let asker = Asker { spawner: self.shared.spawner.clone(), like };
        Watch { host: self.job.host, inputs: self.inputs.clone(), asker }
    }

    async fn run(&mut self, mut orders: mpsc::UnboundedReceiver<Order>) {
        let mut buffers = Buffers::new();
        let status = loop {
            let is_throttled = self.throttle.is_throttled;
            let is_read = !is_throttled && self.copy.is_none();
            let process = &mut self.process;
            tokio::select! {
                biased;
                Some(order) = orders.recv() => self.obey(order).await,
                () = self.outgoing.write(&process.channel), if self.outgoing.has_work() => {}
                () = receive(&process.channel, &mut buffers.channel), if is_read => {
                    self.heard(&buffers.channel).await;
                    self.throttle().await;
                }
                () = std::future::ready(()), if self.looked_at.is_some() => self.look_alive().await,
                _ = read(&mut process.stdout, &mut buffers.stdout) =>
                    self.printed(Stream::Stdout, &buffers.stdout).await,
                _ = read(&mut process.stderr, &mut buffers.stderr) =>
                    self.printed(Stream::Stderr, &buffers.stderr).await,
                status = wait(&mut process.end) => break status,
                copied = copied(&mut self.copy) => self.copy_ended(copied).await,
                () = tokio::time::sleep(throttle::POLL), if is_throttled => self.throttle().await,
            }
        };
        self.end(status, &mut buffers, &mut orders).await;
        self.refuse(orders, status).await;
    }

    /// The process has ended: kill what it left, deliver what it said.
    async fn end(
        &mut self,
        status: ExitStatus,
        buffers: &mut Buffers,
        orders: &mut mpsc::UnboundedReceiver<Order>,
    ) {
        self.side.abort_all();
        // Tests are only grouped where each leak counts.
        let is_strict = self.job.grouped && matches!(self.job.source, Source::Test(_));
        let effort = if is_strict { Effort::Thorough } else { Effort::Once };
        let mut left = self.job.launch.sweep(effort).await;
        self.drain(buffers).await;
        self.finish_copies(orders).await;
        self.last_line(status).await;
        self.disown(&mut left);
        let _ = std::fs::remove_file(&self.job.launch.stack_file);
        self.shared.guard.process_ended(self.job.source, self.process.pid);
        let end = self.end_of(status, left);
        self.tell(end).await;
    }

    async fn obey(&mut self, order: Order) {
        let pid = self.process.pid;
        if order.stops() {
            self.throttle.is_stopping = true;
            self.throttle().await;
            self.give_copy_up().await;
        }
        match order {
            Order::ServeNext(next) => self.serve_next(next).await,
            Order::Send(id, request) => self.send(id, request).await,
            Order::CloseChannel => self.outgoing.close(),
            Order::Signal(signal) if self.is_remote() => self.signal_remote(signal),
            Order::Signal(signal) => {
                unix::signal_group(pid, signal);
            }
            Order::KillTree if self.is_remote() => {
                self.signal_remote(SIGKILL);
                // The connection may be stuck.
                self.side.spawn(async move {
                    tokio::time::sleep(REMOTE_KILL).await;
                    tree::kill_tree(pid);
                });
            }
            Order::KillTree => self.job.launch.kill(&self.process),
            Order::TakeStack(support) => self.take_stack(support).await,
            Order::WatchAlive => self.watch_alive(),
            Order::LookAlive(probes) => self.looked_at = Some(probes),
        }
    }

    async fn send(&mut self, id: Option<u64>, mut request: Request) {
        if let Request::RunTest(plugin) = &mut request {
            let (source, host) = (self.job.source, self.job.host);
            self.dress(plugin, (source, host), id.unwrap_or_default());
            if let (Some(mark), None) = (&plugin.end_marker, &self.sharing) {
                self.sharing = Some(Sharing::new(id.unwrap_or_default(), mark));
            }
        } else if let Request::TestFinished(TestFinishedParams { attachments_dir, .. }) =
            &mut request
        {
            let folder = self.shared.run_folder.join(self.attachments_dir());
            *attachments_dir = Some(folder.to_string_lossy().into_owned());
        }
        self.write(id, request);
    }

    fn write(&mut self, id: Option<u64>, request: Request) {
        if let Ok(line) = codec::encode(id, request) {
            // A host that is gone or does not read is noticed by its exit or its limit.
            self.outgoing.push(&line);
        }
    }

    async fn take_stack(&mut self, support: StackSupport) {
        if support == StackSupport::Message {
            self.send(None, Request::DumpStack {}).await;
        }
        let (inputs, host, pid) = (self.inputs.clone(), self.job.host, self.process.pid);
        let (spawner, file) = (self.shared.spawner.clone(), self.job.launch.stack_file.clone());
        self.side.spawn(async move {
            let text = stack::dump(pid, support, &file, &spawner).await;
            drop(inputs.send((host, HostInput::StackTaken(text))).await);
        });
    }

    fn watch_alive(&mut self) {
        if let Some(plan) = &self.job.process {
            let probes = plan.alive.clone();
            self.side.spawn(self.watch().until_unwell(probes));
        }
    }

    async fn tell(&self, input: HostInput) {
        drop(self.inputs.send((self.job.host, input)).await);
    }
}
