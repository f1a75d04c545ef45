//! Assigns the episodes of a campaign to the workers of a pool, and judges their results.

use std::time::Instant;

use rtf_campaign::file::StoppingRule;
use rtf_campaign::{Campaign, Judge, Judgement, Ledger};
use rtf_engine::signal::SignalListener;
use rtf_model::{Episode, EpisodeOutcome};
use rtf_report::episode_results::EpisodeLine;
use rtf_run::error::Failure;
use rtf_run::exit;

use super::pool::{EndedWorker, Pool, WorkerEvent};
use super::progress::Progress;
use super::questions::QuestionDesk;
use super::summary::EarlyEnd;
use super::worker;

/// SIGTERM.
const TERM: i32 = 15;
/// How many workers in succession may end without a result.
const MAX_FAILED_STARTS: u32 = 3;

/// A campaign that runs.
pub struct Coordinator<'a, P> {
    campaign: &'a Campaign,
    episodes: &'a [Episode],
    ledger: Ledger,
    judge: Judge,
    judgement: Judgement,
    /// How many of the first results are judged.
    judged: usize,
    pool: P,
    failed_starts: u32,
    early_end: Option<EarlyEnd>,
    /// The first problem of this process.
    failure: Option<Failure>,
    /// Whether the workers were signalled to stop.
    is_stopped: bool,
    /// Whether each worker runs its last episode first.
    is_reversed: bool,
    /// The end of the campaign's budget.
    deadline: Option<Instant>,
    progress: Progress<'a>,
    /// The questions of workers, if the operator can answer here.
    desk: Option<QuestionDesk>,
}

/// How a campaign has ended.
pub struct CampaignEnd {
    pub ledger: Ledger,
    pub judgement: Judgement,
    pub early_end: Option<EarlyEnd>,
}

impl<'a, P: Pool> Coordinator<'a, P> {
    /// A campaign with earlier results. The episodes that workers of the pool have are not open
    /// in the ledger.
    pub fn new(
        campaign: &'a Campaign,
        episodes: &'a [Episode],
        ledger: Ledger,
        pool: P,
    ) -> Result<Self, Failure> {
        let judge = Judge::new(campaign, episodes.len());
        let judge = judge.ok_or_else(|| Failure::internal("the claim cannot be judged"))?;
        Ok(Self {
            campaign,
            episodes,
            judgement: judge.judge(&ledger.results()),
            judged: ledger.complete(),
            ledger,
            judge,
            pool,
            failed_starts: 0,
            early_end: None,
            failure: None,
            is_stopped: false,
            is_reversed: false,
            deadline: campaign.budget.map(|budget| Instant::now() + budget),
            progress: Progress::new(campaign),
            desk: None,
        })
    }

    /// Prints nothing; each worker may run its last episode first.
    #[must_use]
    pub fn for_comparison(mut self, is_reversed: bool) -> Self {
        (self.is_reversed, self.progress) = (is_reversed, self.progress.silent());
        self
    }

    /// Lets the operator at this terminal answer the questions of workers.
    pub fn with_operator(self) -> Result<Self, Failure> {
        Ok(Self { desk: Some(QuestionDesk::open()?), ..self })
    }

    /// Runs the episodes until the claim is decided, all of them have results, or the user stops.
    pub async fn run(mut self, mut signals: SignalListener) -> Result<CampaignEnd, Failure> {
        let ended = self.run_workers(&mut signals).await;
        self.progress.end()?;
        ended?;
        let Self { ledger, judge, early_end, .. } = self;
        Ok(CampaignEnd { judgement: judge.judge(&ledger.results()), ledger, early_end })
    }

    async fn run_workers(&mut self, signals: &mut SignalListener) -> Result<(), Failure> {
        // A claim may be decided by the results of workers that still run.
        if self.judgement.is_final && !self.pool.is_empty() {
            self.stop(TERM).await;
        }
        loop {
            let started = self.start_workers().await;
            self.keep(started).await;
            if self.pool.is_empty() {
                return self.failure.take().map_or(Ok(()), Err);
            }
            tokio::select! {
                (number, _) = signals.next() => {
                    self.early_end.get_or_insert(EarlyEnd::Signal(number));
                    self.stop(number).await;
                }
                () = tokio::time::sleep(P::POLL) => {}
            }
            if P::PRINTS {
                let cleared = self.progress.end();
                self.keep(cleared).await;
            }
            let collected = self.collect().await;
            self.keep(collected).await;
            let answered = self.update_questions();
            self.keep(answered).await;
            self.judge().await;
            self.check_budget().await;
            let printed = self.progress.numbers(&self.ledger);
            self.keep(printed).await;
        }
    }

    /// Keeps the first failure, and stops the workers: the campaign ends when they have ended.
    async fn keep(&mut self, result: Result<(), Failure>) {
        if let Err(failure) = result {
            self.failure.get_or_insert(failure);
            if !self.is_stopped {
                self.stop(TERM).await;
            }
        }
    }

    async fn start_workers(&mut self) -> Result<(), Failure> {
        if self.is_stopped || self.judgement.is_final {
            return Ok(());
        }
        let mut lists = episodes_of(&self.ledger.take(self.pool.free()), self.episodes);
        for episode in lists.iter_mut().flatten() {
            episode.alone = self.ledger.runs_alone(episode.id);
        }
        if self.is_reversed {
            lists.iter_mut().for_each(|list| list.reverse());
        }
        self.pool.start(lists).await
    }

    /// Handles what has happened in the pool. All events are handled, even after a failure.
    async fn collect(&mut self) -> Result<(), Failure> {
        let mut first = Ok(());
        for event in self.pool.collect().await? {
            let handled = match event {
                WorkerEvent::Result(line) => self.record(line),
                WorkerEvent::Ended(ended) => self.on_worker_ended(ended).await,
            };
            first = first.and(handled);
        }
        first
    }

    fn update_questions(&mut self) -> Result<(), Failure> {
        let list = (self.campaign, self.episodes.len());
        let update =
            |desk: &mut QuestionDesk| desk.update(&mut self.pool, &mut self.progress, list);
        self.desk.as_mut().map_or(Ok(()), update)
    }

    fn record(&mut self, line: EpisodeLine) -> Result<(), Failure> {
        let index = usize::try_from(line.episode).ok().and_then(|id| id.checked_sub(1));
        if let Some(episode) = index.and_then(|index| self.episodes.get(index)) {
            self.progress.result(&line, episode, self.episodes.len())?;
        }
        if let Some(outcome) = line.outcome {
            self.ledger.record(line.episode, outcome, line.reason);
        }
        Ok(())
    }

    async fn on_worker_ended(&mut self, ended: EndedWorker) -> Result<(), Failure> {
        let EndedWorker { assignment, code, is_cancelled, outputs } = ended;
        let is_stopped = self.is_stopped || is_cancelled;
        if code == Some(exit::HOOK_FAILED) {
            self.early_end.get_or_insert(EarlyEnd::HookFailed);
            self.stop(TERM).await;
        }
        let ending = worker::ending(assignment.worker, code);
        let is_explained = assignment.any_problem || !assignment.running.is_empty() || is_stopped;
        match assignment.running.first() {
            _ if is_stopped => {}
            Some(episode) if assignment.running.len() == 1 => {
                let (outcome, reason) = (Some(EpisodeOutcome::Error), Some(ending.clone()));
                let episode = *episode;
                self.record(EpisodeLine { episode, outcome, reason, ..EpisodeLine::default() })?;
            }
            _ => self.ledger.lose(&assignment.running),
        }
        self.ledger.give_back(assignment.left);
        self.failed_starts = match assignment.has_results || is_stopped {
            true => 0,
            false => self.failed_starts + 1,
        };
        if code == Some(exit::BAD_INPUT) || self.failed_starts >= MAX_FAILED_STARTS {
            return Err(worker::failure(&ending, &outputs, |text| self.campaign.mask(text)));
        }
        // For example, the tear-down of a test that runs many episodes failed.
        if code == Some(exit::FAILED) && !is_explained {
            let ending = match assignment.has_results {
                true => format!("{ending} although all of its episodes passed"),
                false => format!("{ending} before its first episode"),
            };
            return Err(worker::failure(&ending, &outputs, |text| self.campaign.mask(text)));
        }
        Ok(())
    }

    /// Judges new results. A fixed number of episodes is judged when all have results.
    async fn judge(&mut self) {
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
                self.stop(TERM).await;
            }
        }
        if self.ledger.is_bench_broken() && self.early_end.is_none() {
            self.early_end = Some(EarlyEnd::BenchBroken);
            self.stop(TERM).await;
        }
    }

    async fn check_budget(&mut self) {
        let has_passed = self.deadline.is_some_and(|deadline| Instant::now() >= deadline);
        if has_passed && !self.is_stopped {
            self.early_end.get_or_insert(EarlyEnd::Budget);
            self.stop(TERM).await;
        }
    }

    /// Signals all workers to stop.
    async fn stop(&mut self, signal: i32) {
        self.is_stopped = true;
        self.pool.stop(signal).await;
    }
}

/// The episodes with these ids, from all `episodes` of a campaign.
pub fn episodes_of(lists: &[Vec<u64>], episodes: &[Episode]) -> Vec<Vec<Episode>> {
    let index = |id: &u64| usize::try_from(*id).ok()?.checked_sub(1);
    let episode = |id: &u64| episodes.get(index(id)?).cloned();
    lists.iter().map(|ids| ids.iter().filter_map(episode).collect()).collect()
}
