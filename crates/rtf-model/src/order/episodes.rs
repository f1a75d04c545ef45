//! Episodes: one at a time in a suite, and no test runs across the end of one.

use super::{OrderChecker, Rule, ensure};
use crate::{EpisodeStarted, SuiteId};

impl OrderChecker {
    pub(super) fn start_episode(&mut self, started: &EpisodeStarted) -> Rule {
        let (suite, episode) = (started.suite, started.episode.id);
        self.suite_open(suite)?;
        self.no_test_runs(suite)?;
        // One without an end was interrupted: in a merged run, another runner continues.
        self.episodes.insert(suite, episode);
        Ok(())
    }

    pub(super) fn finish_episode(&mut self, suite: SuiteId, episode: u64) -> Rule {
        self.suite_open(suite)?;
        self.no_test_runs(suite)?;
        ensure(self.episodes.remove(&suite) == Some(episode), || {
            format!("episode {episode} is not running")
        })
    }

    fn no_test_runs(&self, suite: SuiteId) -> Rule {
        let running = self.tests.iter().position(|test| test.suite == suite && test.open);
        running.map_or(Ok(()), |test| Err(format!("test {test} still runs")))
    }
}
