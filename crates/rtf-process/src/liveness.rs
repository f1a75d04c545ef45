//! Decides whether a process is alive or dying. A process dies from the moment in which
//! the kernel was asked to kill it.
//!
//! A deadly signal is first pending, then taken by a thread, which sets its flags a
//! moment later and ends the others. In between the signal is invisible, but the thread
//! is running. So the check reads pending signals first, and then polls each thread until
//! it sleeps, or has run for much longer than that moment takes. A process that handles
//! the signal itself is alive.

use std::collections::{HashMap, HashSet};
use std::fs::read_to_string;
use std::time::Duration;

/// The kernel's flags of a thread that is ending, writes the memory image of its
/// process, or was ended by a signal.
const EXITING: u64 = 0x4;
const DUMPING: u64 = 0x200;
const SIGNALLED: u64 = 0x400;
const SIGKILL: u64 = 1 << 8;
/// The signals whose default action does not end a process: SIGCHLD, SIGCONT, SIGSTOP,
/// SIGTSTP, SIGTTIN, SIGTTOU, SIGURG, SIGWINCH.
const HARMLESS: u64 = 0x87f0000;
/// A thread that has run for so many nanoseconds has set its flags.
const FLAGS_SET_NANOS: u64 = 50_000;
/// The number of polls of a running thread, where the kernel does not count its run time.
const POLLS: u64 = 10;
/// The time between polls of running threads.
const POLL_INTERVAL: Duration = Duration::from_millis(1);

/// A check of one process, which is polled until the result is certain.
#[derive(Debug)]
pub struct LivenessCheck {
    pid: i32,
    /// The threads whose state is certain.
    settled: HashSet<String>,
    /// The run times of the other threads at the first poll.
    running: HashMap<String, u64>,
    polls: u64,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ThreadState {
    /// It has ended, alone or with its process.
    Ended,
    /// A signal ends it, and so its process.
    Killed,
    Running,
    Sleeping,
}

impl LivenessCheck {
    pub fn new(pid: i32) -> Self {
        Self { pid, settled: HashSet::new(), running: HashMap::new(), polls: 0 }
    }

    /// Whether the process was alive at the first poll; `None` if that is not certain yet.
    pub fn poll(&mut self) -> Option<bool> {
        self.polls += 1;
        if is_deadly(self.pid) {
            return Some(false);
        }
        let Ok(threads) = std::fs::read_dir(format!("/proc/{}/task", self.pid)) else {
            return Some(false);
        };
        let (mut all_ended, mut all_settled) = (true, true);
        for thread in threads.flatten() {
            let id = thread.file_name().to_string_lossy().into_owned();
            match thread_state(&format!("/proc/{}/task/{id}/stat", self.pid)) {
                ThreadState::Ended => continue,
                ThreadState::Killed => return Some(false),
                ThreadState::Sleeping => drop(self.settled.insert(id)),
                ThreadState::Running => all_settled &= self.has_run(id),
            }
            all_ended = false;
        }
        if all_ended {
            return Some(false);
        }
        // A thread that has ended since may have ended the others.
        all_settled.then(|| self.polls == 1 || !is_deadly(self.pid))
    }

    /// Polls until the result is certain.
    pub async fn wait(&mut self) -> bool {
        loop {
            if let Some(alive) = self.poll() {
                return alive;
            }
            tokio::time::sleep(POLL_INTERVAL).await;
        }
    }

    /// Whether a thread must have set its flags if it took a deadly signal before the
    /// first poll.
    fn has_run(&mut self, id: String) -> bool {
        if self.settled.contains(&id) {
            return true;
        }
        let time = run_time(self.pid, &id);
        let before = *self.running.entry(id.clone()).or_insert(time.unwrap_or_default());
        let settled = match time {
            Some(time) => time >= before + FLAGS_SET_NANOS,
            None => self.polls >= POLLS,
        };
        if settled {
            self.settled.insert(id);
        }
        settled
    }
}

/// The run time of a thread in nanoseconds, if the kernel counts it.
fn run_time(pid: i32, thread: &str) -> Option<u64> {
    let text = read_to_string(format!("/proc/{pid}/task/{thread}/schedstat")).ok()?;
    text.split(' ').next()?.parse().ok().filter(|time| *time > 0)
}

fn thread_state(stat: &str) -> ThreadState {
    let Ok(stat) = read_to_string(stat) else { return ThreadState::Ended };
    let Some((_, rest)) = stat.rsplit_once(") ") else { return ThreadState::Ended };
    let mut fields = rest.split(' ');
    let state = fields.next().unwrap_or("X");
    // Skips parent, group, session, terminal, and the terminal's group.
    let flags = fields.nth(5).and_then(|flags| flags.parse::<u64>().ok()).unwrap_or_default();
    match state {
        _ if flags & (DUMPING | SIGNALLED) != 0 => ThreadState::Killed,
        "Z" | "X" | "x" => ThreadState::Ended,
        _ if flags & EXITING != 0 => ThreadState::Ended,
        "R" => ThreadState::Running,
        _ => ThreadState::Sleeping,
    }
}

/// Whether a pending signal ends the process, or it has ended.
fn is_deadly(pid: i32) -> bool {
    let Ok(status) = read_to_string(format!("/proc/{pid}/status")) else { return true };
    let mut pending = 0;
    let mut spared = HARMLESS;
    for line in status.lines() {
        let Some((name, mask)) = line.split_once(":\t") else { continue };
        let mask = || u64::from_str_radix(mask.trim(), 16).unwrap_or_default();
        match name {
            "SigPnd" | "ShdPnd" => pending |= mask(),
            "SigBlk" | "SigIgn" | "SigCgt" => spared |= mask(),
            _ => {}
        }
    }
    pending & (!spared | SIGKILL) != 0
}

#[cfg(test)]
mod tests {
    use std::io::{BufRead as _, BufReader};
    use std::process::{Child, Command, Stdio};

    use super::{LivenessCheck, POLL_INTERVAL};
    use libc::{SIGABRT, SIGCHLD, SIGHUP, SIGKILL, SIGSEGV, SIGSTOP, SIGTERM, SIGUSR1};

    use crate::unix::signal_process;

    fn is_alive(pid: i32) -> bool {
        let mut check = LivenessCheck::new(pid);
        loop {
            match check.poll() {
                Some(alive) => return alive,
                None => std::thread::sleep(POLL_INTERVAL),
            }
        }
    }

    fn pid(child: &Child) -> i32 {
        i32::try_from(child.id()).unwrap()
    }

    fn sleeper() -> Child {
        Command::new("sleep").arg("1000").spawn().unwrap()
    }

    /// Checks all moments between the signal and the end, with a memory image and without,
    /// for a sleeping and for a running process.
    #[test]
    fn a_process_is_not_alive_from_its_deadly_signal_on_until_it_is_reaped() {
        for command in ["ulimit -c 0; exec sleep 1000", "ulimit -c 0; while :; do :; done"] {
            for signal in [SIGKILL, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGUSR1].repeat(10) {
                let mut shell = Command::new("sh").args(["-c", command]).spawn().unwrap();
                let pid = pid(&shell);
                assert!(is_alive(pid));
                signal_process(pid, signal);
                (0..20).for_each(|look| assert!(!is_alive(pid), "{command} {signal} {look}"));
                shell.wait().unwrap();
                assert!(!is_alive(pid));
            }
        }
    }

    #[test]
    fn a_process_that_handles_or_ignores_a_signal_is_alive() {
        let script = "trap : TERM; trap '' HUP; echo up; while :; do sleep 0.01; done";
        let mut command = Command::new("sh");
        let mut shell = command.args(["-c", script]).stdout(Stdio::piped()).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(shell.stdout.take().unwrap()).read_line(&mut line).unwrap();
        for signal in [SIGTERM, SIGHUP, SIGCHLD].repeat(20) {
            signal_process(pid(&shell), signal);
            assert!(is_alive(pid(&shell)));
        }
        shell.kill().unwrap();
        shell.wait().unwrap();
    }

    #[test]
    fn a_stopped_process_lives() {
        let mut sleeper = sleeper();
        signal_process(pid(&sleeper), SIGSTOP);
        assert!(is_alive(pid(&sleeper)));
        sleeper.kill().unwrap();
        sleeper.wait().unwrap();
    }

    /// A daemon may leave its work to threads.
    #[test]
    fn a_process_whose_first_thread_has_ended_lives_as_long_as_another_one_does() {
        let program = "import ctypes, threading, time\n\
            def work():\n\
            \x20   while open('/proc/self/stat').read().rpartition(') ')[2][0] != 'Z': time.sleep(0.001)\n\
            \x20   print('works', flush=True)\n\
            \x20   time.sleep(1000)\n\
            threading.Thread(target=work).start()\n\
            ctypes.CDLL(None).pthread_exit(None)\n";
        let mut command = Command::new("python3");
        let mut daemon =
            command.args(["-c", program]).stdout(Stdio::piped()).spawn().expect("python3");
        let mut line = String::new();
        BufReader::new(daemon.stdout.take().unwrap()).read_line(&mut line).unwrap();
        assert_eq!(line, "works\n");
        assert!(is_alive(pid(&daemon)));
        daemon.kill().unwrap();
        (0..100).for_each(|_| assert!(!is_alive(pid(&daemon))));
        daemon.wait().unwrap();
    }
}
