//! The guard while the runner lives: it passes signals on, listens, and waits.

use std::collections::VecDeque;
use std::os::fd::{AsFd, OwnedFd};
use std::os::unix::net::UnixStream;
use std::time::{Duration, Instant};

use rtf_model::{ExitStatus, LeakedProcess};
use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::net::{RecvFlags, recv};

use super::after::{self, Died};
use super::duties::Duties;
use super::note::Note;
use super::unix::{self, Signals};
use rtf_process::{cgroup, descriptor_passing, tree};

/// The exit code of a Rust program that panicked.
const PANICKED: i32 = 101;
/// After the third request to end, the runner has this long to end by itself.
const LAST_GRACE: Duration = Duration::from_secs(5);
/// A runner that was killed is waited for as long. One that hangs in the kernel
/// must not keep the robot from being parked.
const KILL_LIMIT: Duration = Duration::from_secs(5);
/// A runner is silent when it has not shown for this long that it is alive.
const SILENT: Duration = Duration::from_secs(3);
/// A silent runner is given at least this long: a machine may be very busy.
pub const LEAST_PATIENCE: Duration = Duration::from_secs(5);
/// A runner that died without having acted upon requests has acted upon at most
/// these: the hooks run.
const ACTED: u32 = 2;
/// How often the guard looks whether the runner is silent.
const TICK: Duration = Duration::from_secs(1);
/// How much of what the runner tells is read at once.
const READ_BYTES: usize = 64 * 1024;

/// The guard.
#[derive(Debug)]
pub struct Guard {
    runner: i32,
    link: Link,
    signals: Signals,
    forked: Instant,
    pulse: Pulse,
    /// How long the runner may be silent.
    patience: Duration,
    /// When the runner is killed, after the last request to end.
    kill_at: Option<Instant>,
    /// That it was killed: why, and when it is waited for no more.
    killed: Option<(String, Instant)>,
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
        left: Vec<LeakedProcess>,
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
        Self {
            runner,
            link,
            signals,
            forked,
            pulse: Pulse::new(pulse),
            patience: LEAST_PATIENCE,
            kill_at: None,
            killed: None,
            lifeline: None,
        }
    }

    /// Kills the runner when it does not answer for this long.
    pub(super) fn patient_for(self, patience: Duration) -> Self {
        Self { patience: patience.max(LEAST_PATIENCE), ..self }
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
            let spoke = self.link.listen();
            self.pulse.listen(spoke || !self.is_watched());
            self.kill_if_due();
            match unix::ended(self.runner) {
                Ok(None) if self.killed.as_ref().is_some_and(|(_, end)| *end <= Instant::now()) => {
                    break ExitStatus::Signal(libc::SIGKILL);
                }
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

    /// Whether the runner has to show that it is alive.
    fn is_watched(&self) -> bool {
        self.link.duties.run.is_some() && !self.link.duties.over
    }

    fn wait(&self) {
        let mut fds = vec![PollFd::new(&self.signals, PollFlags::IN)];
        fds.extend(self.link.socket.as_ref().map(|link| PollFd::new(link, PollFlags::IN)));
        fds.extend(self.lifeline.as_ref().map(|line| PollFd::new(line, PollFlags::IN)));
        fds.extend(self.pulse.open().map(|pulse| PollFd::new(pulse, PollFlags::IN)));
        let due = self.killed.as_ref().map(|(_, end)| *end).or(self.kill_at);
        let due = due.map(|at| at.saturating_duration_since(Instant::now()));
        let timeout = due.into_iter().chain(self.is_watched().then_some(TICK)).min();
        let timeout = timeout.and_then(|left| Timespec::try_from(left).ok());
        // A signal interrupts it, and then it is in the pipe.
        let _ = poll(&mut fds, timeout.as_ref());
    }

    fn kill_if_due(&mut self) {
        if self.killed.is_some() {
            return;
        }
        let silence = self.pulse.silence;
        let late = self.kill_at.is_some_and(|at| at <= Instant::now());
        let why = if silence >= self.patience || (late && silence >= SILENT) {
            // It did not act upon what was asked of it: the hooks did not run.
            self.signals.requests.lower(ACTED);
            let state = if tree::is_stopped(self.runner) { "it was stopped, and" } else { "it" };
            format!("{state} did not answer for {} s: the guard killed it", silence.as_secs())
        } else if late {
            let secs = LAST_GRACE.as_secs();
            format!("it did not end within {secs} s of the third request: the guard killed it")
        } else {
            return;
        };
        rtf_process::signal_process(self.runner, libc::SIGKILL);
        self.killed = Some((why, Instant::now() + KILL_LIMIT));
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
            if self.signals.requests.take(Instant::now()) {
                self.pass_on(libc::SIGTERM);
            }
        }
    }

    fn pass_on(&mut self, signal: i32) {
        match signal {
            // The end of a child. And a run that supervises a robot is not stopped halfway.
            libc::SIGCHLD | libc::SIGTSTP => {}
            _ => {
                rtf_process::signal_process(self.runner, signal);
                // One that was stopped shall act upon it.
                rtf_process::signal_process(self.runner, libc::SIGCONT);
            }
        }
        if self.signals.kill() && self.kill_at.is_none() {
            self.kill_at = Some(Instant::now() + LAST_GRACE);
        }
    }

    fn judge(mut self, status: ExitStatus) -> Ended {
        let duties = std::mem::take(&mut self.link.duties);
        let open = duties.run.is_some() && !duties.over;
        let (code, reason) = match status {
            ExitStatus::Signal(_) if let Some((why, _)) = self.killed => (None, why),
            ExitStatus::Code(PANICKED) => (None, format!("it panicked ({status})")),
            ExitStatus::Code(_) if open => {
                (None, format!("it ended with {status} before the run was over"))
            }
            ExitStatus::Code(code) => (u8::try_from(code).ok(), String::new()),
            // The user ended it before anything was started.
            ExitStatus::Signal(signal)
                if duties.run.is_none() && self.signals.requests.made() > 0 =>
            {
                (u8::try_from(128 + signal).ok(), String::new())
            }
            ExitStatus::Signal(_) => (None, status.to_string()),
        };
        match code {
            Some(code) => {
                Ended::ByItself { code, left: tree::kill_until_none_is_left(after::SWEEP_LIMIT) }
            }
            None => Ended::Died(after::finish(duties, reason, self.signals, self.forked)),
        }
    }
}

/// What shows that the runner is alive.
#[derive(Debug)]
struct Pulse {
    /// Closed with this process, which the runner notices.
    socket: UnixStream,
    /// Whether the other end is closed.
    over: bool,
    /// When it was listened to.
    at: Instant,
    /// For how long the runner has been silent. While this process does not run
    /// itself, because all is suspended, the time does not count.
    silence: Duration,
}

impl Pulse {
    fn new(socket: UnixStream) -> Self {
        Self { socket, over: false, at: Instant::now(), silence: Duration::ZERO }
    }

    fn open(&self) -> Option<&UnixStream> {
        (!self.over).then_some(&self.socket)
    }

    /// Takes in what came; `spoke` says that the runner has shown otherwise that
    /// it is alive.
    fn listen(&mut self, mut spoke: bool) {
        let mut bytes = [0; 1024];
        while !self.over {
            match recv(&self.socket, &mut bytes[..], RecvFlags::DONTWAIT) {
                Ok((0, _)) => self.over = true,
                Ok(_) => spoke = true,
                Err(rustix::io::Errno::INTR) => {}
                Err(rustix::io::Errno::AGAIN) => break,
                Err(_) => self.over = true,
            }
        }
        let now = Instant::now();
        let passed = now.saturating_duration_since(self.at).min(2 * TICK);
        self.at = now;
        self.silence = if spoke { Duration::ZERO } else { self.silence + passed };
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
    /// Takes in all that was told until now; whether anything was.
    fn listen(&mut self) -> bool {
        let mut bytes = vec![0; READ_BYTES];
        let mut any = false;
        while let Some(socket) = &self.socket {
            let socket = socket.as_fd();
            let read = match descriptor_passing::receive(socket, &mut bytes, RecvFlags::DONTWAIT) {
                Ok((read, descriptors)) => {
                    self.received.extend(descriptors);
                    read
                }
                Err(rustix::io::Errno::AGAIN) => break,
                Err(rustix::io::Errno::INTR) => continue,
                Err(_) => 0,
            };
            if read == 0 {
                self.socket = None;
            }
            any |= read > 0;
            self.heard(&bytes[..read]);
        }
        any
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
