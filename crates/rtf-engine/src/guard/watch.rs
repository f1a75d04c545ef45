//! The guard while the runner lives: it passes signals on, listens, and waits.

use std::collections::VecDeque;
use std::io::IoSliceMut;
use std::mem::MaybeUninit;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use rtf_model::{ExitStatus, LeftProcess};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::net::{RecvAncillaryBuffer, RecvAncillaryMessage, RecvFlags, recvmsg};

use super::after::{self, Died};
use super::duties::Duties;
use super::link::DESCRIPTORS;
use super::note::Note;
use super::unix::{self, Signals};
use crate::host::{cgroup, tree};

/// The exit code of a Rust program that panicked.
const PANICKED: i32 = 101;
/// The number of requests to end the run after which nobody is waited for.
pub(super) const KILLS: u32 = 3;
/// After that many, the runner has this long to end by itself.
const LAST_GRACE: Duration = Duration::from_secs(5);
/// How much of what the runner tells is read at once.
const READ_BYTES: usize = 64 * 1024;

/// The guard.
#[derive(Debug)]
pub struct Guard {
    runner: i32,
    link: Link,
    signals: Signals,
    forked: Instant,
    /// Closed with this process, which the runner notices.
    _pulse: UnixStream,
    /// When the runner is killed, after the last request to end.
    kill_at: Option<Instant>,
    /// Its end is a request to end.
    lifeline: Option<OwnedFd>,
}

/// How it ended.
#[derive(Debug)]
pub enum Ended {
    /// The runner came to its end.
    ByItself {
        /// Its exit code.
        code: u8,
        /// What it left behind and was killed: there should be nothing.
        left: Vec<LeftProcess>,
    },
    /// The runner died. What it had started was stopped.
    Died(Died),
}

impl Guard {
    pub(super) fn new(
        runner: i32,
        [socket, pulse]: [UnixStream; 2],
        signals: Signals,
        forked: Instant,
    ) -> Self {
        let link = Link {
            socket: Some(socket),
            line: Vec::new(),
            received: VecDeque::new(),
            duties: Duties::default(),
        };
        Self { runner, link, signals, forked, _pulse: pulse, kill_at: None, lifeline: None }
    }

    /// Asks the runner to end when `lifeline` does.
    pub(super) fn ending_with(self, lifeline: Option<OwnedFd>) -> Self {
        Self { lifeline, ..self }
    }

    /// Waits for the end of the runner, and does what it cannot do any more.
    #[must_use]
    pub fn watch(mut self) -> Ended {
        let status = loop {
            self.wait();
            for signal in self.signals.read() {
                self.pass_on(signal);
            }
            self.look_at_lifeline();
            self.link.listen();
            if self.kill_at.is_some_and(|at| at <= Instant::now()) {
                tree::signal(self.runner, libc::SIGKILL);
            }
            match unix::ended(self.runner) {
                Ok(None) => {}
                Ok(Some(status)) => break status,
                // Nobody else waits for it; but if so, it is gone.
                Err(_) => break ExitStatus::Code(-1),
            }
        };
        // What it told until it died.
        self.link.listen();
        let runner = self.runner;
        let ended = self.judge(status);
        cgroup::remove_groups_of(runner);
        ended
    }

    fn wait(&self) {
        let mut fds = vec![PollFd::new(&self.signals, PollFlags::IN)];
        fds.extend(self.link.socket.as_ref().map(|link| PollFd::new(link, PollFlags::IN)));
        fds.extend(self.lifeline.as_ref().map(|line| PollFd::new(line, PollFlags::IN)));
        let timeout = self.kill_at.map(|at| at.saturating_duration_since(Instant::now()));
        let timeout = timeout.and_then(|left| Timespec::try_from(left).ok());
        // A signal interrupts it, and then it is in the pipe.
        let _ = poll(&mut fds, timeout.as_ref());
    }

    /// What comes over it does not count, only its end.
    fn look_at_lifeline(&mut self) {
        let Some(line) = &self.lifeline else { return };
        let mut polled = [PollFd::new(line, PollFlags::IN)];
        if !matches!(poll(&mut polled, Some(&Timespec::default())), Ok(1..)) {
            return;
        }
        if matches!(rustix::io::read(line, &mut [0; 4096]), Ok(0) | Err(_)) {
            self.lifeline = None;
            self.signals.asked += 1;
            self.pass_on(libc::SIGTERM);
        }
    }

    fn pass_on(&mut self, signal: i32) {
        match signal {
            // The end of a child. And a run that supervises a robot is not stopped halfway.
            libc::SIGCHLD | libc::SIGTSTP => {}
            _ => {
                tree::signal(self.runner, signal);
            }
        }
        if self.signals.asked >= KILLS && self.kill_at.is_none() {
            self.kill_at = Some(Instant::now() + LAST_GRACE);
        }
    }

    fn judge(mut self, status: ExitStatus) -> Ended {
        let duties = std::mem::take(&mut self.link.duties);
        let open = duties.run.is_some() && !duties.over && self.signals.asked < KILLS;
        let (code, reason) = match status {
            ExitStatus::Code(PANICKED) => (None, format!("it panicked ({status})")),
            ExitStatus::Code(_) if open => {
                (None, format!("it ended with {status} before the run was over"))
            }
            ExitStatus::Code(code) => (u8::try_from(code).ok(), String::new()),
            // The user ended it before anything was started.
            ExitStatus::Signal(signal) if duties.run.is_none() && self.signals.asked > 0 => {
                (u8::try_from(128 + signal).ok(), String::new())
            }
            ExitStatus::Signal(_) => (None, status.to_string()),
        };
        match code {
            Some(code) => Ended::ByItself { code, left: tree::clear(after::SWEEP_LIMIT) },
            None => Ended::Died(after::finish(duties, reason, self.signals, self.forked)),
        }
    }
}

/// The guard's end of the line.
#[derive(Debug)]
struct Link {
    /// `None` once the other end is closed.
    socket: Option<UnixStream>,
    line: Vec<u8>,
    received: VecDeque<OwnedFd>,
    duties: Duties,
}

impl Link {
    /// Takes in all that was told until now.
    fn listen(&mut self) {
        let mut bytes = vec![0; READ_BYTES];
        while let Some(socket) = &self.socket {
            let mut space = [MaybeUninit::uninit(); rustix::cmsg_space!(ScmRights(DESCRIPTORS))];
            let mut beside = RecvAncillaryBuffer::new(&mut space);
            let flags = RecvFlags::DONTWAIT | RecvFlags::CMSG_CLOEXEC;
            let mut room = [IoSliceMut::new(&mut bytes)];
            let read = match recvmsg(socket.as_fd(), &mut room, &mut beside, flags) {
                Ok(message) => message.bytes,
                Err(rustix::io::Errno::AGAIN) => return,
                Err(rustix::io::Errno::INTR) => continue,
                Err(_) => 0,
            };
            for message in beside.drain() {
                if let RecvAncillaryMessage::ScmRights(descriptors) = message {
                    self.received.extend(descriptors);
                }
            }
            if read == 0 {
                self.socket = None;
            }
            self.heard(&bytes[..read]);
        }
    }

    fn heard(&mut self, bytes: &[u8]) {
        for piece in bytes.split_inclusive(|byte| *byte == b'\n') {
            self.line.extend_from_slice(piece);
            if self.line.ends_with(b"\n") {
                // The runner is this same program: a line that is none does not come.
                if let Ok(note) = serde_json::from_slice::<Note>(&self.line) {
                    self.duties.take(note, &mut self.received, Instant::now());
                }
                self.line.clear();
            }
        }
    }
}
