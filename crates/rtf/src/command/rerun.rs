//! Failed tests that are run again because somebody asked `rtf serve` to: as
//! `rtf run --rerun failed`, one run at a time.
//!
//! Why it is another process: `docs/decisions/0023-running-again-from-the-page.md`.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::PathBuf;
use std::process::{Child, ChildStdin, ChildStdout, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, mpsc};

use rtf_model::{Event, EventKind};
use rtf_web::{FinishedRun, RerunRejected};
use rustix::process::{Pid, WaitId, WaitIdOptions};
use tokio::sync::watch;

use super::child;

/// SIGINT.
const INT: i32 = 2;
/// How much of what a run that was not started says is told.
const TOLD: u64 = 4096;

/// Runs again, one at a time.
#[derive(Debug)]
pub struct Reruns {
    results: PathBuf,
    current: Arc<Current>,
}

/// The run that goes on, if any.
#[derive(Debug, Default)]
struct Current {
    state: Mutex<State>,
    busy: watch::Sender<bool>,
}

#[derive(Debug, Default)]
struct State {
    /// Its process, from its start until it is known to have ended.
    process: Option<Pid>,
    /// Its name, once it has one.
    name: Option<String>,
    /// Whether it was told to end.
    stopped: bool,
    /// With which signal this program ends.
    ending: Option<i32>,
}

type Told = Result<String, RerunRejected>;

impl Reruns {
    /// Of the runs in `results`, which is absolute.
    pub fn new(results: PathBuf) -> Self {
        Self { results, current: Arc::default() }
    }

    /// Starts nothing more, and passes a signal on; the name of the run whose end
    /// has to be waited for. What was stopped before gets no second signal, which
    /// would cut its tear-down short.
    pub fn end(&self, signal: i32) -> Option<String> {
        let mut state = self.current.state();
        let insists = state.ending.replace(signal).is_some();
        state.signal(signal, insists);
        let busy = *self.current.busy.borrow();
        busy.then(|| state.name.clone().unwrap_or_default())
    }

    /// Waits until no run goes on.
    pub async fn ended(&self) {
        // The sender is in `self`.
        let _ = self.current.busy.subscribe().wait_for(|busy| !busy).await;
    }
}

impl rtf_web::RunStarter for Reruns {
    fn rerun_failed(&self, run: &FinishedRun<'_>) -> Told {
        if !run.folder.is_dir() {
            return Err(not(format!("the folder `{}` of this run has gone", run.folder.display())));
        }
        {
            let mut state = self.current.state();
            if state.ending.is_some() {
                return Err(not("this server ends"));
            }
            if self.current.busy.send_replace(true) {
                return Err(not("a run goes on that was started here"));
            }
            *state = State::default();
        }
        let (tell, told) = mpsc::channel();
        let current = self.current.clone();
        let (results, name, folder) =
            (self.results.clone(), run.name.to_owned(), run.folder.to_owned());
        let follow = move || {
            let ended = start(&results, &name, folder).and_then(|run| current.follow(run, &tell));
            if let Err(error) = ended {
                // Unless it was told already that it has started.
                let _ = tell.send(Err(not(format!("cannot start `rtf run`: {error}"))));
            }
            current.rest();
        };
        if let Err(error) = std::thread::Builder::new().name("rerun".into()).spawn(follow) {
            self.current.rest();
            return Err(not(format!("cannot start a thread: {error}")));
        }
        told.recv().unwrap_or_else(|_| Err(not("`rtf run` could not be followed")))
    }

    fn started(&self) -> Option<String> {
        self.current.state().name.clone()
    }

    fn stop(&self) {
        self.current.state().signal(INT, false);
    }
}

impl Current {
    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Tells the run's name, or why it has none, and waits for its end.
    fn follow(&self, run: Started, tell: &mpsc::Sender<Told>) -> io::Result<()> {
        let Started { mut child, lifeline, events, mut said } = run;
        let pid = child::pid(child.id());
        {
            let mut state = self.state();
            state.process = pid;
            if let Some(signal) = state.ending {
                state.signal(signal, false);
            }
        }
        let mut events = BufReader::new(events);
        let name = name_of(&mut events);
        self.state().name.clone_from(&name);
        let has_name = name.is_some();
        if let Some(name) = name {
            let _ = tell.send(Ok(name));
        }
        // Nobody needs them: they are in its journal. It must not wait for a reader.
        io::copy(&mut events, &mut io::sink())?;
        if let Some(pid) = pid {
            rustix::process::waitid(
                WaitId::Pid(pid),
                WaitIdOptions::EXITED | WaitIdOptions::NOWAIT,
            )?;
        }
        // From here on its number may become another process's.
        self.state().process = None;
        drop(lifeline);
        child.wait()?;
        if !has_name {
            let _ = tell.send(Err(why(&mut said)?));
        }
        Ok(())
    }

    fn rest(&self) {
        let mut state = self.state();
        (state.process, state.name) = (None, None);
        self.busy.send_replace(false);
    }
}

impl State {
    fn signal(&mut self, number: i32, insists: bool) {
        let Some(pid) = self.process else { return };
        if !self.stopped || insists {
            self.stopped = true;
            child::signal(pid, number);
        }
    }
}

/// A run that was started: its process, its events, and what it says beside them.
struct Started {
    child: Child,
    /// The run ends when this is closed, be it by the death of this process.
    lifeline: Option<ChildStdin>,
    events: ChildStdout,
    said: File,
}

fn start(results: &std::path::Path, run: &str, folder: PathBuf) -> io::Result<Started> {
    let fixed = ["run", child::OPTION, "--color", "never", "--format", "json", "--results"];
    let mut command = child::again(fixed)?;
    command.arg(results).args(["--rerun", "failed", "--", run]).current_dir(folder);
    let said = tempfile::tempfile()?;
    let mut child = command.stdout(Stdio::piped()).stderr(said.try_clone()?).spawn()?;
    let events = child.stdout.take().ok_or(io::ErrorKind::BrokenPipe)?;
    let lifeline = child.stdin.take();
    Ok(Started { child, lifeline, events, said })
}

/// The run's name, from its first event: its journal is there then.
fn name_of(events: &mut impl BufRead) -> Option<String> {
    let mut line = String::new();
    events.read_line(&mut line).ok()?;
    match serde_json::from_str::<Event>(&line).ok()?.kind {
        EventKind::RunStarted(started) => Some(started.run),
        _ => None,
    }
}

/// What a run that was not started said, as an error and its hint.
fn why(said: &mut File) -> io::Result<RerunRejected> {
    said.rewind()?;
    let mut bytes = Vec::new();
    said.take(TOLD).read_to_end(&mut bytes)?;
    let text = String::from_utf8_lossy(&bytes);
    let (hints, reasons): (Vec<_>, Vec<_>) =
        text.trim().lines().partition(|line| line.starts_with("hint: "));
    let reason = reasons.join("\n");
    let reason = reason.strip_prefix("error: ").unwrap_or(&reason);
    let reason = if reason.is_empty() { "`rtf run` ended without a word" } else { reason };
    let hint = hints.first().and_then(|hint| hint.strip_prefix("hint: "));
    Ok(RerunRejected { reason: reason.to_owned(), hint: hint.map(str::to_owned) })
}

fn not(reason: impl Into<String>) -> RerunRejected {
    RerunRejected { reason: reason.into(), hint: None }
}
