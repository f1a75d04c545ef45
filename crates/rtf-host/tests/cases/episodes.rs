//! Episodes of a test with slots: taken, entered, left and finished in any order.

use std::time::Duration;

use rtf_host::{CaseEnd, EpisodeResult, Sample, Session, Step, StepEnd, TakenEpisode};
use rtf_model::{Attachment, Episode, EpisodeEnd, Measurement, MessageKind, Outcome};
use serde_json::json;

use crate::script_host::{Runner, Script, case, in_run, report, send};

/// Takes an episode, which has arrived or arrives.
pub fn take(session: &Session) -> Episode {
    match session.take_episode(true) {
        TakenEpisode::Started(episode) => episode,
        other => panic!("{other:?}"),
    }
}

pub fn passed() -> EpisodeResult {
    EpisodeResult {
        outcome: Outcome::Passed,
        reason: String::new(),
        end: EpisodeEnd::default(),
        location: None,
    }
}

/// Waits until no episode follows.
pub fn take_none(session: &Session) {
    assert_eq!(session.take_episode(true), TakenEpisode::None);
}

/// Runs a test with these episodes to its end.
pub fn run(script: Script, slots: u32, ids: &[u64]) -> (Vec<String>, serde_json::Value) {
    let mut runner = Runner::start_episodes(script, slots);
    runner.send_episodes(ids.iter().copied());
    runner.end_episodes();
    runner.finish()
}

#[test]
fn episodes_finish_in_any_order_with_what_the_test_knows() {
    let (lines, result) = run(
        in_run!(session, {
            let first = take(session);
            let second = take(session);
            assert_eq!((second.id, second.seed), (7, 107));
            assert_eq!(second.parameters[0].name, "payload");
            let end = EpisodeEnd {
                steps: Some(212),
                time_us: Some(4_240_000),
                first_observation: Some("9f86".to_owned()),
            };
            let result = EpisodeResult {
                outcome: Outcome::Failed,
                reason: "slipped".to_owned(),
                end,
                location: None,
            };
            assert!(session.finish_episode(second.id, result));
            assert!(session.finish_episode(first.id, passed()));
            let timed_out = EpisodeResult { outcome: Outcome::TimedOut, ..passed() };
            assert!(session.finish_episode(take(session).id, timed_out));
            take_none(session);
        }),
        2,
        &[5, 7, 6],
    );
    let expected = [
        "start 1 in -: 5, episode 5",
        "start 2 in -: 7, episode 7",
        r#"end 2 failed slipped {"first_observation":"9f86","steps":212,"time_us":4240000}"#,
        "end 1 passed",
        "start 3 in -: 6, episode 6",
        "end 3 timed-out",
    ];
    assert_eq!(lines, expected);
    assert_eq!(result, json!({"outcome": "passed"}));
}

#[test]
fn what_a_thread_reports_belongs_to_the_episode_that_it_has_entered() {
    let (lines, _) = run(
        in_run!(session, {
            let (a, b) = (take(session).id, take(session).id);
            report(session, "outside");
            assert!(session.enter_episode(a));
            report(session, "in a");
            let (low, high, time, place) = (None, None, None, None);
            session.sample(&Sample { name: "I", value: 1.0, unit: "A", low, high, time, place });
            assert!(session.enter_episode(b));
            session.measure(Measurement { name: "t".to_owned(), ..Measurement::default() });
            case(session, "grasp", || {
                case(session, "close", || CaseEnd::Done);
                CaseEnd::Done
            });
            assert!(session.leave_episode(b));
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml").to_owned();
            session.attach(Attachment { path, ..Attachment::default() }).unwrap();
            report(session, "in a again");
            assert!(session.finish_episode(a, passed()));
            report(session, "after a");
            assert!(session.leave_episode(a));
            assert!(session.finish_episode(b, passed()));
            take_none(session);
        }),
        2,
        &[1, 2],
    );
    let expected = [
        "start 1 in -: 1, episode 1",
        "start 2 in -: 2, episode 2",
        "report in -: outside",
        "report in 1: in a",
        "1 samples in 1",
        "measured in 2",
        "start 3 in 2: grasp",
        "start 4 in 3: close",
        "end 4",
        "end 3",
        "attached in 1",
        "report in 1: in a again",
        "end 1 passed",
        "report in -: after a",
        "end 2 passed",
    ];
    assert_eq!(lines, expected);
}

#[test]
fn a_skip_in_an_episode_skips_it() {
    let (lines, result) = run(
        in_run!(session, {
            let (a, b) = (take(session).id, take(session).id);
            assert!(session.enter_episode(a));
            session.skip("no gripper");
            assert!(session.leave_episode(a));
            assert!(session.finish_episode(a, passed()));
            assert!(session.enter_episode(b));
            session.skip("no camera");
            assert!(session.finish_episode(b, passed()));
            assert!(session.leave_episode(b));
            take_none(session);
        }),
        2,
        &[1, 2],
    );
    assert_eq!(lines[2..], ["end 1 skipped no gripper", "end 2 skipped no camera"]);
    assert_eq!(result, json!({"outcome": "passed"}));
}

#[test]
fn a_test_waits_for_episodes_until_none_follows() {
    let mut runner = Runner::start_episodes(
        in_run!(session, {
            assert_eq!(session.take_episode(false), TakenEpisode::None);
            report(session, "none has arrived");
            let id = take(session).id;
            assert_eq!(session.take_episode(false), TakenEpisode::None);
            session.finish_episode(id, passed());
            take_none(session);
        }),
        1,
    );
    while runner.line()["params"]["text"] != "none has arrived" {}
    runner.send_episodes([9]);
    while runner.line()["method"] != "case-finished" {}
    runner.end_episodes();
    assert_eq!(runner.finish(), (Vec::new(), json!({"outcome": "passed"})));
}

#[test]
fn a_stop_request_ends_the_wait_and_leaves_episodes_open() {
    let mut runner = Runner::start_episodes(
        in_run!(session, {
            let id = take(session).id;
            assert_eq!(session.take_episode(true), TakenEpisode::Stopped);
            assert!(session.finish_episode(id, passed()));
            assert_eq!(session.take_episode(true), TakenEpisode::Stopped);
        }),
        2,
    );
    runner.send_episodes([9]);
    while runner.line()["method"] != "case-started" {}
    runner.send(&json!({"method": "interrupt", "params": {"reason": "Ctrl-C"}}));
    let result = json!({"outcome": "interrupted", "reason": "Ctrl-C"});
    assert_eq!(runner.finish(), (Vec::new(), result));
}

#[test]
fn several_threads_run_episodes() {
    let (mut lines, result) = run(
        in_run!(session, {
            std::thread::scope(|scope| {
                for _ in 0..4 {
                    scope.spawn(|| {
                        while let TakenEpisode::Started(Episode { id, .. }) =
                            session.take_episode(true)
                        {
                            assert!(session.enter_episode(id));
                            send(session, MessageKind::Failure, &id.to_string());
                            assert!(session.leave_episode(id));
                            assert!(session.finish_episode(id, passed()));
                        }
                    });
                }
            });
        }),
        4,
        &(1..=400).collect::<Vec<_>>(),
    );
    assert_eq!(result, json!({"outcome": "failed"}));
    let starts = lines.extract_if(.., |line| line.starts_with("start ")).collect::<Vec<_>>();
    let expected = (1..=400).map(|id| format!("start {id} in -: {id}, episode {id}"));
    assert!(starts == expected.collect::<Vec<_>>(), "{}", starts.join("\n"));
    for id in 1..=400 {
        assert!(lines.contains(&format!("failure in {id}: {id}")), "{id}");
    }
    assert_eq!(lines.len(), 800);
}

#[test]
fn a_thread_without_an_episode_reports_in_that_of_the_test() {
    let (lines, _) = run(
        in_run!(session, {
            let id = take(session).id;
            session.enter_episode(id);
            let reports = |text: &str| {
                std::thread::scope(|scope| {
                    scope.spawn(|| report(session, text));
                });
            };
            reports("entered");
            session.finish_episode(id, passed());
            reports("finished");
            session.leave_episode(id);
            take_none(session);
        }),
        1,
        &[1],
    );
    let expected = ["report in 1: entered", "end 1 passed", "report in -: finished"];
    assert_eq!(lines[1..], expected);
}

#[test]
fn a_wait_of_the_plugin_does_not_hold_results() {
    let mut runner = Runner::start_episodes(
        in_run!(session, {
            session.finish_episode(take(session).id, passed());
            assert!(session.wait(Duration::from_secs(60)));
        }),
        1,
    );
    runner.send_episodes([1]);
    while runner.line()["method"] != "case-finished" {}
    runner.send(&json!({"method": "interrupt", "params": {"reason": "Ctrl-C"}}));
    assert_eq!(runner.finish().1["outcome"], "interrupted");
}

#[test]
fn more_than_a_limit_is_timed_out_and_an_unknown_number_an_error() {
    let script: Script = in_run!(session, {
        let finish = |steps, time_us, outcome: Outcome| {
            let end = EpisodeEnd { steps, time_us, first_observation: None };
            session.finish_episode(
                take(session).id,
                EpisodeResult { outcome, reason: "slipped".to_owned(), end, location: None },
            );
        };
        finish(Some(500), Some(2_500_000), Outcome::Passed);
        finish(Some(501), Some(1), Outcome::Failed);
        finish(Some(1), Some(2_500_001), Outcome::Passed);
        finish(None, Some(1), Outcome::Passed);
        finish(Some(1), None, Outcome::Passed);
        finish(None, None, Outcome::Failed);
        let id = take(session).id;
        session.enter_episode(id);
        send(session, MessageKind::Failure, "it moves");
        session.leave_episode(id);
        session.finish_episode(id, passed());
        take_none(session);
    });
    let settings = json!({"slots": 1, "max_steps": 500, "max_time_us": 2_500_000});
    let mut runner = Runner::start_with_limits(script, &settings);
    runner.send_episodes(1..=7);
    runner.end_episodes();
    let (lines, _) = runner.finish();
    let ends = lines.iter().filter_map(|line| line.strip_prefix("end "));
    let ends: Vec<_> = ends.map(|end| end.split(" {").next().unwrap()).collect();
    let expected = [
        "1 passed",
        "2 timed-out not done after 500 steps",
        "3 timed-out not done after 2.5 s of simulated time",
        "4 error its number of steps is unknown, but the suite has `max-steps`",
        "5 error its simulated time is unknown, but the suite has `max-time`",
        "6 failed slipped",
        "7 passed",
    ];
    assert_eq!(ends, expected);
}
