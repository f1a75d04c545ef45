//! The results of a campaign's episodes.

use crate::order::{ready, starting, stopped, stopping};
use crate::record::record;
use crate::support::*;
use rtf_model::{
    Episode, EpisodeOutcome, EpisodeStarted, EventKind, Measurement, Record, Trigger, Verdict,
};

fn begins(id: u64) -> EventKind {
    let episode = Episode { id, seed: 7, parameters: Vec::new(), masked: Vec::new() };
    EventKind::EpisodeStarted(EpisodeStarted { suite: SUITE, episode })
}

fn ends(episode: u64) -> EventKind {
    EventKind::EpisodeFinished { suite: SUITE, episode }
}

fn tested(verdict: Verdict) -> [EventKind; 2] {
    [started(1, 1), finished(verdict)]
}

fn collapsed() -> EventKind {
    let reason = "gone".to_owned();
    EventKind::FixtureCollapsed { fixture: SIMULATOR, reason, log_tail: Vec::new() }
}

/// The results of the episodes, with their reasons.
fn outcomes(record: &Record) -> Vec<(EpisodeOutcome, Option<&str>)> {
    let ended = record.suites[0].episodes.iter().filter_map(|it| it.finished.as_ref());
    ended.map(|(_, outcome, reason)| (*outcome, reason.as_deref())).collect()
}

fn one(body: impl IntoIterator<Item = EventKind>) -> (EpisodeOutcome, Option<String>) {
    let body = [begins(1)].into_iter().chain(body).chain([ends(1)]);
    let record = record(opened_with_hook(1).into_iter().chain(body));
    let [(outcome, reason)] = outcomes(&record)[..] else { panic!("one episode") };
    (outcome, reason.map(str::to_owned))
}

#[test]
fn the_worst_problem_decides() {
    use EpisodeOutcome::{Collapsed, Error, Failed, Passed};
    let of = |verdict| one(tested(verdict)).0;
    assert_eq!(of(Verdict::Passed), Passed);
    for verdict in [Verdict::Failed, Verdict::Crashed, Verdict::TimedOut] {
        assert_eq!(of(verdict), Failed, "{verdict}");
    }
    assert_eq!(of(Verdict::Error), Error);
    assert_eq!(of(Verdict::Interrupted), Error);
    assert_eq!(of(Verdict::Collapsed), Collapsed);
    let both = [starting(1), ready(), collapsed()].into_iter().chain(tested(Verdict::Failed));
    assert_eq!(one(both), (Collapsed, Some("fixture `fixture-0` collapsed: gone".to_owned())));
    let hook = [hook_started(Trigger::End), hook_finished(Some("it fell"))];
    let (outcome, reason) = one(tested(Verdict::Passed).into_iter().chain(hook));
    assert!(outcome == Error && reason.as_deref().is_some_and(|it| it.contains("it fell")));
}

#[test]
fn only_a_problem_of_the_bench_is_no_result() {
    use EpisodeOutcome::{Collapsed, Error, Failed, Passed};
    let of_bench = [Passed, Failed, Error, Collapsed].map(EpisodeOutcome::is_of_bench);
    assert_eq!(of_bench, [false, false, true, true]);
}

#[test]
fn a_test_that_is_missing_without_a_reason_is_an_error() {
    let (outcome, reason) = one([]);
    assert_eq!(outcome, EpisodeOutcome::Error);
    assert_eq!(reason.as_deref(), Some("test-0 did not run completely"));
}

#[test]
fn an_earlier_episode_does_not_decide_a_later_one() {
    let collapse = [starting(1), ready(), collapsed(), stopping(), stopped(), starting(2), ready()];
    let first = [begins(1)].into_iter().chain(collapse).chain(tested(Verdict::Failed));
    let second = [ends(1), begins(2)].into_iter().chain(tested(Verdict::Passed));
    let record = record(opened(1).into_iter().chain(first).chain(second).chain([ends(2)]));
    let found: Vec<_> = outcomes(&record).into_iter().map(|(outcome, _)| outcome).collect();
    assert_eq!(found, [EpisodeOutcome::Collapsed, EpisodeOutcome::Passed]);
    let episodes = &record.suites[0].episodes;
    assert!(episodes[0].started < episodes[1].started);
    assert_eq!(episodes.iter().map(|it| it.episode.id).collect::<Vec<_>>(), [1, 2]);
}

#[test]
fn measurements_of_the_newest_episode_are_those_of_its_tests() {
    let measured = |value| {
        let (name, unit) = ("lag".to_owned(), "s".to_owned());
        let (value, low, high, location, case) = (Some(value), None, None, None, None);
        let learned = false;
        let measurement = Measurement { name, value, unit, low, high, learned, location, case };
        EventKind::Measured { test: TEST, fixture: None, measurement }
    };
    let test = |value| [started(1, 1), measured(value), finished(Verdict::Passed)];
    let first = [begins(1)].into_iter().chain(test(1.0)).chain([ends(1)]);
    let second = [begins(2)].into_iter().chain(test(2.0)).chain([ends(2)]);
    let record = record(opened(1).into_iter().chain(first).chain(second));
    let values: Vec<_> =
        record.episode_measurements(SUITE).iter().map(|(_, it)| it.value).collect();
    assert_eq!(values, [Some(2.0)]);
    let shown = record.episode_shown(SUITE).expect("a test");
    assert_eq!((shown.test, shown.attempt), (TEST, 2));
}
