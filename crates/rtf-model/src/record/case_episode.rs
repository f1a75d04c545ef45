//! Episodes that are cases of a test with slots: several of them are open at a time.

use super::episode::EpisodeOutcome;
use super::{EpisodeRecord, Record, TestAttempt};
use crate::{
    CaseFinished, CaseId, CaseStarted, Episode, EpisodeEnd, Measurement, Micros, TestId, Verdict,
};

/// The case that an episode is.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct EpisodeCase {
    pub test: TestId,
    pub case: CaseId,
    /// What was measured in it, with its steps and its simulated time.
    pub measured: Vec<Measurement>,
    pub first_observation: Option<String>,
}

impl EpisodeRecord {
    /// The case that it is.
    #[must_use]
    pub fn case(&self) -> Option<CaseId> {
        self.case.as_ref().map(|case| case.case)
    }

    /// A text that is the same for the same first observation, if its test reported one.
    #[must_use]
    pub fn first_observation(&self) -> Option<&str> {
        self.case.as_ref()?.first_observation.as_deref()
    }
}

impl Record {
    /// A case starts. It may be an episode.
    pub(super) fn start_case_episode(&mut self, at: Micros, started: &CaseStarted) {
        let (Some(key), Some(test)) = (started.start.episode, self.tests.get(started.test.index()))
        else {
            return;
        };
        let suite = test.plan.suite;
        let episode = Episode::new(key.id, key.seed, started.start.parameters.clone());
        let (test, case) = (started.test, started.start.case);
        let case = EpisodeCase { test, case, measured: Vec::new(), first_observation: None };
        let record = EpisodeRecord::of_case(episode, at, case);
        self.suite(suite, |suite| suite.open_episodes.push(record));
    }

    /// A case finishes. If it is an episode, it is the suite's last one then, unless it was
    /// interrupted.
    pub(super) fn finish_case_episode(&mut self, at: Micros, end: &CaseFinished) {
        let Some(test) = self.tests.get(end.test.index()) else { return };
        let Some(suite) = self.suites.get_mut(test.plan.suite.index()) else { return };
        let case = Some(end.case);
        let Some(index) = suite.open_episodes.iter().position(|it| it.case() == case) else {
            return;
        };
        let mut record = suite.open_episodes.remove(index);
        let (outcome, reason) = match end.verdict {
            Verdict::Interrupted => return,
            Verdict::Passed => (EpisodeOutcome::Passed, None),
            // An episode that did not run shows nothing.
            Verdict::Skipped => (EpisodeOutcome::Error, end.reason.clone()),
            verdict => (EpisodeOutcome::of_problem(verdict), end.reason.clone()),
        };
        let reason = reason.map(|reason| format!("{}: {reason}", test.plan.name));
        record.finished = Some((at, outcome, reason));
        if let (Some(episode), Some(attempt)) = (&mut record.case, test.attempts.last()) {
            let own = attempt.measurements.iter().filter(|it| it.case == case);
            episode.measured.extend(own.cloned());
            if let Some(reported) = &end.episode {
                episode.measured.extend(measured(reported));
                episode.first_observation.clone_from(&reported.first_observation);
            }
        }
        suite.keep_episode(record);
    }

    /// The attempt of the test of which an episode is a case.
    pub(super) fn attempt_of(&self, case: &EpisodeCase) -> Option<TestAttempt> {
        let attempts = self.tests.get(case.test.index())?.attempts.len();
        let attempt = u32::try_from(attempts).ok()?;
        Some(TestAttempt { test: case.test, attempt, case: Some(case.case) })
    }
}

/// The steps and the simulated time of an episode.
#[expect(clippy::cast_precision_loss, reason = "an episode has fewer than 2^53 steps")]
fn measured(end: &EpisodeEnd) -> impl Iterator<Item = Measurement> {
    let number = |name: &str, unit: &str, value: f64| Measurement {
        name: name.to_owned(),
        unit: unit.to_owned(),
        value: Some(value),
        ..Measurement::default()
    };
    let steps = end.steps.map(|steps| number("steps", "", steps as f64));
    let time = end.time_us.map(|time| number("simulated time", "s", time as f64 / 1e6));
    steps.into_iter().chain(time)
}
