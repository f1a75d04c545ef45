//! Stands by a hook's process until it ends: listens, keeps its limit, judges.

use std::time::{Duration, Instant};

use rtf_model::protocol::{Answer, Notification, Reply};
use rtf_model::{EventKind, ExitStatus, MessageKind, Outcome, Output, Source, Stream};
use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::closing::Happened;
use super::duties::Streams;
use super::hook::{Process, RUN};
use super::note::Hook;
use super::unix::{self, Signals};
use crate::run::machine::HOOK_KILLED;
use rtf_process::codec::{self, HostMessage};
use rtf_process::task::ProcessStream;
use rtf_process::tree;

/// How long a hook that was asked to stop may take.
const TERM_GRACE: Duration = Duration::from_secs(1);
/// After its end, its outputs are read for this long at the most.
const DRAIN_LIMIT: Duration = Duration::from_millis(500);
/// How much of what a hook prints to one stream is kept, in bytes.
const KEPT: usize = 256 * 1024;
/// How much is read at once: what a pipe holds at most.
const READ_BYTES: usize = 64 * 1024;

/// What came of it.
#[derive(Debug)]
pub struct Attended {
    /// Why the robot may not be in a safe state.
    pub problem: Option<String>,
    /// What it said and printed.
    pub happened: Vec<Happened>,
}

/// Waits for the end of a hook's process.
pub(super) fn attend(hook: &Hook, process: Process, signals: &mut Signals) -> Attended {
    let mut attendant = Attendant {
        hook,
        deadline: process.limit,
        process,
        force: 0,
        line: Vec::new(),
        printed: [Printed::default(), Printed::default()],
        answer: None,
        problem: None,
        happened: Vec::new(),
    };
    let status = attendant.wait_for_end(signals);
    attendant.judge(status)
}

struct Attendant<'a> {
    hook: &'a Hook,
    process: Process,
    deadline: Instant,
    force: u32,
    line: Vec<u8>,
    printed: [Printed; 2],
    answer: Option<Answer>,
    problem: Option<String>,
    happened: Vec<Happened>,
}

#[derive(Default)]
struct Printed {
    bytes: Vec<u8>,
    omitted: u64,
}

impl Attendant<'_> {
    fn wait_for_end(&mut self, signals: &mut Signals) -> ExitStatus {
        loop {
            match unix::ended(self.process.pid) {
                Ok(Some(status)) => {
                    // What it wrote before its end is there; what it left may write on.
                    let end = Instant::now() + DRAIN_LIMIT;
                    while self.read(None, Some(Duration::ZERO)) && Instant::now() < end {}
                    return status;
                }
                Ok(None) => {}
                Err(_) => return ExitStatus::Code(-1),
            }
            if signals.kill() {
                self.note(HOOK_KILLED.to_owned());
                tree::kill_tree(self.process.pid);
            } else if self.deadline <= Instant::now() {
                self.limit_passed();
            }
            let left = self.deadline.saturating_duration_since(Instant::now());
            self.read(Some(signals), Some(left));
        }
    }

    fn limit_passed(&mut self) {
        self.note(format!("it did not end within {:?}", self.hook.limit));
        match self.force {
            0 => rtf_process::signal_group(self.process.pid, libc::SIGTERM),
            _ => tree::kill_tree(self.process.pid),
        }
        self.force += 1;
        self.deadline = Instant::now() + TERM_GRACE;
    }

    /// Reads what comes within a time, from a signal on; whether it read something.
    fn read(&mut self, signals: Option<&mut Signals>, timeout: Option<Duration>) -> bool {
        let streams = std::mem::take(&mut self.process.streams);
        let mut fds: Vec<_> =
            streams.iter().map(|(_, end)| PollFd::new(end, PollFlags::IN)).collect();
        fds.extend(signals.as_deref().map(|signals| PollFd::new(signals, PollFlags::IN)));
        let timeout = timeout.and_then(|timeout| Timespec::try_from(timeout).ok());
        let polled = poll(&mut fds, timeout.as_ref()).unwrap_or(0);
        let ready: Vec<bool> =
            fds.iter().map(|fd| polled > 0 && !fd.revents().is_empty()).collect();
        drop(fds);
        if let Some(signals) = signals {
            signals.read();
        }
        let mut any = false;
        let mut open = Streams::new();
        let mut bytes = vec![0; READ_BYTES];
        for ((kind, end), ready) in streams.into_iter().zip(ready) {
            let read = match ready {
                true => rustix::io::read(&end, &mut bytes[..]),
                false => Err(rustix::io::Errno::AGAIN),
            };
            match read {
                Ok(0) => self.closed(kind),
                Ok(read) => {
                    any = true;
                    self.take(kind, &bytes[..read]);
                    open.push((kind, end));
                }
                Err(rustix::io::Errno::AGAIN | rustix::io::Errno::INTR) => open.push((kind, end)),
                Err(_) => self.closed(kind),
            }
        }
        self.process.streams = open;
        any
    }

    fn closed(&mut self, kind: ProcessStream) {
        if kind == ProcessStream::Channel && !self.line.is_empty() {
            let line = std::mem::take(&mut self.line);
            self.understand(&line);
        }
    }

    fn take(&mut self, kind: ProcessStream, bytes: &[u8]) {
        let stream = match kind {
            ProcessStream::Stdout => Stream::Stdout,
            ProcessStream::Stderr => Stream::Stderr,
            ProcessStream::Channel => return self.heard(bytes),
        };
        let printed = &mut self.printed[stream as usize];
        let room = KEPT.saturating_sub(printed.bytes.len()).min(bytes.len());
        printed.bytes.extend_from_slice(&bytes[..room]);
        printed.omitted += (bytes.len() - room) as u64;
    }

    fn heard(&mut self, bytes: &[u8]) {
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend_from_slice(piece);
            if self.line.ends_with(b"\n") {
                let mut line = std::mem::take(&mut self.line);
                line.pop();
                self.understand(&line);
            }
        }
        if self.line.len() > codec::LINE_LIMIT {
            self.line = Vec::new();
        }
    }

    fn understand(&mut self, line: &[u8]) {
        match codec::decode(line) {
            Ok(HostMessage::Notification(Notification::Message(message))) => {
                if matches!(message.kind, MessageKind::Failure | MessageKind::Error) {
                    self.note(message.text.clone());
                }
                self.happens(EventKind::Message {
                    source: Source::Hook(self.hook.id),
                    message,
                    test: None,
                });
            }
            Ok(HostMessage::Notification(Notification::Measured(measured)))
                if !measured.is_within_limits() =>
            {
                self.note(format!("`{}` is out of its limits", measured.name));
            }
            Ok(HostMessage::Notification(Notification::Sampled(samples))) => {
                samples.problem().into_iter().for_each(|problem| self.note(problem));
            }
            Ok(HostMessage::Reply(RUN, Reply::Result(value))) => {
                match serde_json::from_value::<Answer>(value) {
                    Ok(answer) => self.answer = Some(answer),
                    Err(error) => self.note(format!("its host broke the protocol: {error}")),
                }
            }
            Ok(HostMessage::Reply(RUN, Reply::Error(error))) => {
                self.note(format!("its host refused: {}", error.message));
            }
            Ok(_) => {}
            // The runner may have read the beginning of the line.
            Err(_) if self.process.adopted => {}
            Err(what) => self.note(format!("its host broke the protocol: {what}")),
        }
    }

    /// The first problem is the one that is told.
    fn note(&mut self, problem: String) {
        self.problem.get_or_insert(problem);
    }

    fn happens(&mut self, kind: EventKind) {
        self.happened.push(Happened { at: Instant::now(), kind });
    }

    fn judge(mut self, status: ExitStatus) -> Attended {
        for stream in [Stream::Stdout, Stream::Stderr] {
            let Printed { bytes, omitted } = std::mem::take(&mut self.printed[stream as usize]);
            let text = String::from_utf8_lossy(&bytes).into_owned();
            let source = Source::Hook(self.hook.id);
            if !text.is_empty() {
                self.happens(EventKind::Output(Output { source, stream, omitted_bytes: 0, text }));
            }
            if omitted > 0 {
                let text = String::new();
                self.happens(EventKind::Output(Output {
                    source,
                    stream,
                    omitted_bytes: omitted,
                    text,
                }));
            }
        }
        if let Some(problem) = self.problem_of(status) {
            self.note(problem);
        }
        Attended { problem: self.problem, happened: self.happened }
    }

    fn problem_of(&self, status: ExitStatus) -> Option<String> {
        let plugin = self.hook.plugin.is_some();
        match (&self.answer, status) {
            (Some(answer), _) if answer.outcome != Outcome::Passed => {
                Some(answer.reason.clone().unwrap_or_else(|| "it says that it failed".to_owned()))
            }
            (None, ExitStatus::Code(0)) if plugin && self.process.adopted => {
                Some("it ended, but what it answered was lost with the runner".to_owned())
            }
            (None, status) if plugin => Some(format!("it ended with {status} before it was over")),
            (_, ExitStatus::Code(0)) => None,
            (_, status) => Some(format!("it ended with {status}")),
        }
    }
}
