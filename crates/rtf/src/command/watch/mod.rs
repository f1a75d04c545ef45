//! `rtf watch`: runs tests, and reruns them when a file changes that they depend on.
//!
//! Each run is a child process, `rtf run` with the same options, so that it has its own
//! guard. [`watched`] finds the files, [`rtf_run::watch`] decides when their changes are due,
//! and what to do; this module does it.

mod child;
mod watched;

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{ExitCode, ExitStatus};
use std::time::{Duration, Instant};

use clap::ArgMatches;
use notify::{Event, RecommendedWatcher, RecursiveMode, Watcher as _};
use rtf_engine::signal::SignalListener;
use rtf_report::escape;
use rtf_run::diagnostics::count;
use rtf_run::error::Failure;
use rtf_run::watch::debounce::{Debounce, FileChange};
use rtf_run::watch::state::{WatchAction, WatchState};
use rtf_run::{spawn_self, terminal};
use tokio::process::{Child, ChildStdin};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use self::watched::Watched;
use super::VerbResult;
use crate::cli::{InputArgs, RunArgs};
use crate::request::config;

/// SIGTERM.
const TERM: i32 = 15;
/// How often suites with errors are checked: a missing file may appear anywhere.
const RECHECK_INTERVAL: Duration = Duration::from_secs(1);

/// Runs and reruns tests until a signal ends it.
pub fn run(mut args: RunArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_watched_results(&mut args.input, matches)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(Failure::internal)?.block_on(async { Watch::new(&args.input)?.run().await })
}

type FileEvent = notify::Result<Event>;

struct Watch<'a> {
    args: &'a InputArgs,
    /// The instant to which the times of `debounce` are relative.
    epoch: Instant,
    watched: Watched,
    checked_at: Instant,
    watcher: Option<RecommendedWatcher>,
    /// The directories of `watcher`. Their inodes distinguish recreated directories.
    dirs: BTreeSet<(PathBuf, u64)>,
    event_sender: UnboundedSender<FileEvent>,
    events: UnboundedReceiver<FileEvent>,
    debounce: Debounce,
    state: WatchState,
    child: Option<Child>,
    /// The child's standard input, which `wait` would close.
    lifeline: Option<ChildStdin>,
    signals: SignalListener,
}

enum WatchInput {
    Signal(i32),
    File(FileEvent),
    RunEnded(io::Result<ExitStatus>),
    ChangesDue,
    RecheckDue,
}

impl<'a> Watch<'a> {
    fn new(args: &'a InputArgs) -> Result<Self, Failure> {
        let (event_sender, events) = unbounded_channel();
        Ok(Self {
            args,
            epoch: Instant::now(),
            watched: Watched::default(),
            checked_at: Instant::now(),
            watcher: None,
            dirs: BTreeSet::new(),
            event_sender,
            events,
            debounce: Debounce::default(),
            state: WatchState::default(),
            child: None,
            lifeline: None,
            signals: SignalListener::install().map_err(Failure::internal)?,
        })
    }

    async fn run(mut self) -> VerbResult {
        self.watch(Watched::find(self.args, &self.watched))?;
        let mut action = self.state.files_changed();
        loop {
            match action {
                WatchAction::None | WatchAction::Wait | WatchAction::PassSignal => {}
                WatchAction::Start => self.start()?,
                WatchAction::Stop => self.signal(TERM),
                WatchAction::Exit(code) => return Ok(ExitCode::from(code)),
            }
            let input = self.next_input().await;
            action = self.handle(input)?;
        }
    }

    async fn next_input(&mut self) -> WatchInput {
        let changes_due = self.debounce.due().map(|due| self.epoch + due);
        // Relative to the last check: checks read the directories, which causes events.
        let rechecks = self.watched.has_errors && self.debounce.is_empty() && self.child.is_none();
        let recheck_due = rechecks.then(|| self.checked_at + RECHECK_INTERVAL);
        tokio::select! {
            (number, _) = self.signals.next() => WatchInput::Signal(number),
            // `self` owns a sender, so the channel is open.
            Some(event) = self.events.recv() => WatchInput::File(event),
            status = wait(&mut self.child) => WatchInput::RunEnded(status),
            () = sleep_until(changes_due) => WatchInput::ChangesDue,
            () = sleep_until(recheck_due) => WatchInput::RecheckDue,
        }
    }

    fn handle(&mut self, input: WatchInput) -> Result<WatchAction, Failure> {
        match input {
            WatchInput::Signal(number) => {
                let action = self.state.signal(u8::try_from(number).unwrap_or(0));
                if action == WatchAction::PassSignal {
                    self.signal(number);
                }
                Ok(action)
            }
            WatchInput::File(event) => {
                self.record(event);
                Ok(WatchAction::None)
            }
            WatchInput::RunEnded(status) => {
                (self.child, self.lifeline) = (None, None);
                let code = spawn_self::exit_code(status.map_err(Failure::internal)?);
                let action = self.state.run_ended(code);
                if action == WatchAction::Wait {
                    let files = count(self.watched.existing_files(), "file");
                    report(&format!("exit code {code}; waiting for changes in {files}"))?;
                }
                Ok(action)
            }
            WatchInput::ChangesDue => match self.debounce.take_due(self.epoch.elapsed()) {
                Some(changed) => self.check(&changed),
                None => Ok(WatchAction::None),
            },
            WatchInput::RecheckDue => self.check(&BTreeSet::new()),
        }
    }

    fn start(&mut self) -> Result<(), Failure> {
        let mut child = child::start().map_err(Failure::internal)?;
        self.lifeline = child.stdin.take();
        self.child = Some(child);
        Ok(())
    }

    fn signal(&self, number: i32) {
        if let Some(pid) = self.child.as_ref().and_then(|child| spawn_self::pid(child.id()?)) {
            spawn_self::signal(pid, number);
        }
    }

    fn record(&mut self, event: FileEvent) {
        let now = self.epoch.elapsed();
        match event {
            Ok(event) if !event.need_rescan() => {
                for (file, change) in self.watched.changes(&event) {
                    self.debounce.record(&file, change, now);
                }
            }
            // Events were lost.
            _ => {
                for file in &self.watched.files {
                    self.debounce.record(file, FileChange::Attributes, now);
                }
                self.debounce.record_lost(now);
            }
        }
    }

    /// Checks whether the tests have changed, because of these files or others.
    fn check(&mut self, changed: &BTreeSet<PathBuf>) -> Result<WatchAction, Failure> {
        let is_used = self.watched.uses(changed);
        let current = Watched::find(self.args, &self.watched);
        self.checked_at = Instant::now();
        if !is_used && current == self.watched {
            return Ok(WatchAction::None);
        }
        self.watch(current)?;
        let action = self.state.files_changed();
        let consequence = match action {
            WatchAction::Start => "rerunning",
            WatchAction::Stop => "stopping the run, then rerunning",
            _ => return Ok(action),
        };
        let used = changed.iter().find(|file| self.watched.files.contains(*file));
        let file = used.or_else(|| changed.first()).map(|file| display(file));
        let file = file.as_deref().unwrap_or("a file");
        report(&format!("{file} changed; {consequence}"))?;
        Ok(action)
    }

    /// Watches the directories. Reads the suites once more when their directories are
    /// watched, so that no change is missed.
    fn watch(&mut self, mut watched: Watched) -> Result<(), Failure> {
        loop {
            let dirs = watched.dirs();
            if self.watcher.is_none() || dirs != self.dirs {
                self.watcher = Some(watcher(&self.event_sender, &dirs)?);
                self.dirs = dirs;
            }
            self.watched = watched;
            watched = Watched::find(self.args, &self.watched);
            if watched == self.watched {
                return Ok(());
            }
        }
    }
}

fn watcher(
    sender: &UnboundedSender<FileEvent>,
    dirs: &BTreeSet<(PathBuf, u64)>,
) -> Result<RecommendedWatcher, Failure> {
    let sender = sender.clone();
    // The receiver is dropped only when the program ends.
    let handler = move |event| drop(sender.send(event));
    let mut watcher = notify::recommended_watcher(handler).map_err(Failure::internal)?;
    for (dir, _) in dirs {
        match watcher.watch(dir, RecursiveMode::NonRecursive) {
            // It has been removed, which the next check detects.
            Err(_) if !dir.is_dir() => {}
            result => result.map_err(Failure::internal)?,
        }
    }
    Ok(watcher)
}

async fn wait(child: &mut Option<Child>) -> io::Result<ExitStatus> {
    match child {
        Some(child) => child.wait().await,
        None => std::future::pending().await,
    }
}

async fn sleep_until(due: Option<Instant>) {
    match due {
        Some(due) => tokio::time::sleep_until(due.into()).await,
        None => std::future::pending().await,
    }
}

/// The path relative to the current directory.
fn display(file: &Path) -> String {
    let current = std::env::current_dir().and_then(|dir| dir.canonicalize());
    let relative = current.ok().and_then(|current| file.strip_prefix(current).ok());
    escape::line(&relative.unwrap_or(file).to_string_lossy()).into_owned()
}

fn report(text: &str) -> Result<(), Failure> {
    terminal::stderr(|err| writeln!(err, "rtf watch: {text}"))
}
