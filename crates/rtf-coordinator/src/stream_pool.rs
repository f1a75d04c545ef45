//! Workers that run episodes as they are asked for, one at a time each; their fixtures stay up in
//! between.

use std::collections::VecDeque;
use std::fs::File;
use std::io::Write as _;
use std::process::{Child, ChildStdin, ExitCode};
use std::time::Duration;

use rtf_campaign::ledger::MAX_BENCH_RESULTS;
use rtf_engine::signal::SignalListener;
use rtf_model::{Episode, EpisodeOutcome};
use rtf_report::episode_results::EpisodeLine;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::error::Failure;
use rtf_run::spawn_self::{self, exit_code};
use rtf_run::{VerbResult, exit};
use serde::Serialize;

use super::assignment::ResultFollower;
use super::worker;

/// How often the results of the workers are read: an episode is the answer to a question.
pub const POLL: Duration = Duration::from_millis(5);
/// SIGTERM.
const TERM: i32 = 15;
/// How many workers in succession may end without a result.
const MAX_FAILED_STARTS: u32 = 3;

/// Why episodes do not run any more.
pub enum Ended {
    Signal(i32),
    /// A hook of a worker failed.
    HookFailed,
    /// The bench or `rtf` does not work.
    Failure(Failure),
}

impl From<Failure> for Ended {
    fn from(failure: Failure) -> Self {
        Self::Failure(failure)
    }
}

impl Ended {
    /// The result of the verb, unless a hook fails during the tear-down.
    pub fn into_result(self) -> VerbResult {
        match self {
            Self::Signal(number) => Ok(ExitCode::from(exit::of_signal(number))),
            Self::HookFailed => Ok(ExitCode::from(exit::HOOK_FAILED)),
            Self::Failure(failure) => Err(failure),
        }
    }
}

/// An episode that has not its final result.
#[derive(Clone, Debug)]
struct Asked {
    episode: Episode,
    /// How many of its results were the bench's.
    bench: u32,
}

/// The workers.
#[derive(Debug)]
pub struct StreamPool<'a> {
    dir: &'a CampaignDir,
    /// The largest number of workers.
    most: usize,
    shutdown_timeout: Duration,
    workers: Vec<StreamWorker>,
    next_worker: u32,
    waiting: VecDeque<Asked>,
    failed_starts: u32,
    bench_in_succession: u32,
    episodes: File,
    results: File,
}

/// A worker: `rtf run --episodes -`.
#[derive(Debug)]
struct StreamWorker {
    number: u32,
    child: Child,
    /// The worker ends when this is closed, also if this process is killed.
    input: Option<ChildStdin>,
    results: ResultFollower,
    running: Option<Asked>,
    has_results: bool,
}

impl<'a> StreamPool<'a> {
    /// No worker runs yet.
    pub fn new(
        dir: &'a CampaignDir,
        most: usize,
        shutdown_timeout: Duration,
    ) -> Result<Self, Failure> {
        Ok(Self {
            dir,
            most,
            shutdown_timeout,
            workers: Vec::new(),
            next_worker: 1,
            waiting: VecDeque::new(),
            failed_starts: 0,
            bench_in_succession: 0,
            episodes: dir.append_to_episodes()?,
            results: dir.append_to_results()?,
        })
    }

    /// Runs an episode as soon as a worker is free.
    pub fn ask(&mut self, episode: Episode) -> Result<(), Failure> {
        write_line(&mut self.episodes, &episode)?;
        self.waiting.push_back(Asked { episode, bench: 0 });
        Ok(())
    }

    /// Whether all episodes have results.
    pub fn is_idle(&self) -> bool {
        self.waiting.is_empty() && self.workers.iter().all(|worker| worker.running.is_none())
    }

    /// Runs one episode.
    pub async fn run(
        &mut self,
        episode: Episode,
        signals: &mut SignalListener,
    ) -> Result<EpisodeLine, Ended> {
        self.ask(episode)?;
        loop {
            if let Some(line) = self.step()?.pop() {
                return Ok(line);
            }
            tokio::select! {
                (number, _) = signals.next() => return Err(Ended::Signal(number)),
                () = tokio::time::sleep(POLL) => {}
            }
        }
    }

    /// Assigns what waits, and returns the results that have arrived.
    pub fn step(&mut self) -> Result<Vec<EpisodeLine>, Ended> {
        self.assign()?;
        let mut finished = Vec::new();
        let mut index = 0;
        while let Some(worker) = self.workers.get_mut(index) {
            // Before the results are read, so that none is missed.
            let ended = worker.child.try_wait().map_err(Failure::internal)?.map(exit_code);
            let lines = worker.results.read();
            if let Some(line) = lines.into_iter().find(|line| line.outcome.is_some())
                && let Some(asked) = worker.running.take()
            {
                worker.has_results = true;
                finished.extend(self.record(asked, line)?);
            }
            match ended {
                Some(code) => {
                    let worker = self.workers.remove(index);
                    finished.extend(self.on_worker_ended(worker, code)?);
                }
                None => index += 1,
            }
        }
        Ok(finished)
    }

    fn assign(&mut self) -> Result<(), Failure> {
        while !self.waiting.is_empty() {
            let is_free =
                |worker: &StreamWorker| worker.running.is_none() && worker.input.is_some();
            let free = self.workers.iter().position(is_free);
            let index = match free {
                Some(free) => free,
                None if self.workers.len() < self.most => {
                    let worker =
                        StreamWorker::start(self.dir, self.next_worker, self.shutdown_timeout)?;
                    self.next_worker += 1;
                    self.workers.push(worker);
                    self.workers.len() - 1
                }
                None => return Ok(()),
            };
            if let Some(asked) = self.waiting.pop_front() {
                self.workers[index].assign(asked)?;
            }
        }
        Ok(())
    }

    /// The final result of an episode; `None` if it is repeated.
    fn record(
        &mut self,
        mut asked: Asked,
        line: EpisodeLine,
    ) -> Result<Option<EpisodeLine>, Ended> {
        if line.outcome.is_some_and(EpisodeOutcome::is_of_bench) {
            asked.bench += 1;
            self.bench_in_succession += 1;
            if self.bench_in_succession >= MAX_BENCH_RESULTS {
                let reason = line.reason.unwrap_or_default();
                let error = format!(
                    "{MAX_BENCH_RESULTS} results in succession are errors or collapses of the bench, the last one: {reason}"
                );
                let hint = format!("`{}` has the runs of the workers", self.dir.path.display());
                return Err(Failure::internal(error).hint(hint).into());
            }
            if asked.bench <= self.dir.description.repeats {
                self.waiting.push_front(asked);
                return Ok(None);
            }
        } else {
            self.bench_in_succession = 0;
        }
        write_line(&mut self.results, &line)?;
        Ok(Some(line))
    }

    /// A worker ends by itself only if something is wrong.
    fn on_worker_ended(
        &mut self,
        worker: StreamWorker,
        code: u8,
    ) -> Result<Option<EpisodeLine>, Ended> {
        if code == exit::HOOK_FAILED {
            return Err(Ended::HookFailed);
        }
        self.failed_starts = if worker.has_results { 0 } else { self.failed_starts + 1 };
        if code == exit::BAD_INPUT || self.failed_starts >= MAX_FAILED_STARTS {
            let ending = worker::ending(worker.number, Some(code));
            let output = worker::output(self.dir, worker.number);
            return Err(worker::failure(&ending, &[output], str::to_owned).into());
        }
        let Some(asked) = worker.running else { return Ok(None) };
        let reason = format!("worker {} ended with exit code {code}", worker.number);
        let (episode, outcome) = (asked.episode.id, Some(EpisodeOutcome::Error));
        self.record(
            asked,
            EpisodeLine { episode, outcome, reason: Some(reason), ..Default::default() },
        )
    }

    /// Ends the workers, and waits until they have torn down; episodes that run are stopped.
    /// Returns the exit code if a hook failed.
    pub async fn finish(
        &mut self,
        ended: Option<&Ended>,
        signals: &mut SignalListener,
    ) -> Result<Option<ExitCode>, Failure> {
        self.waiting.clear();
        self.workers.iter_mut().for_each(|worker| worker.input = None);
        match ended {
            Some(Ended::Signal(number)) => self.signal(*number),
            Some(_) => self.signal(TERM),
            None => {}
        }
        let mut hook_failed = false;
        while !self.workers.is_empty() {
            tokio::select! {
                (number, _) = signals.next() => self.signal(number),
                () = tokio::time::sleep(POLL) => {}
            }
            let mut running = Vec::new();
            for mut worker in self.workers.drain(..) {
                match worker.child.try_wait().map_err(Failure::internal)?.map(exit_code) {
                    Some(code) => hook_failed |= code == exit::HOOK_FAILED,
                    None => running.push(worker),
                }
            }
            self.workers = running;
        }
        Ok(hook_failed.then_some(ExitCode::from(exit::HOOK_FAILED)))
    }

    fn signal(&self, number: i32) {
        for worker in &self.workers {
            if let Some(pid) = spawn_self::pid(worker.child.id()) {
                spawn_self::signal(pid, number);
            }
        }
    }
}

impl StreamWorker {
    fn start(dir: &CampaignDir, number: u32, shutdown_timeout: Duration) -> Result<Self, Failure> {
        dir.create_worker(number, &[])?;
        let mut child = worker::command(dir, number, "-".as_ref(), shutdown_timeout)?
            .spawn()
            .map_err(Failure::internal)?;
        let results = ResultFollower::of_worker(dir, number);
        let input = child.stdin.take();
        Ok(Self { number, child, input, results, running: None, has_results: false })
    }

    /// Writes the episode to the worker. One that has ended cannot read it, which is noticed when
    /// its exit code is read.
    fn assign(&mut self, asked: Asked) -> Result<(), Failure> {
        if let Some(input) = &mut self.input {
            let mut line = serde_json::to_vec(&asked.episode).map_err(Failure::internal)?;
            line.push(b'\n');
            let _ = input.write_all(&line);
        }
        self.running = Some(asked);
        Ok(())
    }
}

fn write_line(file: &mut File, value: &impl Serialize) -> Result<(), Failure> {
    let mut line = serde_json::to_vec(value).map_err(Failure::internal)?;
    line.push(b'\n');
    file.write_all(&line).map_err(Failure::internal)
}
