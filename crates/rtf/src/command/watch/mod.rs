//! `rtf watch`: runs again whenever something changes that the run depends on.
//!
//! Each round is this program again, as `rtf run` with the same options, so it
//! has its own guard. [`files`] knows what is watched, [`debounce`] when changes
//! count, [`rounds`] what is done about them; this module does it.

mod debounce;
mod files;
mod round;
mod rounds;

use std::collections::BTreeSet;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{ExitCode, ExitStatus};
use std::time::{Duration, Instant};

use notify::{Event, RecommendedWatcher, RecursiveMode, Watcher as _};
use rtf_engine::signal::Signals;
use rtf_report::escape;
use tokio::process::{Child, ChildStdin};
use tokio::sync::mpsc::{UnboundedReceiver, UnboundedSender, unbounded_channel};

use self::debounce::Debounce;
use self::files::Watched;
use self::rounds::{Order, Rounds};
use super::{Outcome, child, planning};
use crate::cli::RunArgs;
use crate::error::Failure;

/// SIGTERM.
const TERM: i32 = 15;
/// How often is looked whether suites with mistakes are repaired: what is
/// missing may come from anywhere.
const EVERY: Duration = Duration::from_secs(1);

/// Runs, and runs again, until a signal ends it.
pub fn run(args: &RunArgs) -> Outcome {
    // A round dies with the thread that started it: all is done in this one.
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    runtime.map_err(Failure::own)?.block_on(async { Watch::new(args)?.rounds().await })
}

type Told = notify::Result<Event>;

struct Watch<'a> {
    args: &'a RunArgs,
    begun: Instant,
    watched: Watched,
    /// When the suites were looked at.
    looked: Instant,
    /// Watches as long as it lives.
    watcher: Option<RecommendedWatcher>,
    /// The folders that it watches. One that was made anew is another one.
    folders: BTreeSet<(PathBuf, u64)>,
    tell: UnboundedSender<Told>,
    told: UnboundedReceiver<Told>,
    debounce: Debounce,
    state: Rounds,
    child: Option<Child>,
    /// Its standard input, which it ends with; `wait` would close it at once.
    lifeline: Option<ChildStdin>,
    signals: Signals,
}

/// What happened.
enum Input {
    Signal(i32),
    Event(Told),
    Ended(std::io::Result<ExitStatus>),
    Due,
    Look,
}

impl<'a> Watch<'a> {
    fn new(args: &'a RunArgs) -> Result<Self, Failure> {
        let (tell, told) = unbounded_channel();
        Ok(Self {
            args,
            begun: Instant::now(),
            watched: Watched::default(),
            looked: Instant::now(),
            watcher: None,
            folders: BTreeSet::new(),
            tell,
            told,
            debounce: Debounce::default(),
            state: Rounds::default(),
            child: None,
            lifeline: None,
            signals: Signals::install().map_err(Failure::own)?,
        })
    }

    async fn rounds(mut self) -> Outcome {
        let first = Watched::look(self.args, &self.watched);
        self.watch(first)?;
        let mut order = self.state.changed();
        loop {
            if let Some(code) = self.obey(order)? {
                return Ok(ExitCode::from(code));
            }
            order = match self.next().await {
                Input::Signal(number) => {
                    let order = self.state.signal(u8::try_from(number).unwrap_or(0));
                    if order == Order::Pass {
                        self.signal(number);
                    }
                    order
                }
                Input::Event(told) => {
                    self.note(told);
                    Order::Nothing
                }
                Input::Ended(status) => {
                    (self.child, self.lifeline) = (None, None);
                    let code = round::code_of(status.map_err(Failure::own)?);
                    let order = self.state.ended(code);
                    if order == Order::Rest {
                        let files = planning::count(self.watched.there(), "file");
                        say(&format!("exit code {code}; waiting for a change of {files}"))?;
                    }
                    order
                }
                Input::Due => match self.debounce.take(self.begun.elapsed()) {
                    Some(touched) => self.changed(&touched)?,
                    None => Order::Nothing,
                },
                Input::Look => self.changed(&BTreeSet::new())?,
            }
        }
    }

    async fn next(&mut self) -> Input {
        let due = self.debounce.due().map(|due| self.begun + due);
        // Not a time from now on: what is read in the folders is told, too, and never ends.
        let looks = self.watched.broken && self.debounce.is_empty() && self.child.is_none();
        let look = looks.then(|| self.looked + EVERY);
        tokio::select! {
            (number, _) = self.signals.next() => Input::Signal(number),
            // The other end is in `self`.
            Some(told) = self.told.recv() => Input::Event(told),
            status = end(&mut self.child) => Input::Ended(status),
            () = until(due) => Input::Due,
            () = until(look) => Input::Look,
        }
    }

    /// Does what is to be done; the exit code when that is the end.
    fn obey(&mut self, order: Order) -> Result<Option<u8>, Failure> {
        match order {
            Order::Nothing | Order::Rest | Order::Pass => {}
            Order::Start => self.start()?,
            Order::Stop => self.signal(TERM),
            Order::Exit(code) => return Ok(Some(code)),
        }
        Ok(None)
    }

    fn start(&mut self) -> Result<(), Failure> {
        let mut child = round::start().map_err(Failure::own)?;
        self.lifeline = child.stdin.take();
        self.child = Some(child);
        Ok(())
    }

    fn signal(&self, number: i32) {
        if let Some(pid) = self.child.as_ref().and_then(|child| child::pid(child.id()?)) {
            child::signal(pid, number);
        }
    }

    fn note(&mut self, told: Told) {
        let now = self.begun.elapsed();
        match told {
            Ok(event) if !event.need_rescan() => {
                for (file, touch) in self.watched.touches(&event) {
                    self.debounce.note(&file, touch, now);
                }
            }
            // Events were lost.
            _ => {
                for file in &self.watched.files {
                    self.debounce.note(file, debounce::Touch::Attributes, now);
                }
                self.debounce.lost(now);
            }
        }
    }

    /// Files changed, or may have.
    fn changed(&mut self, touched: &BTreeSet<PathBuf>) -> Result<Order, Failure> {
        let used = self.watched.uses(touched);
        let now = Watched::look(self.args, &self.watched);
        self.looked = Instant::now();
        let other = now != self.watched;
        if !used && !other {
            return Ok(Order::Nothing);
        }
        self.watch(now)?;
        let order = self.state.changed();
        let what = match order {
            Order::Start => "running again",
            Order::Stop => "stopping the run, then running again",
            _ => return Ok(order),
        };
        let name = touched.iter().find(|file| self.watched.files.contains(*file));
        let name =
            name.or_else(|| touched.first()).map_or("something".to_owned(), |file| shown(file));
        say(&format!("{name} changed; {what}"))?;
        Ok(order)
    }

    /// Watches the folders. What changed since the suites were read is seen:
    /// they are read again once their folders are watched.
    fn watch(&mut self, mut watched: Watched) -> Result<(), Failure> {
        loop {
            let folders = watched.folders();
            if self.watcher.is_none() || folders != self.folders {
                self.watcher = Some(watcher(&self.tell, &folders)?);
                self.folders = folders;
            }
            self.watched = watched;
            watched = Watched::look(self.args, &self.watched);
            if watched == self.watched {
                return Ok(());
            }
        }
    }
}

fn watcher(
    tell: &UnboundedSender<Told>,
    folders: &BTreeSet<(PathBuf, u64)>,
) -> Result<RecommendedWatcher, Failure> {
    let tell = tell.clone();
    // When nobody listens any more, the program ends.
    let handler = move |told| drop(tell.send(told));
    let mut watcher = notify::recommended_watcher(handler).map_err(Failure::own)?;
    for (folder, _) in folders {
        match watcher.watch(folder, RecursiveMode::NonRecursive) {
            // It went in between, which the next look shows.
            Err(_) if !folder.is_dir() => {}
            watching => watching.map_err(Failure::own)?,
        }
    }
    Ok(watcher)
}

async fn end(child: &mut Option<Child>) -> std::io::Result<ExitStatus> {
    match child {
        Some(child) => child.wait().await,
        None => std::future::pending().await,
    }
}

async fn until(due: Option<Instant>) {
    match due {
        Some(due) => tokio::time::sleep_until(due.into()).await,
        None => std::future::pending().await,
    }
}

fn shown(file: &Path) -> String {
    let current = std::env::current_dir().and_then(|folder| folder.canonicalize());
    let relative = current.ok().and_then(|current| file.strip_prefix(current).ok());
    escape::line(&relative.unwrap_or(file).to_string_lossy()).into_owned()
}

fn say(what: &str) -> Result<(), Failure> {
    let mut err = anstream::stderr().lock();
    Failure::unless_reader_left(writeln!(err, "rtf watch: {what}"))
}
