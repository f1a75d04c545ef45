//! The task that supervises one process, from its start until its leftover processes are
//! killed.
//!
//! It carries out [`ProcessCommand`]s and reports [`ProcessEvent`]s. It delivers
//! everything that the process sent and printed before the end of the process.

mod attached;
mod attachments;
mod command;
mod debugger;
mod event;
mod file_copy;
mod input;
mod job;
mod line_assembly;
mod pictures;
mod probing;
mod references;
mod remains;
mod shared_host;
mod streams;
mod throttle;
mod trajectories;
mod write_queue;

use std::collections::VecDeque;
use std::os::fd::AsFd;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::{Notification, Request, StackSupport, TestFinishedParams};
use rtf_model::{ExitStatus, Stream};
use tokio::io::AsyncWriteExt;
use tokio::sync::mpsc;
use tokio::task::JoinSet;

pub use attached::{AttachedJob, watch_attached};
pub use command::{Assignment, ProcessCommand};
pub use event::{EventSender, HostId, ProcessEvent};
pub use job::{ProcessJob, ProcessOwner, ProcessStream, TaskContext};

use crate::codec::{self, HostMessage};
use crate::probe::{self, FileVersions, ProbeSelection};
use crate::process::StartedProcess;
use crate::spawn_request::ProcessRole;
use crate::tree::{Effort, SignalReach, Tree};
use crate::{ssh, stack_dump, start_failure, start_gate, tree};
use debugger::DebuggerWait;
use file_copy::FileCopy;
use line_assembly::LineAssembly;
use remains::TreeStop;
use shared_host::SharedHost;
use streams::{Buffers, read, receive, wait};
use throttle::Throttle;
use trajectories::SampledSignals;
use write_queue::WriteQueue;

/// How long the end of a test's process by a signal of others waits for a stop of the run: who
/// ends a job, such as the scheduler of a cluster, signals all its processes at the same time.
const STOP_DELAY: Duration = Duration::from_millis(200);

/// The limit for reading the outputs of an ended process: an unknown descendant may hold
/// them open.
const DRAIN_LIMIT: Duration = Duration::from_millis(500);
const SIGKILL: i32 = 9;
/// How long the remote shell may take to kill its processes.
const REMOTE_KILL_LIMIT: Duration = Duration::from_secs(1);

/// Runs a process until its end.
pub async fn run_process(
    mut job: ProcessJob,
    context: Arc<TaskContext>,
    commands: mpsc::UnboundedReceiver<ProcessCommand>,
    events: EventSender,
) {
    if let Some(address) = probe::address_in_use(job.probes.as_ref()).await {
        let reason = format!("{address} answers already, before the fixture was started");
        return drop(events.send((job.host, ProcessEvent::SpawnFailed(reason))).await);
    }
    let files = FileVersions::now(job.probes.as_ref());
    let groups = context.cgroups.as_ref().filter(|_| job.is_grouped);
    match job.launch.start(&context.spawner, groups).await {
        Ok(process) => {
            let mut task = ProcessTask::new(job, context, process, events);
            task.report_started();
            task.open_start_gate().await;
            task.watch_ready(files);
            task.run(commands).await;
        }
        Err(error) => {
            let program = job.launch.request.command.first().map_or("", String::as_str);
            let why = start_failure::describe(program, &error);
            let reason = format!("`{program}` cannot be started: {why}");
            drop(events.send((job.host, ProcessEvent::SpawnFailed(reason))).await);
        }
    }
}

/// Whether a process was ended by SIGHUP, SIGINT or SIGTERM, or reports that it was.
fn is_stop(status: ExitStatus) -> bool {
    matches!(status, ExitStatus::Signal(1 | 2 | 15) | ExitStatus::Code(129 | 130 | 143))
}

async fn copied(copy: &mut Option<FileCopy>) -> std::io::Result<Vec<Notification>> {
    match copy {
        Some(copy) => copy.wait().await,
        None => std::future::pending().await,
    }
}

struct ProcessTask {
    job: ProcessJob,
    context: Arc<TaskContext>,
    process: StartedProcess,
    events: EventSender,
    lines: LineAssembly,
    outgoing: WriteQueue,
    /// Set for a host that may serve several assignments.
    shared: Option<SharedHost>,
    throttle: Throttle,
    /// The messages received after an attachment that is being copied.
    held_back: VecDeque<Result<HostMessage, String>>,
    copy: Option<FileCopy>,
    /// The samples of the test, for comparisons.
    samples: SampledSignals,
    /// The signals that were compared, in order.
    trajectories: Vec<String>,
    /// The pictures that were compared, in order.
    pictures: Vec<String>,
    debugger: DebuggerWait,
    /// The requested liveness check.
    check: Option<ProbeSelection>,
    /// Probes and stack dumps; they end with the task.
    background: JoinSet<()>,
    stop: TreeStop,
}

impl ProcessTask {
    fn new(
        job: ProcessJob,
        context: Arc<TaskContext>,
        process: StartedProcess,
        events: EventSender,
    ) -> Self {
        let debugger = match job.waits_for_debugger {
            true => DebuggerWait::Starting,
            false => DebuggerWait::Over,
        };
        let stop = TreeStop::new(Tree::new(process.pid, &job.launch.scope));
        Self {
            job,
            context,
            process,
            events,
            lines: LineAssembly::default(),
            outgoing: WriteQueue::default(),
            shared: None,
            throttle: Throttle::default(),
            held_back: VecDeque::new(),
            copy: None,
            samples: SampledSignals::default(),
            trajectories: Vec::new(),
            pictures: Vec::new(),
            debugger,
            check: None,
            background: JoinSet::new(),
            stop,
        }
    }

    fn report_started(&self) {
        let StartedProcess { channel, stdout, stderr, .. } = &self.process;
        let channel = channel.as_ref().map(|end| (ProcessStream::Channel, end.as_fd()));
        let stdout = stdout.as_ref().map(|end| (ProcessStream::Stdout, end.as_fd()));
        let stderr = stderr.as_ref().map(|end| (ProcessStream::Stderr, end.as_fd()));
        let streams: Vec<_> = [channel, stdout, stderr].into_iter().flatten().collect();
        self.job.owner.process_started(self.process.pid, &streams);
    }

    async fn open_start_gate(&mut self) {
        if let Some(channel) = &mut self.process.channel
            && start_gate::is_behind(&self.job.launch.request.command)
        {
            // A process that has ended is noticed by its exit.
            let _ = channel.write_all(start_gate::GO).await;
        }
    }

    async fn run(&mut self, mut commands: mpsc::UnboundedReceiver<ProcessCommand>) {
        let mut buffers = Buffers::new();
        let status = loop {
            let is_throttled = self.throttle.is_throttled;
            let is_read = !is_throttled && self.copy.is_none();
            let process = &mut self.process;
            tokio::select! {
                biased;
                Some(command) = commands.recv() => self.carry_out(command).await,
                () = self.outgoing.write(&process.channel),
                    if self.outgoing.has_work() && self.debugger.is_over() => {}
                () = self.debugger.attached(), if !self.debugger.is_over() =>
                    self.debugger = DebuggerWait::Over,
                () = receive(&process.channel, &mut buffers.channel), if is_read => {
                    self.wait_for_debugger();
                    self.received(&buffers.channel).await;
                    self.update_throttle().await;
                }
                () = std::future::ready(()), if self.check.is_some() => self.check_alive().await,
                _ = read(&mut process.stdout, &mut buffers.stdout) =>
                    self.printed(Stream::Stdout, &buffers.stdout).await,
                _ = read(&mut process.stderr, &mut buffers.stderr) =>
                    self.printed(Stream::Stderr, &buffers.stderr).await,
                status = wait(&mut process.end), if self.stop.leader().is_none() =>
                    if let Some(status) = self.on_leader_end(status, &mut buffers).await {
                        break status;
                    },
                () = self.stop.next_end() =>
                    if let Some(status) = self.await_next() {
                        break status;
                    },
                result = copied(&mut self.copy) => self.copy_finished(result).await,
                () = tokio::time::sleep(throttle::POLL_INTERVAL), if is_throttled =>
                    self.update_throttle().await,
            }
        };
        self.finish(status, &mut buffers, &mut commands).await;
        self.refuse_assignments(commands, status).await;
    }

    /// The process has ended: kills leftover processes and delivers remaining output.
    async fn finish(
        &mut self,
        status: ExitStatus,
        buffers: &mut Buffers,
        commands: &mut mpsc::UnboundedReceiver<ProcessCommand>,
    ) {
        self.background.abort_all();
        // What follows is printed on a terminal with its usual settings.
        self.process.foreground = None;
        // Hosts of tests are only in a group if each leak counts.
        let is_strict = self.job.is_grouped && self.role() == Some(ProcessRole::Test);
        let effort = if is_strict { Effort::Thorough } else { Effort::Once };
        self.await_helpers().await;
        let found = self.job.launch.sweep(effort).await;
        let mut left = self.stop.leaked(found);
        self.drain(buffers, DRAIN_LIMIT).await;
        self.finish_copies(commands).await;
        self.deliver_last_line(status).await;
        self.rename_leak_owner(&mut left);
        let _ = std::fs::remove_file(&self.job.launch.stack_file);
        self.job.owner.process_ended(self.process.pid);
        if self.role() == Some(ProcessRole::Test) && !self.throttle.is_stopping && is_stop(status) {
            tokio::time::sleep(STOP_DELAY).await;
        }
        let end = self.final_event(status, left);
        self.report(end).await;
    }

    async fn carry_out(&mut self, command: ProcessCommand) {
        let pid = self.process.pid;
        if command.stops() {
            self.throttle.is_stopping = true;
            self.update_throttle().await;
            self.abandon_copy().await;
            if !self.debugger.is_over() {
                // The test has not begun: there is nothing to tear down.
                return self.kill_tree();
            }
        }
        match command {
            ProcessCommand::Assign(assignment) => self.assign(assignment),
            ProcessCommand::Send(id, request) => self.send(id, request),
            ProcessCommand::CloseChannel => self.outgoing.close(),
            ProcessCommand::Signal(signal, reach) if self.is_remote_alive() => {
                self.signal_remote(signal, reach);
            }
            ProcessCommand::Signal(signal, reach) => self.signal_tree(signal, reach),
            ProcessCommand::KillTree if self.is_remote_alive() => {
                self.signal_remote(SIGKILL, SignalReach::Tree);
                // The connection may be stuck.
                self.background.spawn(async move {
                    tokio::time::sleep(REMOTE_KILL_LIMIT).await;
                    tree::kill_tree(pid);
                });
            }
            ProcessCommand::KillTree => self.kill_tree(),
            ProcessCommand::DumpStack(support, wait) => self.dump_stack(support, wait),
            ProcessCommand::WatchAlive => self.watch_alive(),
            // Its end was reported.
            ProcessCommand::CheckAlive(_) if self.stop.leader().is_some() => {}
            ProcessCommand::CheckAlive(selection) => self.check = Some(selection),
        }
    }

    fn role(&self) -> Option<ProcessRole> {
        self.job.launch.request.role
    }

    /// Whether a remote shell gets its signals.
    fn is_remote_alive(&self) -> bool {
        self.stop.tree.has_leader() && ssh::is_remote(&self.job.launch.request.command)
    }

    fn signal_remote(&mut self, signal: i32, reach: SignalReach) {
        // A stuck connection is noticed by its limit.
        self.outgoing.push(&ssh::signal_line(signal, reach));
    }

    fn send(&mut self, id: Option<u64>, mut request: Request) {
        if matches!(request, Request::Interrupt { .. } | Request::TearDownFixture {}) {
            self.begin_tree_stop();
        }
        if let Request::RunTest(plugin) = &mut request {
            self.complete(plugin, &self.job.attachments_dir, id.unwrap_or_default());
            if let (Some(marker), None) = (&plugin.end_marker, &self.shared) {
                self.shared = Some(SharedHost::new(id.unwrap_or_default(), marker));
            }
        } else if let Request::TestFinished(TestFinishedParams { attachments_dir, .. }) =
            &mut request
        {
            *attachments_dir = Some(self.absolute(&self.job.attachments_dir));
        }
        self.write(id, request);
    }

    fn write(&mut self, id: Option<u64>, request: Request) {
        if let Ok(line) = codec::encode(id, request) {
            // A host that has ended or does not read is noticed by its exit or its limit.
            self.outgoing.push(&line);
        }
    }

    fn dump_stack(&mut self, support: StackSupport, wait: Duration) {
        if support == StackSupport::Message {
            self.send(None, Request::DumpStack {});
        }
        let (events, host, pid) = (self.events.clone(), self.job.host, self.process.pid);
        let (spawner, file) = (self.context.spawner.clone(), self.job.launch.stack_file.clone());
        self.background.spawn(async move {
            let text = stack_dump::dump(pid, (support, wait), &file, &spawner).await;
            drop(events.send((host, ProcessEvent::StackDumped(text))).await);
        });
    }

    async fn report(&self, event: ProcessEvent) {
        drop(self.events.send((self.job.host, event)).await);
    }
}
