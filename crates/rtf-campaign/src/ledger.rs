//! Which episodes have which result, and which are still to be run.

use std::collections::BTreeSet;

use rtf_model::EpisodeOutcome;

use crate::EpisodeResult;

/// After so many executions in succession whose results are the bench's, the bench does not work:
/// the campaign ends.
pub const MAX_BENCH_RESULTS: u32 = 10;

/// The executions of one episode.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Executions {
    /// The results that were the bench's.
    pub bench: u32,
    /// How often it was lost: several episodes were open in a process that ended.
    pub lost: u32,
    /// The result, once it is final.
    pub result: Option<EpisodeResult>,
    /// The last result and its reason.
    pub last: Option<(EpisodeOutcome, Option<String>)>,
}

/// The state of a campaign. Episodes are numbered from 1, as in the list of episodes.
#[derive(Clone, Debug)]
pub struct Ledger {
    episodes: Vec<Executions>,
    /// Episodes without a final result that no worker has, each after its number of results that
    /// were the bench's: repetitions come last.
    open: BTreeSet<(u32, u64)>,
    repeats: u32,
    /// How many episodes from the first one on have final results.
    complete: usize,
    bench_in_succession: u32,
}

impl Ledger {
    /// A campaign with a number of episodes, none of which has run. An episode whose result is
    /// the bench's is repeated up to `repeats` times.
    #[must_use]
    pub fn new(episodes: usize, repeats: u32) -> Self {
        Self {
            episodes: vec![Executions::default(); episodes],
            open: (1..=episodes as u64).map(|episode| (0, episode)).collect(),
            repeats,
            complete: 0,
            bench_in_succession: 0,
        }
    }

    /// Records a result of an episode. Results after the final one do not count.
    pub fn record(&mut self, episode: u64, outcome: EpisodeOutcome, reason: Option<String>) {
        let Some(executions) = index(episode).and_then(|index| self.episodes.get_mut(index)) else {
            return;
        };
        self.open.remove(&(executions.bench, episode));
        if executions.result.is_some() {
            return;
        }
        executions.last = Some((outcome, reason));
        executions.result = match outcome {
            EpisodeOutcome::Passed => Some(EpisodeResult::Passed),
            EpisodeOutcome::Failed => Some(EpisodeResult::Failed),
            EpisodeOutcome::Error | EpisodeOutcome::Collapsed => {
                executions.bench += 1;
                (executions.bench > self.repeats).then_some(EpisodeResult::None)
            }
        };
        match outcome.is_of_bench() {
            true => self.bench_in_succession += 1,
            false => self.bench_in_succession = 0,
        }
        if executions.result.is_none() {
            self.open.insert((executions.bench, episode));
        }
        while self.episodes.get(self.complete).is_some_and(|next| next.result.is_some()) {
            self.complete += 1;
        }
    }

    /// A worker has these episodes already.
    pub fn assign(&mut self, episodes: impl IntoIterator<Item = u64>) {
        for episode in episodes {
            if let Some(executions) = index(episode).and_then(|index| self.episodes.get(index)) {
                self.open.remove(&(executions.bench, episode));
            }
        }
    }

    /// A worker has ended while these episodes were open, and it is unknown which one is to blame.
    pub fn lose(&mut self, episodes: &BTreeSet<u64>) {
        for index in episodes.iter().filter_map(|episode| index(*episode)) {
            self.episodes.get_mut(index).into_iter().for_each(|it| it.lost += 1);
        }
    }

    /// Whether an episode is to run without others in its process: what happens then is its own
    /// result.
    #[must_use]
    pub fn runs_alone(&self, episode: u64) -> bool {
        let executions = index(episode).and_then(|index| self.episodes.get(index));
        executions.is_some_and(|it| it.bench > 0 || it.lost > 0)
    }

    /// A worker has ended without results of these episodes.
    pub fn give_back(&mut self, episodes: impl IntoIterator<Item = u64>) {
        for episode in episodes {
            let executions = index(episode).and_then(|index| self.episodes.get(index));
            if let Some(executions) = executions.filter(|it| it.result.is_none()) {
                self.open.insert((executions.bench, episode));
            }
        }
    }

    /// Takes the open episodes for a number of workers: in turn, so that the first episodes have
    /// results first. Workers without an episode are left out.
    pub fn take(&mut self, workers: usize) -> Vec<Vec<u64>> {
        let count = workers.min(self.open.len());
        let mut parts = vec![Vec::new(); count];
        if count > 0 {
            for (turn, (_, episode)) in std::mem::take(&mut self.open).into_iter().enumerate() {
                parts[turn % count].push(episode);
            }
        }
        parts
    }

    #[must_use]
    pub fn any_open(&self) -> bool {
        !self.open.is_empty()
    }

    /// The final results of the first episodes, up to the first one without.
    #[must_use]
    pub fn results(&self) -> Vec<EpisodeResult> {
        self.episodes[..self.complete].iter().filter_map(|it| it.result).collect()
    }

    /// How many episodes have a final result, in any order.
    #[must_use]
    pub fn count(&self, result: EpisodeResult) -> usize {
        self.episodes.iter().filter(|it| it.result == Some(result)).count()
    }

    /// How many of the first episodes have final results.
    #[must_use]
    pub fn complete(&self) -> usize {
        self.complete
    }

    #[must_use]
    pub fn episodes(&self) -> &[Executions] {
        &self.episodes
    }

    /// The campaign continues: earlier results of the bench do not end it, because it may work again.
    pub fn resume(&mut self) {
        self.bench_in_succession = 0;
    }

    #[must_use]
    pub fn is_bench_broken(&self) -> bool {
        self.bench_in_succession >= MAX_BENCH_RESULTS
    }
}

fn index(episode: u64) -> Option<usize> {
    usize::try_from(episode).ok()?.checked_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use EpisodeOutcome::{Collapsed, Error, Failed, Passed};

    #[test]
    fn lost_episodes_and_those_of_the_bench_run_alone() {
        let mut ledger = Ledger::new(4, 2);
        ledger.take(1);
        ledger.record(4, Error, None);
        ledger.lose(&BTreeSet::from([1, 2, 9]));
        ledger.give_back([1, 2, 3]);
        assert_eq!(
            [1, 2, 3, 4, 9].map(|id| ledger.runs_alone(id)),
            [true, true, false, true, false]
        );
        assert_eq!(ledger.take(1), [vec![1, 2, 3, 4]], "a lost one is no repetition of the bench");
        assert!(!ledger.is_bench_broken() && ledger.episodes()[0].bench == 0);
    }

    #[test]
    fn episodes_are_assigned_in_turn_and_given_back_in_order() {
        let mut ledger = Ledger::new(5, 2);
        assert_eq!(ledger.take(2), [vec![1, 3, 5], vec![2, 4]]);
        assert!(!ledger.any_open() && ledger.take(2).is_empty());
        assert!(Ledger::new(5, 2).take(0).is_empty());
        ledger.record(1, Passed, None);
        ledger.give_back([5, 3, 1]);
        assert_eq!(ledger.take(4), [vec![3], vec![5]]);
        ledger.give_back([5, 3]);
        ledger.assign([3, 4]);
        assert_eq!(ledger.take(2), [vec![5]]);
    }

    #[test]
    fn results_of_the_bench_are_repeated_and_never_dropped() {
        let mut ledger = Ledger::new(2, 1);
        ledger.take(1);
        ledger.record(1, Collapsed, Some("lost".to_owned()));
        assert_eq!((ledger.take(1), ledger.results()), (vec![vec![1]], vec![]));
        ledger.record(1, Error, None);
        assert_eq!((ledger.any_open(), ledger.results()), (false, vec![EpisodeResult::None]));
        ledger.record(1, Passed, None);
        assert_eq!(ledger.results(), [EpisodeResult::None], "the final result stays");
        ledger.record(2, Failed, None);
        assert_eq!(ledger.results(), [EpisodeResult::None, EpisodeResult::Failed]);
    }

    #[test]
    fn results_are_those_of_the_first_episodes() {
        let mut ledger = Ledger::new(3, 0);
        ledger.record(2, Passed, None);
        ledger.record(3, Failed, None);
        assert_eq!((ledger.complete(), ledger.count(EpisodeResult::Passed)), (0, 1));
        ledger.record(1, Passed, None);
        let expected = [EpisodeResult::Passed, EpisodeResult::Passed, EpisodeResult::Failed];
        assert_eq!(ledger.results(), expected);
    }

    #[test]
    fn a_bench_that_does_not_work_is_noticed() {
        let mut ledger = Ledger::new(20, 0);
        for episode in 1..MAX_BENCH_RESULTS.into() {
            ledger.record(episode, Error, None);
        }
        assert!(!ledger.is_bench_broken());
        ledger.record(19, Passed, None);
        ledger.record(20, Error, None);
        assert!(!ledger.is_bench_broken(), "an episode in between had a result");
        (0..MAX_BENCH_RESULTS).for_each(|_| ledger.bench_in_succession += 1);
        assert!(ledger.is_bench_broken());
        ledger.resume();
        assert!(!ledger.is_bench_broken(), "the bench was repaired");
    }
}
