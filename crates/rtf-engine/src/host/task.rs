//! The task around one process: from its start to the sweep of what it left.
//!
//! It carries orders to the process, and tells the suite's task what the
//! process said, printed, and how it ended. Everything that the process said
//! and printed is delivered before its end is told.

mod far;
mod keep;
mod sharing;
mod streams;

use std::os::fd::AsFd;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use rtf_model::protocol::{Notification, Request, StackSupport, TestEnds};
use rtf_model::{ExitStatus, Source, Stream};
use tokio::io::AsyncWriteExt;
use tokio::sync::mpsc;
use tokio::task::JoinSet;

use super::cgroup::Cgroups;
use super::codec::{self, FromHost, LINE_LIMIT};
use super::dying::is_dying;
use super::launch::Launch;
use super::spawner::{Process, Spawner};
use super::{stack, tree, unix, usage};
use crate::guard::{Kept, Link, gate};
use crate::plan::ProcessPlan;
use crate::run::Sink;
use crate::run::machine::{HostId, HostInput};
use crate::run::probe::{self, Asker, Watch};

/// After its end, a process's outputs are read for this long at the most: a
/// descendant that could not be found may hold them open.
const DRAIN_LIMIT: Duration = Duration::from_millis(500);
/// How often a task that waits for slow reporters looks again.
const CONGESTED_WAIT: Duration = Duration::from_millis(1);
const SIGKILL: i32 = 9;
/// How long a fixture on another machine may take to be killed there.
const REMOTE_KILL: Duration = Duration::from_secs(1);

pub use sharing::Next;
use sharing::Sharing;
use streams::{Buffers, read, wait};

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
    /// Say whether it lives, after all that it has told so far.
    LookAlive,
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
    let started_at = SystemTime::now();
    let groups = shared.cgroups.as_ref().filter(|_| job.grouped);
    match job.launch.start(&shared.spawner, groups).await {
        Ok(process) => {
            let mut task = Task::new(job, shared, process, inputs);
            task.tell_guard();
            task.open_gate().await;
            task.watch_ready(started_at);
            task.run(orders).await;
        }
        Err(error) => {
            let program = job.launch.request.command.first().map_or("", String::as_str);
            let reason = format!("`{program}` cannot be started: {error}");
            drop(inputs.send((host, HostInput::SpawnFailed(reason))).await);
        }
    }
}

struct Task {
    job: Job,
    shared: Arc<Shared>,
    process: Process,
    inputs: Inputs,
    line: Vec<u8>,
    /// What belongs to which test, when several may share the host.
    sharing: Option<Sharing>,
    /// How often it has to say that it lives.
    looked_at: u32,
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
            line: Vec::new(),
            sharing: None,
            looked_at: 0,
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

    fn watch_ready(&mut self, started_at: SystemTime) {
        if let Some(plan) = &self.job.process {
            let probes = plan.ready.clone();
            self.side.spawn(self.watch().until_ready(probes, Some(started_at)));
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
            let congested = self.shared.sink.is_congested();
            let process = &mut self.process;
            tokio::select! {
                biased;
                Some(order) = orders.recv() => self.obey(order).await,
                _ = read(&mut process.channel, &mut buffers.channel), if !congested =>
                    self.heard(&buffers.channel).await,
                () = std::future::ready(()), if self.looked_at > 0 => self.look_alive().await,
                _ = read(&mut process.stdout, &mut buffers.stdout), if !congested =>
                    self.printed(Stream::Stdout, &buffers.stdout).await,
                _ = read(&mut process.stderr, &mut buffers.stderr), if !congested =>
                    self.printed(Stream::Stderr, &buffers.stderr).await,
                status = wait(&mut process.end) => break status,
                () = tokio::time::sleep(CONGESTED_WAIT), if congested => {}
            }
        };
        self.end(status, &mut buffers).await;
    }

    /// The process has ended: kill what it left, deliver what it said.
    async fn end(&mut self, status: ExitStatus, buffers: &mut Buffers) {
        self.side.abort_all();
        let mut left = self.job.launch.sweep().await;
        let _ = tokio::time::timeout(DRAIN_LIMIT, self.drain(buffers)).await;
        self.last_line(status).await;
        self.disown(&mut left);
        let _ = std::fs::remove_file(&self.job.launch.stack_file);
        self.shared.guard.process_ended(self.job.source, self.process.pid);
        let end = self.end_of(status, left);
        self.tell(end).await;
    }

    /// A line without an end, which is no fault of one that was killed while it wrote.
    async fn last_line(&mut self, status: ExitStatus) {
        let shared = self.sharing.as_mut().map(Sharing::take_rest);
        let line = shared.unwrap_or_else(|| std::mem::take(&mut self.line));
        if !line.is_empty() && matches!(status, ExitStatus::Code(_)) {
            self.understand(codec::decode(&line)).await;
        }
    }

    async fn drain(&mut self, buffers: &mut Buffers) {
        while self.is_open() {
            let process = &mut self.process;
            tokio::select! {
                _ = read(&mut process.channel, &mut buffers.channel) =>
                    self.heard(&buffers.channel).await,
                _ = read(&mut process.stdout, &mut buffers.stdout) =>
                    self.printed(Stream::Stdout, &buffers.stdout).await,
                _ = read(&mut process.stderr, &mut buffers.stderr) =>
                    self.printed(Stream::Stderr, &buffers.stderr).await,
            }
        }
    }

    fn is_open(&self) -> bool {
        let Process { channel, stdout, stderr, .. } = &self.process;
        channel.is_some() || stdout.is_some() || stderr.is_some()
    }

    async fn obey(&mut self, order: Order) {
        let pid = self.process.pid;
        match order {
            Order::ServeNext(next) => self.serve_next(next).await,
            Order::Send(id, request) => self.send(id, request).await,
            Order::CloseChannel => {
                if let Some(channel) = &mut self.process.channel {
                    let _ = channel.shutdown().await;
                }
            }
            Order::Signal(signal) if self.is_remote() => self.signal_remote(signal).await,
            Order::Signal(signal) => {
                unix::signal_group(pid, signal);
            }
            Order::KillTree if self.is_remote() => {
                self.signal_remote(SIGKILL).await;
                // The connection may be stuck.
                self.side.spawn(async move {
                    tokio::time::sleep(REMOTE_KILL).await;
                    tree::kill_tree(pid);
                });
            }
            Order::KillTree => self.job.launch.kill(&self.process),
            Order::TakeStack(support) => self.take_stack(support).await,
            Order::WatchAlive => self.watch_alive(),
            Order::LookAlive => self.looked_at += 1,
        }
    }

    async fn look_alive(&mut self) {
        self.looked_at -= 1;
        if is_dying(self.process.pid) {
            self.tell(HostInput::Dies).await;
        } else {
            if self.job.measured {
                let usage = usage::of(self.process.pid, &self.job.launch.scope);
                self.tell(HostInput::Uses { usage, served: None }).await;
            }
            self.tell(HostInput::Lives).await;
        }
    }

    async fn send(&mut self, id: Option<u64>, mut request: Request) {
        if let Request::RunTest(plugin) = &mut request {
            let (source, host) = (self.job.source, self.job.host);
            self.dress(plugin, (source, host), id.unwrap_or_default());
            if let (Some(mark), None) = (&plugin.shared, &self.sharing) {
                self.sharing = Some(Sharing::new(id.unwrap_or_default(), mark));
            }
        } else if let Request::TestFinished(TestEnds { keep_folder, .. }) = &mut request {
            let folder = self.shared.run_folder.join(self.keep_folder());
            *keep_folder = Some(folder.to_string_lossy().into_owned());
        }
        self.write(id, request).await;
    }

    async fn write(&mut self, id: Option<u64>, request: Request) {
        if let (Ok(line), Some(channel)) = (codec::encode(id, request), &mut self.process.channel) {
            // A host that is gone or does not read is noticed by its exit or its limit.
            let _ = tokio::time::timeout(DRAIN_LIMIT, channel.write_all(&line)).await;
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

    /// Bytes came over the channel; none when it was closed.
    async fn heard(&mut self, bytes: &[u8]) {
        if self.sharing.is_some() {
            return self.heard_shared(bytes).await;
        }
        if bytes.is_empty() {
            // What it was saying is understood when it is known how it ended.
            self.process.channel = None;
            return;
        }
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            match piece.strip_suffix(b"\n") {
                Some(end) if self.line.is_empty() => self.understand(codec::decode(end)).await,
                Some(end) => {
                    let mut line = std::mem::take(&mut self.line);
                    line.extend_from_slice(end);
                    self.understand(codec::decode(&line)).await;
                }
                None => self.line.extend_from_slice(piece),
            }
        }
        if self.line.len() > LINE_LIMIT {
            self.line = Vec::new();
            let what = format!("it wrote a line of more than {LINE_LIMIT} bytes");
            self.tell(HostInput::Garbage(what)).await;
        }
    }

    async fn understand(&mut self, heard: Result<FromHost, String>) {
        let input = match heard {
            Ok(FromHost::Told(Notification::Attached(attachment))) => {
                HostInput::Attached(self.keep(attachment).await)
            }
            Ok(FromHost::Told(notification)) => HostInput::Told(notification),
            Ok(FromHost::Answered(id, reply)) => HostInput::Answered(id, reply),
            Err(what) => HostInput::Garbage(what),
        };
        self.tell(input).await;
    }

    async fn printed(&mut self, stream: Stream, bytes: &[u8]) {
        if self.sharing.is_some() {
            return self.printed_shared(stream, bytes).await;
        }
        if bytes.is_empty() {
            match stream {
                Stream::Stdout => self.process.stdout = None,
                Stream::Stderr => self.process.stderr = None,
            }
        } else {
            self.tell(HostInput::Printed(stream, bytes.to_vec())).await;
        }
    }

    async fn tell(&self, input: HostInput) {
        drop(self.inputs.send((self.job.host, input)).await);
    }
}
