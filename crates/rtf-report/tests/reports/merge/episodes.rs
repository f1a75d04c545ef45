//! Workers of a campaign, merged.

use rtf_model::{
    Episode, EpisodeRecord, EpisodeStarted, Event, EventKind, Manifest, Micros, Record, RunStarted,
    SuiteId, TestFinished, TestId, Verdict,
};

use super::merged;

const SUITE: SuiteId = SuiteId(0);
const TEST: TestId = TestId(0);

/// A worker that runs a suite of one test in these episodes; the test passes in the odd ones.
fn worker(episodes: &[u64]) -> Vec<Event> {
    let mut kinds = vec![
        EventKind::RunStarted(RunStarted {
            version: 1,
            run: format!("worker-{episodes:?}"),
            rtf: "0.1.0".into(),
            started_at: "2026-11-21T06:30:12+00:00".into(),
            command: Vec::new(),
            working_dir: "/robot".into(),
            suites: 1,
            tests: 1,
            manifest: Box::new(Manifest::default()),
        }),
        from_json(r#"{"type":"suite-planned","suite":0,"name":"arm","file":"arm.xml"}"#),
        from_json(
            r#"{"type":"test-planned","test":0,"suite":0,"name":"Move","plugin_type":"lua",
                "plugin":"M.lua","repetitions":1,"timed":true}"#,
        ),
        EventKind::SuiteStarted { suite: SUITE },
    ];
    for (repetition, &id) in (1..).zip(episodes) {
        let episode = Episode { id, seed: 7, parameters: Vec::new(), masked: Vec::new() };
        kinds.push(EventKind::EpisodeStarted(EpisodeStarted { suite: SUITE, episode }));
        kinds.push(EventKind::TestStarted { test: TEST, repetition, attempt: 1 });
        kinds.push(from_json(r#"{"type":"case-started","test":0,"case":1,"name":"joint"}"#));
        kinds.push(from_json(r#"{"type":"case-finished","test":0,"case":1,"verdict":"passed"}"#));
        let verdict = if id % 2 == 1 { "passed" } else { "failed" };
        kinds.push(from_json(&format!(
            r#"{{"type":"test-finished","test":0,"verdict":"{verdict}","phase":"run"}}"#
        )));
        kinds.push(EventKind::EpisodeFinished { suite: SUITE, episode: id });
    }
    let repetitions = u32::try_from(episodes.len()).unwrap();
    kinds.push(EventKind::TestRepeated { test: TEST, repetitions });
    kinds.push(EventKind::SuiteFinished { suite: SUITE });
    kinds.push(EventKind::RunFinished { interrupted: None });
    let event = |(seq, kind)| Event { seq, at: Micros(seq * 10), kind };
    (0..).zip(kinds).map(event).collect()
}

fn from_json(text: &str) -> EventKind {
    serde_json::from_str(text).unwrap()
}

/// The episodes with their results, in order.
fn results(record: &Record) -> Vec<String> {
    let episodes = record.suites[0].episodes.iter();
    let result = |episode: &EpisodeRecord| match &episode.finished {
        Some((_, outcome, _)) => format!("{} {outcome:?}", episode.episode.id),
        None => format!("{} interrupted", episode.episode.id),
    };
    episodes.map(result).collect()
}

#[test]
fn workers_with_the_same_test_in_other_episodes_are_one_run() {
    let merged = merged([worker(&[1, 4]), worker(&[2, 3, 5])]).unwrap();
    let wanted = ["1 Passed", "4 Failed", "2 Failed", "3 Passed", "5 Passed"];
    assert_eq!(results(&merged), wanted);
    let [test] = &merged.tests[..] else { panic!("one test") };
    let numbers: Vec<_> =
        test.attempts.iter().map(|attempt| (attempt.repetition, attempt.attempt)).collect();
    assert_eq!(numbers, [(1, 1), (2, 1), (3, 1), (4, 1), (5, 1)]);
    assert_eq!(test.repetitions(), Some(5));
    assert_eq!(merged.final_verdict(TEST), Verdict::Failed);
    assert!(merged.is_complete());
}

/// At any moment. The other worker repeats the episode.
#[test]
fn an_episode_of_a_worker_that_was_killed_has_no_result() {
    let whole = worker(&[1, 3]);
    let started = |event: &&Event| matches!(event.kind, EventKind::EpisodeStarted(_));
    for length in 4..whole.len() - 2 {
        let mut killed = whole[..length].to_vec();
        // It announces another attempt.
        if let Some(EventKind::TestFinished(TestFinished { rerun, .. })) =
            killed.last_mut().map(|event| &mut event.kind)
        {
            *rerun = true;
        }
        let begun = killed.iter().filter(started).count();
        let finished =
            killed.iter().filter(|event| matches!(event.kind, EventKind::EpisodeFinished { .. }));
        let mut wanted: Vec<_> = ["1 Passed", "3 Passed"][..finished.count()].to_vec();
        wanted.extend(["1 interrupted", "3 interrupted"][..begun].iter().skip(wanted.len()));
        wanted.extend(["3 Passed", "5 Passed"]);
        let merged = merged([killed, worker(&[3, 5])]).unwrap();
        assert_eq!(results(&merged), wanted, "{length} events");
        assert!(merged.runner_death().is_some());
        assert!(!merged.is_green());
    }
}

#[test]
fn the_same_worker_does_not_count_twice() {
    let problems = merged([worker(&[1]), worker(&[2]), worker(&[2])]).unwrap_err();
    let told: Vec<_> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(told, ["`run-2` and `run-3` are the same run"]);
}

#[test]
fn without_episodes_the_same_test_is_a_problem() {
    let without = || {
        let mut run = worker(&[1]);
        run.retain(|event| {
            !matches!(event.kind, EventKind::EpisodeStarted(_) | EventKind::EpisodeFinished { .. })
        });
        (0..).zip(&mut run).for_each(|(seq, event)| event.seq = seq);
        run
    };
    let problems = merged([without(), without()]).unwrap_err();
    let told: Vec<_> = problems.iter().map(ToString::to_string).collect();
    assert_eq!(told, ["test `arm/Move` is in `run-1` and in `run-2`"]);
}
