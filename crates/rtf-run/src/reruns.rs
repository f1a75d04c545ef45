//! Reruns that a browser requests: each is `rtf run --rerun failed`, one at a time.
//!
//! `docs/decisions/0023-running-again-from-the-page.md` explains why a rerun is a
//! separate process.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};

use crate::spawn_self;
use rtf_model::{Event, EventKind};
use rtf_web::{FinishedRun, RerunRejected};
use rustix::process::{Pid, WaitId, WaitIdOptions};
use tokio::sync::watch;

/// SIGINT.
const INT: i32 = 2;
/// The limit for the error text of a run that does not start, in bytes.
const MAX_ERROR_TEXT: u64 = 4096;

/// Starts reruns, one at a time.
#[derive(Debug)]
pub struct Reruns {
    results: PathBuf,
    active: Arc<ActiveRerun>,
}

#[derive(Debug, Default)]
struct ActiveRerun {
    state: Mutex<RerunState>,
    is_active: watch::Sender<bool>,
}

#[derive(Debug, Default)]
struct RerunState {
    /// The process, from its start until it is known to have ended.
    process: Option<Pid>,
    /// The run, from its first event.
    name: Option<String>,
    /// Whether a signal has been sent.
    is_stopped: bool,
    /// The signal that ends this program.
    ending: Option<i32>,
}

/// The name of the new run.
type StartResult = Result<String, RerunRejected>;

impl Reruns {
    /// Reruns runs in `results`, an absolute path.
    pub fn new(results: PathBuf) -> Self {
        Self { results, active: Arc::default() }
    }

    /// Refuses further reruns, passes a signal on to the active one, and returns its
    /// name. A rerun that has been stopped before does not get this signal unless it is
    /// the second one: it would cut the tear-down short.
    pub fn end(&self, signal: i32) -> Option<String> {
        let mut state = self.active.state();
        let is_repeated = state.ending.replace(signal).is_some();
        state.signal(signal, is_repeated);
        let is_active = *self.active.is_active.borrow();
        is_active.then(|| state.name.clone().unwrap_or_default())
    }

    /// Waits until no rerun is active.
    pub async fn wait_until_idle(&self) {
        // `self` owns the sender, so this cannot fail.
        let _ = self.active.is_active.subscribe().wait_for(|is_active| !is_active).await;
    }
}

impl rtf_web::RunStarter for Reruns {
    fn rerun_failed(&self, run: &FinishedRun<'_>) -> StartResult {
        if !run.folder.is_dir() {
            let dir = run.folder.display();
            return Err(not_started(format!("the working directory `{dir}` no longer exists")));
        }
        {
            let mut state = self.active.state();
            if state.ending.is_some() {
                return Err(not_started("the server is shutting down"));
            }
            if self.active.is_active.send_replace(true) {
                return Err(not_started("another rerun is active"));
            }
            *state = RerunState::default();
        }
        let (result_sender, result) = mpsc::channel();
        let active = self.active.clone();
        let (results, name, dir) =
            (self.results.clone(), run.name.to_owned(), run.folder.to_owned());
        let follow = move || {
            let ended =
                start(&results, &name, &dir).and_then(|run| active.follow(run, &result_sender));
            if let Err(error) = ended {
                // Has no effect if the result has been sent.
                let error = not_started(format!("cannot start `rtf run`: {error}"));
                let _ = result_sender.send(Err(error));
            }
            active.reset();
        };
        if let Err(error) = std::thread::Builder::new().name("rerun".into()).spawn(follow) {
            self.active.reset();
            return Err(not_started(format!("cannot start a thread: {error}")));
        }
        result.recv().unwrap_or_else(|_| Err(not_started("lost track of `rtf run`")))
    }

    fn started(&self) -> Option<String> {
        self.active.state().name.clone()
    }

    fn stop(&self) {
        self.active.state().signal(INT, false);
    }
}

impl ActiveRerun {
    fn state(&self) -> MutexGuard<'_, RerunState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Sends the run's name or its error, and waits until the run has ended.
    fn follow(&self, run: RerunProcess, result: &mpsc::Sender<StartResult>) -> io::Result<()> {
        let RerunProcess { mut child, lifeline, stdout, mut stderr } = run;
        let pid = spawn_self::pid(child.id());
        {
            let mut state = self.state();
            state.process = pid;
            if let Some(signal) = state.ending {
                state.signal(signal, false);
            }
        }
        let mut events = BufReader::new(stdout);
        let name = read_run_name(&mut events);
        self.state().name.clone_from(&name);
        let has_started = name.is_some();
        if let Some(name) = name {
            let _ = result.send(Ok(name));
        }
        // The journal has the events; the run must not wait for a reader.
        io::copy(&mut events, &mut io::sink())?;
        if let Some(pid) = pid {
            let options = WaitIdOptions::EXITED | WaitIdOptions::NOWAIT;
            rustix::process::waitid(WaitId::Pid(pid), options)?;
        }
        // After `wait`, the kernel may reuse the process id.
        self.state().process = None;
        drop(lifeline);
        child.wait()?;
        if !has_started {
            let _ = result.send(Err(read_error(&mut stderr)?));
        }
        Ok(())
    }

    fn reset(&self) {
        let mut state = self.state();
        (state.process, state.name) = (None, None);
        self.is_active.send_replace(false);
    }
}

impl RerunState {
    fn signal(&mut self, number: i32, is_repeated: bool) {
        let Some(pid) = self.process else { return };
        if !self.is_stopped || is_repeated {
            self.is_stopped = true;
            spawn_self::signal(pid, number);
        }
    }
}

struct RerunProcess {
    child: Child,
    /// The run ends when this closes, for example because this process dies.
    lifeline: Option<ChildStdin>,
    /// The event stream.
    stdout: ChildStdout,
    stderr: File,
}

fn start(results: &Path, run: &str, dir: &Path) -> io::Result<RerunProcess> {
    let end_with_stdin = spawn_self::END_WITH_STDIN;
    let options = ["run", end_with_stdin, "--color", "never", "--format", "json", "--results"];
    let mut command = spawn_self::command(options)?;
    command.arg(results).args(["--rerun", "failed", "--", run]).current_dir(dir);
    let stderr = tempfile::tempfile()?;
    let mut child = command.stdout(Stdio::piped()).stderr(stderr.try_clone()?).spawn()?;
    let stdout = child.stdout.take().ok_or(io::ErrorKind::BrokenPipe)?;
    let lifeline = child.stdin.take();
    Ok(RerunProcess { child, lifeline, stdout, stderr })
}

/// Reads the run's name from its first event, after which its journal exists.
fn read_run_name(events: &mut impl BufRead) -> Option<String> {
    let mut line = String::new();
    events.read_line(&mut line).ok()?;
    match serde_json::from_str::<Event>(&line).ok()?.kind {
        EventKind::RunStarted(started) => Some(started.run),
        _ => None,
    }
}

/// Reads the error and its hint from the standard error of a run that did not start.
fn read_error(stderr: &mut File) -> io::Result<RerunRejected> {
    stderr.rewind()?;
    let mut bytes = Vec::new();
    stderr.take(MAX_ERROR_TEXT).read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    let (hints, reasons): (Vec<_>, Vec<_>) =
        text.trim().lines().partition(|line| line.starts_with("hint: "));
    let reason = reasons.join("\n");
    let reason = reason.strip_prefix("error: ").unwrap_or(&reason);
    let reason =
        if reason.is_empty() { "`rtf run` ended without an error message" } else { reason };
    let hint = hints.first().and_then(|hint| hint.strip_prefix("hint: "));
    Ok(RerunRejected { reason: reason.to_owned(), hint: hint.map(str::to_owned) })
}

fn not_started(reason: impl Into<String>) -> RerunRejected {
    RerunRejected { reason: reason.into(), hint: None }
}
