//! `rtf campaign run`: starts workers with lists of episodes, follows their results, and judges
//! the claim.

use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use clap::ArgMatches;
use rtf_campaign::file::StoppingRule;
use rtf_campaign::{Campaign, Judge, Judgement, Ledger};
use rtf_engine::signal::SignalListener;
use rtf_model::{Episode, EpisodeOutcome};
use rtf_report::episode_results::EpisodeLine;
use rtf_report::escape;

use super::progress::Progress;
use super::summary::{self, EarlyEnd};
use super::worker::{self, Worker};
use crate::campaign::directory::{CampaignDir, Description};
use crate::campaign::{self, LoadedCampaign};
use crate::cli::CampaignRunArgs;
use crate::command::VerbResult;
use crate::diagnostics::count;
use crate::error::Failure;
use crate::request::{TestsRequest, config};
use crate::{exit, plan, terminal};

/// SIGTERM.
const TERM: i32 = 15;
/// How often the results of the workers are read.
const POLL: Duration = Duration::from_millis(20);
/// How many workers in succession may end without a result.
const MAX_FAILED_STARTS: u32 = 3;

/// Runs a campaign, or continues one.
pub fn run(mut args: CampaignRunArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let (loaded, dir, ledger) = match &args.resume {
        Some(path) => {
            wait_for_workers(&CampaignDir::open(path)?, args.shutdown_timeout)?;
            campaign::read_results(path)?
        }
        None => begin(&args)?,
    };
    let _lock = dir.lock()?;
    let episodes = loaded.episodes.episodes;
    let judge = Judge::new(&loaded.campaign, episodes.len());
    let judge = judge.ok_or_else(|| Failure::internal("the claim cannot be judged"))?;
    let claimed = loaded.campaign.claim.rate;
    let (name, workers) = (escape::line(&loaded.name), usize::from(args.workers.get()));
    terminal::stdout(|out| {
        let (episodes, workers) = (count(episodes.len(), "episode"), count(workers, "worker"));
        writeln!(out, "campaign {name}: {episodes}, {workers}, claim rate >= {claimed}")
    })?;
    let mut coordinator = Coordinator {
        campaign: &loaded.campaign,
        dir: &dir,
        episodes: &episodes,
        next_worker: dir.workers().last().map_or(1, |last| last + 1),
        judgement: judge.judge(&ledger.results()),
        judged: ledger.complete(),
        ledger,
        judge,
        most: workers,
        workers: Vec::new(),
        shutdown_timeout: args.shutdown_timeout,
        failed_starts: 0,
        early_end: None,
        is_stopped: false,
        progress: Progress::new(),
    };
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let ended = runtime.map_err(Failure::internal)?.block_on(coordinator.run());
    coordinator.progress.end()?;
    ended?;
    let Coordinator { ledger, judge, early_end, .. } = coordinator;
    let judgement = judge.judge(&ledger.results());
    dir.write_results(&summary::result_lines(&ledger, dir.recorded()))?;
    summary::print(&loaded.campaign, (&ledger, &judgement), early_end.as_ref(), &dir.path)?;
    Ok(ExitCode::from(summary::exit_code(&judgement, early_end.as_ref())))
}

/// Waits until the workers of a campaign that was killed have torn down.
fn wait_for_workers(dir: &CampaignDir, limit: Duration) -> Result<(), Failure> {
    drop(dir.lock()?);
    let begin = Instant::now();
    while dir.any_worker_runs() {
        if begin.elapsed() >= limit {
            let error = format!("workers of `{}` are still running", dir.path.display());
            return Err(Failure::input(error).hint("they end by themselves; try again later"));
        }
        std::thread::sleep(POLL);
    }
    Ok(())
}

/// Checks a new campaign, and creates its directory.
fn begin(args: &CampaignRunArgs) -> Result<(LoadedCampaign, CampaignDir, Ledger), Failure> {
    let file = args.file.as_deref().unwrap_or(Path::new(""));
    let loaded = campaign::load(file)?;
    loaded.print_warnings()?;
    let mut request = TestsRequest::of_suite(&loaded.suite, &args.profile)?;
    request.set_episodes(loaded.suite.clone(), loaded.episodes.episodes.clone());
    plan::plan(&request)?.print_warnings()?;
    let working_dir = request.options.runner.current_dir;
    let mut options = Vec::new();
    if let Some(profile) = &args.profile.profile {
        options.push(format!("--profile={profile}"));
    }
    options.extend(args.profile.set.iter().map(|(name, value)| format!("--set={name}={value}")));
    let description = Description {
        name: loaded.name.clone(),
        file: working_dir.join(file),
        suite: working_dir.join(&loaded.suite),
        working_dir,
        repeats: loaded.campaign.repeats,
        options,
    };
    let dir = CampaignDir::create(&args.results.results, description, &loaded.episodes)?;
    let ledger = Ledger::new(loaded.episodes.episodes.len(), loaded.campaign.repeats);
    Ok((loaded, dir, ledger))
}

struct Coordinator<'a> {
    campaign: &'a Campaign,
    dir: &'a CampaignDir,
    episodes: &'a [Episode],
    ledger: Ledger,
    judge: Judge,
    judgement: Judgement,
    /// How many of the first results are judged.
    judged: usize,
    /// The largest number of workers.
    most: usize,
    workers: Vec<Worker>,
    next_worker: u32,
    shutdown_timeout: Duration,
    failed_starts: u32,
    early_end: Option<EarlyEnd>,
    /// Whether the workers were signalled to stop.
    is_stopped: bool,
    progress: Progress,
}

impl Coordinator<'_> {
    async fn run(&mut self) -> Result<(), Failure> {
        let mut signals = SignalListener::install().map_err(Failure::internal)?;
        loop {
            self.start_workers()?;
            if self.workers.is_empty() {
                return Ok(());
            }
            tokio::select! {
                (number, _) = signals.next() => {
                    self.early_end.get_or_insert(EarlyEnd::Signal(number));
                    self.stop(number);
                }
                () = tokio::time::sleep(POLL) => {}
            }
            self.collect()?;
            self.judge();
            self.progress.numbers(&self.ledger)?;
        }
    }

    fn start_workers(&mut self) -> Result<(), Failure> {
        if self.is_stopped || self.judgement.is_final {
            return Ok(());
        }
        for ids in self.ledger.take(self.most - self.workers.len()) {
            let index = |id: &u64| usize::try_from(*id).ok()?.checked_sub(1);
            let episode = |id: &u64| self.episodes.get(index(id)?).cloned();
            let episodes: Vec<Episode> = ids.iter().filter_map(episode).collect();
            let number = self.next_worker;
            self.next_worker += 1;
            self.workers.push(Worker::start(self.dir, number, &episodes, self.shutdown_timeout)?);
        }
        Ok(())
    }

    /// Reads the results of all workers, and removes those that have ended.
    fn collect(&mut self) -> Result<(), Failure> {
        let mut index = 0;
        while let Some(worker) = self.workers.get_mut(index) {
            // Before the results are read, so that none is missed.
            let ended = worker.exit_code();
            for line in worker.new_results() {
                self.record(line)?;
            }
            match ended {
                Some(code) => {
                    let worker = self.workers.remove(index);
                    self.on_worker_ended(worker, code)?;
                }
                None => index += 1,
            }
        }
        Ok(())
    }

    fn record(&mut self, line: EpisodeLine) -> Result<(), Failure> {
        let index = usize::try_from(line.episode).ok().and_then(|id| id.checked_sub(1));
        if let Some(episode) = index.and_then(|index| self.episodes.get(index)) {
            self.progress.result(&line, episode)?;
        }
        if let Some(outcome) = line.outcome {
            self.ledger.record(line.episode, outcome, line.reason);
        }
        Ok(())
    }

    fn on_worker_ended(&mut self, worker: Worker, code: u8) -> Result<(), Failure> {
        if code == exit::HOOK_FAILED {
            self.early_end.get_or_insert(EarlyEnd::HookFailed);
            self.stop(TERM);
        }
        if let Some(episode) = worker.running.filter(|_| !self.is_stopped) {
            let reason = format!("worker {} ended with exit code {code}", worker.number);
            let (outcome, reason) = (Some(EpisodeOutcome::Error), Some(reason));
            self.record(EpisodeLine { episode, outcome, reason, ..EpisodeLine::default() })?;
        }
        self.ledger.give_back(worker.left.iter().copied());
        self.failed_starts = match worker.has_results || self.is_stopped {
            true => 0,
            false => self.failed_starts + 1,
        };
        if code == exit::BAD_INPUT || self.failed_starts >= MAX_FAILED_STARTS {
            self.stop(TERM);
            let dir = self.dir.worker(worker.number);
            let output = escape::line(&worker::last_output(&dir)).replace("\\n", "\n");
            let error = format!("worker {} ended with exit code {code}:\n{output}", worker.number);
            let hint = format!("its output is `{}`", dir.join(worker::OUTPUT).display());
            return Err(Failure::internal(error).hint(hint));
        }
        Ok(())
    }

    /// Judges new results. A fixed number of episodes is judged when all have results.
    fn judge(&mut self) {
        let complete = self.ledger.complete();
        let is_due = match self.campaign.stop {
            StoppingRule::Fixed => complete == self.episodes.len(),
            // A hundredth more episodes than before, because each judgement reads all results.
            _ => complete - self.judged > self.judged / 100,
        };
        if complete > self.judged && (is_due || complete == self.episodes.len()) {
            self.judged = complete;
            self.judgement = self.judge.judge(&self.ledger.results());
            if self.judgement.is_final && complete < self.episodes.len() {
                self.stop(TERM);
            }
        }
        if self.ledger.is_bench_broken() && self.early_end.is_none() {
            self.early_end = Some(EarlyEnd::BenchBroken);
            self.stop(TERM);
        }
    }

    /// Signals all workers to stop.
    fn stop(&mut self, signal: i32) {
        self.is_stopped = true;
        self.workers.iter().for_each(|worker| worker.signal(signal));
    }
}
