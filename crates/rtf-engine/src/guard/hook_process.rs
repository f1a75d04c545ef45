//! Supervises a hook's process until it ends: reads its streams, enforces its limit, and
//! judges it.

use std::os::fd::OwnedFd;
use std::time::{Duration, Instant};

use rtf_model::protocol::Notification;
use rtf_model::{EventKind, ExitStatus, HookId, Output, Source, Stream};
use rtf_process::codec::{self, HostMessage};
use rtf_process::task::ProcessStream;
use rtf_process::tree::{self, SignalReach, Tree};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::journal_close::TimedEvent;
use super::unix::{self, GuardSignals};
use crate::hook::{HOOK_KILLED, HookJudgement, RUN_REQUEST};

/// The time between SIGTERM and the kill.
const TERM_GRACE: Duration = Duration::from_secs(1);
/// The interval between checks of the processes that a stopped hook has left.
const POLL_INTERVAL: Duration = Duration::from_millis(5);
/// The limit for reading the outputs of an ended process.
const DRAIN_LIMIT: Duration = Duration::from_millis(500);
/// The longest output kept of each stream, in bytes.
const OUTPUT_LIMIT: usize = 256 * 1024;
/// The capacity of a pipe.
const READ_BYTES: usize = 64 * 1024;

pub type StreamEnds = Vec<(ProcessStream, OwnedFd)>;

#[derive(Debug)]
pub(super) struct HookProcess {
    pub hook: HookId,
    pub pid: i32,
    pub scope: String,
    pub streams: StreamEnds,
    pub deadline: Instant,
    pub judgement: HookJudgement,
}

/// Waits for the end of the process. Returns its problem, if any, and its events.
pub(super) fn supervise(
    process: HookProcess,
    signals: &mut GuardSignals,
) -> (Option<String>, Vec<TimedEvent>) {
    let HookProcess { hook, pid, scope, streams, deadline, judgement } = process;
    let mut supervisor = HookSupervisor {
        source: Source::Hook(hook),
        pid,
        tree: Tree::new(pid, &scope),
        streams,
        deadline,
        judgement,
        kills: 0,
        line: Vec::new(),
        outputs: [CappedOutput::default(), CappedOutput::default()],
        events: Vec::new(),
    };
    let status = supervisor.wait_for_end(signals);
    supervisor.record_outputs();
    (supervisor.judgement.finish(Some(status)), supervisor.events)
}

struct HookSupervisor {
    source: Source,
    pid: i32,
    tree: Tree,
    streams: StreamEnds,
    deadline: Instant,
    judgement: HookJudgement,
    kills: u32,
    line: Vec<u8>,
    outputs: [CappedOutput; 2],
    events: Vec<TimedEvent>,
}

#[derive(Default)]
struct CappedOutput {
    bytes: Vec<u8>,
    omitted: u64,
}

impl HookSupervisor {
    fn wait_for_end(&mut self, signals: &mut GuardSignals) -> ExitStatus {
        loop {
            match unix::ended(self.pid) {
                Ok(Some(status)) => {
                    self.tree.leader_ended();
                    self.wait_for_tree(signals);
                    // A leftover process may continue to write.
                    let end = Instant::now() + DRAIN_LIMIT;
                    while self.read(None, Duration::ZERO) && Instant::now() < end {}
                    return status;
                }
                Ok(None) => {}
                Err(_) => return ExitStatus::Code(-1),
            }
            if signals.requests_kill() {
                self.judgement.fail(HOOK_KILLED);
                tree::kill_tree(self.pid);
            } else if self.deadline <= Instant::now() {
                self.on_deadline();
            }
            let left = self.deadline.saturating_duration_since(Instant::now());
            self.read(Some(signals), left);
        }
    }

    /// After a stop, the processes that are left have the rest of the grace.
    fn wait_for_tree(&mut self, signals: &mut GuardSignals) {
        while self.kills == 1
            && self.deadline > Instant::now()
            && !signals.requests_kill()
            && !self.tree.living(&[]).is_empty()
        {
            self.read(Some(signals), POLL_INTERVAL);
        }
        if self.kills > 0 {
            self.tree.kill(&[]);
        }
    }

    fn on_deadline(&mut self) {
        self.judgement.limit_passed();
        match self.kills {
            0 => self.tree.signal(libc::SIGTERM, SignalReach::Tree, &[]),
            _ => self.tree.kill(&[]),
        }
        self.kills += 1;
        self.deadline = Instant::now() + TERM_GRACE;
    }

    /// Waits for data or a signal, and reads all streams. Returns whether there was data.
    fn read(&mut self, signals: Option<&mut GuardSignals>, timeout: Duration) -> bool {
        let streams = std::mem::take(&mut self.streams);
        let mut fds: Vec<_> =
            streams.iter().map(|(_, end)| PollFd::new(end, PollFlags::IN)).collect();
        fds.extend(signals.as_deref().map(|signals| PollFd::new(signals, PollFlags::IN)));
        let timeout = Timespec::try_from(timeout).ok();
        let polled = poll(&mut fds, timeout.as_ref()).unwrap_or(0);
        let ready: Vec<bool> =
            fds.iter().map(|fd| polled > 0 && !fd.revents().is_empty()).collect();
        drop(fds);
        if let Some(signals) = signals {
            signals.read();
        }
        let mut has_read = false;
        let mut bytes = vec![0; READ_BYTES];
        for ((stream, end), is_ready) in streams.into_iter().zip(ready) {
            let read = match is_ready {
                true => rustix::io::read(&end, &mut bytes[..]),
                false => Err(rustix::io::Errno::AGAIN),
            };
            match read {
                Ok(read @ 1..) => {
                    has_read = true;
                    self.received(stream, &bytes[..read]);
                    self.streams.push((stream, end));
                }
                Err(rustix::io::Errno::AGAIN | rustix::io::Errno::INTR) => {
                    self.streams.push((stream, end));
                }
                Ok(0) | Err(_) => self.closed(stream),
            }
        }
        has_read
    }

    fn closed(&mut self, stream: ProcessStream) {
        if stream == ProcessStream::Channel && !self.line.is_empty() {
            let line = std::mem::take(&mut self.line);
            self.process_line(&line);
        }
    }

    fn received(&mut self, stream: ProcessStream, bytes: &[u8]) {
        let stream = match stream {
            ProcessStream::Stdout => Stream::Stdout,
            ProcessStream::Stderr => Stream::Stderr,
            ProcessStream::Channel => return self.received_from_channel(bytes),
        };
        self.judgement.printed(stream, bytes);
        let output = &mut self.outputs[stream as usize];
        let room = OUTPUT_LIMIT.saturating_sub(output.bytes.len()).min(bytes.len());
        output.bytes.extend_from_slice(&bytes[..room]);
        output.omitted += (bytes.len() - room) as u64;
    }

    fn received_from_channel(&mut self, bytes: &[u8]) {
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend_from_slice(piece);
            if self.line.ends_with(b"\n") {
                let mut line = std::mem::take(&mut self.line);
                line.pop();
                self.process_line(&line);
            }
        }
        if self.line.len() > codec::LINE_LIMIT {
            self.line = Vec::new();
        }
    }

    fn process_line(&mut self, line: &[u8]) {
        match codec::decode(line) {
            Ok(HostMessage::Notification(notification)) => {
                self.judgement.notified(&notification);
                if let Notification::Message(message) = notification {
                    self.record(EventKind::Message { source: self.source, message, test: None });
                }
            }
            Ok(HostMessage::Reply(RUN_REQUEST, reply)) => self.judgement.replied(reply),
            Ok(HostMessage::Reply(..)) => {}
            Err(what) => self.judgement.protocol_violated(&what),
        }
    }

    fn record(&mut self, kind: EventKind) {
        self.events.push(TimedEvent { at: Instant::now(), kind });
    }

    fn record_outputs(&mut self) {
        let source = self.source;
        for stream in [Stream::Stdout, Stream::Stderr] {
            let CappedOutput { bytes, omitted } =
                std::mem::take(&mut self.outputs[stream as usize]);
            let text = String::from_utf8_lossy(&bytes).into_owned();
            if !text.is_empty() {
                self.record(EventKind::Output(Output { source, stream, omitted_bytes: 0, text }));
            }
            if omitted > 0 {
                let (omitted_bytes, text) = (omitted, String::new());
                self.record(EventKind::Output(Output { source, stream, omitted_bytes, text }));
            }
        }
    }
}
