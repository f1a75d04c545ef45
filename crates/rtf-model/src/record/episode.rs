//! The episodes of a campaign, and their results.

use super::case_episode::EpisodeCase;
use super::test::deciding;
use super::{AttemptRecord, Record, TestRecord};
use crate::{
    CaseId, Episode, EpisodeStarted, EventKind, Measurement, Micros, SuiteId, TestId, Verdict,
};

/// The result of one execution of an episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EpisodeOutcome {
    /// The suite was green.
    Passed,
    /// A test failed, crashed or timed out, or passed although a failure is expected.
    Failed,
    /// A test or a hook is an error, or a fixture could not be torn down.
    Error,
    /// A fixture collapsed or is broken.
    Collapsed,
}

impl EpisodeOutcome {
    /// The result of an episode in which something that is not green has this verdict.
    pub(super) fn of_problem(verdict: Verdict) -> Self {
        match verdict {
            Verdict::Error | Verdict::Interrupted => Self::Error,
            Verdict::Collapsed => Self::Collapsed,
            _ => Self::Failed,
        }
    }

    /// Whether the result says something about the bench only.
    #[must_use]
    pub fn is_of_bench(self) -> bool {
        matches!(self, Self::Error | Self::Collapsed)
    }
}

/// One execution of an episode.
#[derive(Clone, Debug, PartialEq)]
pub struct EpisodeRecord {
    /// The episode.
    pub episode: Episode,
    /// When it started.
    pub started: Micros,
    /// When it finished, its result, and the first reason why it did not pass. `None` while it
    /// runs, and if it was interrupted.
    pub finished: Option<(Micros, EpisodeOutcome, Option<String>)>,
    /// What there was when it started.
    before: Before,
    /// If it is a case: which one, and what its test reported about it.
    pub(super) case: Option<EpisodeCase>,
}

/// How many attempts and problems there were before an episode.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Before {
    /// The attempts of each test of the suite.
    attempts: Vec<usize>,
    /// The collapses and the other problems of each fixture.
    fixtures: Vec<(usize, usize)>,
    /// The problems of each hook.
    hooks: Vec<usize>,
}

/// An attempt of a test in a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct TestAttempt {
    /// The test.
    pub test: TestId,
    /// Its attempt, of all in the run, from 1.
    pub attempt: u32,
    /// The case that the episode is, of a test with slots.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub case: Option<CaseId>,
}

impl EpisodeRecord {
    pub(super) fn of_case(episode: Episode, started: Micros, case: EpisodeCase) -> Self {
        let before = Before::default();
        Self { episode, started, finished: None, before, case: Some(case) }
    }
}

impl Record {
    /// Applies an event of an episode; false for other events.
    pub(super) fn apply_to_episode(&mut self, at: Micros, kind: &EventKind) -> bool {
        match kind {
            EventKind::EpisodeStarted(started) => self.start_episode(at, started),
            EventKind::EpisodeFinished { suite, .. } => self.finish_episode(at, *suite),
            _ => return false,
        }
        true
    }

    fn start_episode(&mut self, at: Micros, started: &EpisodeStarted) {
        let Some(before) = self.before_episode(started.suite) else { return };
        let episode = started.episode.clone();
        let record = EpisodeRecord { episode, started: at, finished: None, before, case: None };
        self.suite(started.suite, |suite| suite.keep_episode(record));
    }

    fn before_episode(&self, suite: SuiteId) -> Option<Before> {
        let suite = self.suites.get(suite.index())?;
        let fixtures = self.fixtures_of(suite);
        Some(Before {
            attempts: self.tests_of(suite).map(|test| test.attempts.len()).collect(),
            fixtures: fixtures.map(|it| (it.collapses.len(), it.problems.len())).collect(),
            hooks: self.hooks_of(suite).map(|hook| hook.problems().count()).collect(),
        })
    }

    fn finish_episode(&mut self, at: Micros, suite: SuiteId) {
        let Some(record) = self.suites.get(suite.index()) else { return };
        let Some(episode) = record.episodes.last() else { return };
        let (outcome, reason) = self.episode_outcome(suite, &episode.before);
        self.suite(suite, |suite| {
            if let Some(episode) = suite.episodes.last_mut() {
                episode.finished = Some((at, outcome, reason));
            }
        });
    }

    /// The worst that happened since `before`: a collapse, an error, a failure.
    fn episode_outcome(&self, suite: SuiteId, before: &Before) -> (EpisodeOutcome, Option<String>) {
        let Some(suite) = self.suites.get(suite.index()) else {
            return (EpisodeOutcome::Error, None);
        };
        let mut problems = Vec::new();
        for (fixture, known) in self.fixtures_of(suite).zip(&before.fixtures) {
            problems.extend(fixture.problems_since(*known, suite.plan.tolerates_collapse));
        }
        for (hook, known) in self.hooks_of(suite).zip(&before.hooks) {
            problems.extend(hook.problems().skip(*known).map(|text| (EpisodeOutcome::Error, text)));
        }
        let tests = self.tests_of(suite).zip(&before.attempts);
        let parts = tests.map(|(test, first)| test.since(*first));
        let (ran, missing): (Vec<_>, Vec<_>) = parts.partition(TestRecord::is_complete_round);
        let failed = |part: &TestRecord| self.problem_of(part);
        let count = problems.len();
        problems.extend(ran.iter().chain(&missing).filter_map(failed));
        // Nothing explains that tests are missing: no critical test before them failed.
        if problems.len() == count {
            let text = |part: &TestRecord| format!("{} did not run completely", part.plan.name);
            problems.extend(missing.iter().map(|part| (EpisodeOutcome::Error, text(part))));
        }
        let severity = |outcome: EpisodeOutcome| outcome as u8;
        let worst = problems.into_iter().rev().max_by_key(|(outcome, _)| severity(*outcome));
        worst.map_or((EpisodeOutcome::Passed, None), |(outcome, reason)| (outcome, Some(reason)))
    }

    /// The measurements of the newest episode of a suite, each with its test: those of the last
    /// attempt of each repetition, outside of cases.
    #[must_use]
    pub fn episode_measurements(&self, suite: SuiteId) -> Vec<(&TestRecord, &Measurement)> {
        let Some(suite) = self.suites.get(suite.index()) else { return Vec::new() };
        let Some(episode) = suite.episodes.last() else { return Vec::new() };
        if let Some(case) = &episode.case {
            let test = self.tests.get(case.test.index());
            return test
                .map_or(Vec::new(), |test| case.measured.iter().map(|it| (test, it)).collect());
        }
        let tests = self.tests_of(suite).zip(&episode.before.attempts);
        let attempts = tests.flat_map(|(test, first)| {
            let attempts = test.attempts.get(*first..).unwrap_or_default();
            deciding(attempts).map(move |attempt| (test, attempt))
        });
        let measurements = attempts.flat_map(|(test, attempt)| {
            let own = attempt.measurements.iter().filter(|it| it.case.is_none());
            own.map(move |measurement| (test, measurement))
        });
        measurements.collect()
    }

    /// The test because of which the newest episode of a suite did not pass: the first one with the
    /// worst result. `None` if no test is the reason.
    #[must_use]
    pub fn episode_problem(&self, suite: SuiteId) -> Option<TestAttempt> {
        let suite = self.suites.get(suite.index())?;
        let episode = suite.episodes.last()?;
        if let Some(case) = &episode.case {
            return self.attempt_of(case);
        }
        let tests = self.tests_of(suite).zip(&episode.before.attempts);
        let problems = tests.filter_map(|(test, first)| {
            let part = test.since(*first);
            let (outcome, _) = self.problem_of(&part)?;
            let is_problem =
                |attempt: &AttemptRecord| attempt.verdict().is_some_and(Verdict::is_problem);
            let at = part.attempts.iter().rposition(is_problem);
            let at = first + at.unwrap_or(part.attempts.len() - 1);
            let attempt = u32::try_from(at).ok()?.checked_add(1)?;
            Some((outcome as u8, TestAttempt { test: test.plan.test, attempt, case: None }))
        });
        let problems: Vec<_> = problems.collect();
        problems.into_iter().rev().max_by_key(|(severity, _)| *severity).map(|(_, it)| it)
    }

    /// The test that shows the newest episode of a suite, if it passed: the first one that measured
    /// something, or else the first one that ran.
    #[must_use]
    pub fn episode_shown(&self, suite: SuiteId) -> Option<TestAttempt> {
        let suite = self.suites.get(suite.index())?;
        let episode = suite.episodes.last()?;
        if let Some(case) = &episode.case {
            return self.attempt_of(case);
        }
        let before = &episode.before;
        let tests = self.tests_of(suite).zip(&before.attempts);
        let ran: Vec<_> = tests.filter(|(test, first)| test.attempts.len() > **first).collect();
        let measured = |(test, first): &&(&TestRecord, &usize)| {
            test.attempts[**first..].iter().any(|attempt| !attempt.measurements.is_empty())
        };
        let (test, _) = ran.iter().find(measured).or(ran.first())?;
        let attempt = u32::try_from(test.attempts.len()).ok()?;
        Some(TestAttempt { test: test.plan.test, attempt, case: None })
    }

    /// Why the attempts of a test in an episode are not green.
    fn problem_of(&self, part: &TestRecord) -> Option<(EpisodeOutcome, String)> {
        if part.attempts.is_empty() || self.has_green_result(part) {
            return None;
        }
        let verdict = part.final_verdict();
        let outcome = EpisodeOutcome::of_problem(verdict);
        let name = &part.plan.name;
        let text = match part.reason() {
            Some(reason) => format!("{name}: {reason}"),
            None => format!("{name} is {verdict}"),
        };
        Some((outcome, text))
    }
}
