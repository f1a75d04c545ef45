//! What a test with slots must not do, and what its author reads.

use rtf_host::{CaseEnd, EpisodeResult, Session, Step, StepEnd, TakenEpisode};
use rtf_model::EpisodeEnd;
use serde_json::json;

use crate::episodes::{passed, run, take, take_none};
use crate::script_host::{Runner, all, done, in_run, report};

/// The texts of all errors, each with its case.
fn errors(lines: &[String]) -> Vec<&str> {
    lines.iter().filter_map(|line| line.strip_prefix("error ")).collect()
}

#[test]
fn a_test_without_slots_gets_no_episodes() {
    let (lines, result) = all(in_run!(session, {
        assert_eq!(session.slots(), None);
        assert_eq!(session.take_episode(true), TakenEpisode::Stopped);
    }));
    assert_eq!(lines, ["error in -: the test has no `slots` in its suite, so it gets no episodes"]);
    assert_eq!(result, json!({"outcome": "error"}));
}

#[test]
fn an_episode_finishes_once() {
    let (lines, result) = run(
        in_run!(session, {
            let id = take(session).id;
            assert!(session.finish_episode(id, passed()));
            assert!(!session.finish_episode(id, passed()));
            assert!(!session.enter_episode(id));
            assert!(!session.finish_episode(2, passed()));
            take_none(session);
        }),
        2,
        &[1],
    );
    let not_open = |id| {
        format!(
            "in -: episode {id} is not open: it has finished already, or the test has not taken it"
        )
    };
    assert_eq!(errors(&lines), [not_open(1), not_open(1), not_open(2)]);
    assert_eq!(result, json!({"outcome": "error"}));
}

fn early() -> String {
    "in -: `run` returned before the last episode: take episodes until none follows".to_owned()
}

#[test]
fn an_episode_with_an_open_case_or_another_thread_in_it_cannot_finish() {
    let (lines, _) = run(
        in_run!(session, {
            let (a, b) = (take(session).id, take(session).id);
            session.enter_episode(a);
            assert!(session.begin_case("open".to_owned(), Vec::new(), None));
            assert!(!session.finish_episode(a, passed()));
            assert!(!session.leave_episode(a));
            session.enter_episode(b);
            session.end_case(CaseEnd::Done);
            session.leave_episode(b);
            session.end_case(CaseEnd::Done);
            std::thread::scope(|scope| {
                scope.spawn(|| assert!(!session.finish_episode(a, passed())));
            });
            session.finish_episode(b, passed());
            session.finish_episode(a, passed());
            session.leave_episode(a);
            take_none(session);
        }),
        2,
        &[1, 2],
    );
    let expected = [
        "in 3: episode 1 cannot finish: a case in it is open",
        "in 3: episode 1 is not the innermost one of the thread that leaves it",
        "in 2: a case was finished on a thread that has no open case",
        "in 1: episode 1 cannot finish: another thread has entered it",
    ];
    assert_eq!(errors(&lines), expected);
    assert_eq!(lines[lines.len() - 2..], ["end 2 passed", "end 1 passed"]);
}

#[test]
fn a_wait_without_a_free_slot_is_an_error() {
    let mut runner = Runner::start_episodes(
        in_run!(session, {
            let id = take(session).id;
            assert_eq!(session.take_episode(false), TakenEpisode::None);
            assert_eq!(session.take_episode(true), TakenEpisode::Stopped);
            session.finish_episode(id, passed());
            session.finish_episode(take(session).id, passed());
            take_none(session);
        }),
        1,
    );
    runner.send_episodes([1, 2]);
    runner.end_episodes();
    let (lines, _) = runner.finish();
    let error =
        "in -: no slot is free: all 1 have an open episode. Finish one before you take another";
    assert_eq!(errors(&lines), [error]);
}

#[test]
fn a_run_that_returns_with_open_episodes_is_an_error() {
    let script = in_run!(session, (0..6).for_each(|_| drop(take(session))));
    let (lines, result) = run(script, 8, &[3, 2, 9, 7, 5, 1]);
    let error = "in -: `run` returned before it finished episodes 1, 2, 3, 5, 7, …";
    assert_eq!(errors(&lines), [error]);
    assert_eq!(result, json!({"outcome": "error"}));
}

#[test]
fn a_run_that_returns_early_is_an_error() {
    let one = in_run!(session, assert!(session.finish_episode(take(session).id, passed())));
    let mut runner = Runner::start_episodes(one, 1);
    runner.send_episodes([1]);
    let (lines, result) = runner.finish();
    assert_eq!(errors(&lines), [early()]);
    assert_eq!(result, json!({"outcome": "error"}));
    let (lines, _) = run(one, 1, &[1, 2]);
    assert_eq!(errors(&lines), [early()]);
}

#[test]
fn a_case_outside_of_an_episode_is_an_error() {
    let (lines, _) = run(
        in_run!(session, {
            done(session, "loose");
            let id = take(session).id;
            session.enter_episode(id);
            std::thread::scope(|scope| {
                scope.spawn(|| done(session, "elsewhere"));
            });
            session.finish_episode(id, passed());
            done(session, "late");
            session.leave_episode(id);
            take_none(session);
        }),
        1,
        &[1],
    );
    let error = "a case is part of an episode: enter one before it";
    let expected =
        ["in -", "in 1", "in -"].map(|at| format!("{at}: in a test with slots, {error}"));
    assert_eq!(errors(&lines), expected);
}

#[test]
fn a_first_observation_is_short() {
    let (lines, _) = run(
        in_run!(session, {
            let id = take(session).id;
            let observed = |text: String| EpisodeResult {
                end: EpisodeEnd { first_observation: Some(text), ..EpisodeEnd::default() },
                ..passed()
            };
            assert!(!session.finish_episode(id, observed("é".repeat(65))));
            assert!(session.finish_episode(id, observed("é".repeat(64))));
            take_none(session);
        }),
        1,
        &[1],
    );
    let error =
        "in -: the first observation of episode 1 has 65 characters, expected at most 64: a hash";
    assert_eq!(errors(&lines), [error]);
}

#[test]
fn episodes_belong_to_run() {
    let mut runner = Runner::start_episodes(
        |session: &Session, step: Step| {
            match step {
                Step::Run => drop(take(session)),
                Step::TearDown => {
                    assert!(!session.finish_episode(1, passed()));
                    assert_eq!(session.take_episode(true), TakenEpisode::Stopped);
                    report(session, "parked");
                }
                _ => {}
            }
            StepEnd::Done
        },
        1,
    );
    runner.send_episodes([1]);
    let (lines, _) = runner.finish();
    let error = "in -: episodes are taken and finished in `run` only";
    assert_eq!(errors(&lines)[1..], [error, error]);
}
