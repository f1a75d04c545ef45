//! An episode that is a case of a test with slots: what was reported in it, and only that.

use rtf_model::{
    Attachment, CaseEpisode, CaseFinished, CaseId, CaseStart, CaseStarted, EpisodeEnd, EventKind,
    Measurement, Message, MessageKind, Parameter, Samples, Source, Verdict,
};
use rtf_web::{EpisodeAttempt, EpisodeRun};
use serde_json::{Value, json};

use crate::world::{TEST, World, Writer};

/// More than a record keeps.
const EARLIER: u32 = 260;
/// Two episodes that are open at the same time, and one after them.
const FIRST: u32 = 261;
const SECOND: u32 = 262;
const THIRD: u32 = 264;
/// A case in the first one.
const INNER: u32 = 263;

fn start(run: &mut Writer, case: u32, parent: Option<u32>) {
    let payload = Parameter { name: "payload".to_owned(), value: case.to_string() };
    let name = parent.map_or_else(|| case.to_string(), |_| "Lift".to_owned());
    let start = CaseStart {
        parent: parent.map(CaseId),
        parameters: vec![payload],
        episode: parent.is_none().then_some(CaseEpisode { id: u64::from(case), seed: case * 10 }),
        ..CaseStart::new(CaseId(case), name)
    };
    run.emit(EventKind::CaseStarted(Box::new(CaseStarted { test: TEST, start })));
}

fn finish(run: &mut Writer, case: u32, verdict: Verdict, episode: Option<EpisodeEnd>) {
    run.emit(EventKind::CaseFinished(CaseFinished {
        test: TEST,
        case: CaseId(case),
        verdict,
        reason: (!verdict.is_green()).then(|| format!("{case} is {verdict}")),
        decided_by: None,
        duration_us: None,
        carried: false,
        rerun: false,
        episode: episode.map(Box::new),
    }));
}

/// Reports a message, a measurement, two samples and a file in a case.
fn report(run: &mut Writer, case: Option<u32>) {
    let name = case.map_or_else(|| "the test".to_owned(), |case| case.to_string());
    let (value, case) = (case.map(f64::from), case.map(CaseId));
    let message = Message {
        kind: MessageKind::Failure,
        text: name.clone(),
        location: None,
        comparison: None,
        critical: false,
        case,
        interval: None,
    };
    run.emit(EventKind::Message { source: Source::Test(TEST), message, test: None });
    let measurement =
        Measurement { name: "error".to_owned(), value, case, ..Measurement::default() };
    run.emit(EventKind::Measured { test: TEST, fixture: None, measurement });
    let samples = Samples {
        name: "elbow".to_owned(),
        unit: "rad".to_owned(),
        low: None,
        high: None,
        location: None,
        points: vec![(0.0, value), (1.0, value)],
        case,
        since: None,
    };
    run.emit(EventKind::Sampled { test: TEST, samples });
    let path = format!("attachments/{name}.png");
    let media_type = "image/png".to_owned();
    let attachment = Attachment { name, path, media_type, case, picture: None, omitted: false };
    run.emit(EventKind::Attached { test: TEST, fixture: None, attachment });
}

/// Many episodes, then two that are interleaved, of which one fails in an inner case; a third one
/// runs.
fn interleaved() -> (World, Writer) {
    let (world, mut run) = World::new();
    run.plan("reach", &["Reach"]);
    run.start(TEST);
    for case in 1..=EARLIER {
        start(&mut run, case, None);
        finish(&mut run, case, Verdict::Passed, None);
    }
    start(&mut run, FIRST, None);
    report(&mut run, Some(FIRST));
    start(&mut run, SECOND, None);
    report(&mut run, None);
    report(&mut run, Some(SECOND));
    start(&mut run, INNER, Some(FIRST));
    report(&mut run, Some(INNER));
    report(&mut run, Some(SECOND));
    finish(&mut run, INNER, Verdict::Failed, None);
    let end = EpisodeEnd {
        steps: Some(200),
        time_us: Some(4_000_000),
        first_observation: Some("1f3a".to_owned()),
    };
    finish(&mut run, FIRST, Verdict::Failed, Some(end));
    finish(&mut run, SECOND, Verdict::Passed, None);
    start(&mut run, THIRD, None);
    run.flush();
    (world, run)
}

const ATTEMPT: &str = "/api/v1/runs/own/tests/0/attempts/1";

/// The values of a field of the entries of a list.
fn fields(list: &Value, pointer: &str) -> Vec<Value> {
    let entries = list.as_array().unwrap();
    entries.iter().map(|entry| entry.pointer(pointer).cloned().unwrap_or_default()).collect()
}

#[test]
fn an_episode_has_only_what_was_reported_in_it() {
    let (world, _run) = interleaved();
    let get = |list: &str, case: u32| world.get(&format!("{ATTEMPT}/{list}?case={case}")).json();
    for (case, wanted) in [
        (FIRST, vec![FIRST, INNER]),
        (INNER, vec![INNER]),
        (SECOND, vec![SECOND, SECOND]),
        (THIRD, vec![]),
    ] {
        let texts: Vec<_> = wanted.iter().map(|case| json!(case.to_string())).collect();
        let values: Vec<_> = wanted.iter().map(|case| json!(f64::from(*case))).collect();
        let messages = get("messages", case);
        assert_eq!(fields(&messages["messages"], "/message/text"), texts, "{case}");
        let measurements = get("measurements", case);
        assert_eq!(fields(&measurements["measurements"], "/measurement/value"), values, "{case}");
        let attachments = get("attachments", case);
        assert_eq!(fields(&attachments["attachments"], "/attachment/name"), texts, "{case}");
        let series = get("series", case);
        let twice: Vec<_> =
            values.iter().flat_map(|value| [value.clone(), value.clone()]).collect();
        let found = series.pointer("/series/0/values").cloned().unwrap_or_else(|| json!([]));
        assert_eq!(found, json!(twice), "{case}");
    }
    // Without `case`, as before.
    let all = world.get(&format!("{ATTEMPT}/messages")).json();
    assert_eq!(all["messages"].as_array().unwrap().len(), 5);
}

#[test]
fn an_episode_that_the_record_does_not_keep_is_read_from_the_journal() {
    let (world, run) = interleaved();
    let kept = world.get(&format!("{ATTEMPT}/cases?limit=1000")).json();
    let ids = fields(&kept["cases"], "/case");
    assert!(!ids.contains(&json!(FIRST)) && ids.contains(&json!(1)), "{ids:?}");
    assert_eq!(kept["cases"][0]["episode"], json!({"id": 1, "seed": 10}));

    let first = world.get(&format!("{ATTEMPT}/cases?case={FIRST}")).json();
    assert_eq!(fields(&first["cases"], "/path"), [json!("261"), json!("261/Lift")]);
    let case = &first["cases"][0];
    assert_eq!((&case["verdict"], &case["reason"]), (&json!("failed"), &json!("261 is failed")));
    assert_eq!(case["parameters"], json!([{"name": "payload", "value": "261"}]));
    assert_eq!(
        case["episode"],
        json!({"id": 261, "seed": 2610, "steps": 200, "time_us": 4_000_000,
            "first_observation": "1f3a"})
    );
    assert_eq!(first["cases"][1].get("episode"), None);
    assert_eq!((first.get("omitted"), first.get("not_run")), (None, None));
    let inner = world.get(&format!("{ATTEMPT}/cases?case={INNER}")).json();
    assert_eq!(fields(&inner["cases"], "/path"), [json!("261/Lift")], "after its parent");
    let third = world.get(&format!("{ATTEMPT}/cases?case={THIRD}")).json();
    assert_eq!(third["cases"][0].get("verdict"), None, "it runs");
    run.end();
}

#[test]
fn pages_of_an_episode_contain_each_entry_once() {
    let (world, _run) = interleaved();
    for (list, number) in [("messages", "seq"), ("cases", "case")] {
        let page = world.get(&format!("{ATTEMPT}/{list}?case={FIRST}&limit=1")).json();
        let next = &page["next"];
        assert_eq!(page[list][0][number], *next, "{list}");
        let last = world.get(&format!("{ATTEMPT}/{list}?case={FIRST}&after={next}")).json();
        assert_eq!(last[list].as_array().unwrap().len(), 1, "{list}: the inner case");
        assert_eq!(last.get("next"), None, "{list}");
    }
    let failed = world.get(&format!("{ATTEMPT}/cases?case={FIRST}&verdict=passed")).json();
    assert_eq!(failed["cases"], json!([]));
    for list in ["messages", "measurements", "series", "attachments", "cases"] {
        for (case, status) in [("9999", 404), ("0", 404), ("-1", 400), ("x", 400)] {
            let answer = world.get(&format!("{ATTEMPT}/{list}?case={case}"));
            assert_eq!(answer.status, status, "{list} {case}");
            assert!(answer.json()["detail"].is_string(), "{list} {case}");
        }
        let other = ATTEMPT.replace("attempts/1", "attempts/2");
        assert_eq!(world.get(&format!("{other}/{list}?case={FIRST}")).status, 404, "{list}");
    }
}

/// Of a case that its framework runs again, the last attempt counts.
#[test]
fn a_case_in_one_that_was_run_again_is_superseded() {
    let (world, mut run) = World::new();
    run.plan("arm", &["Arm"]);
    run.start(TEST);
    start(&mut run, 1, None);
    start(&mut run, 2, Some(1));
    finish(&mut run, 2, Verdict::Failed, None);
    let reruns = |case| CaseFinished {
        test: TEST,
        case: CaseId(case),
        verdict: Verdict::Failed,
        reason: None,
        decided_by: None,
        duration_us: None,
        carried: false,
        rerun: true,
        episode: None,
    };
    run.emit(EventKind::CaseFinished(reruns(1)));
    run.flush();
    let inner = world.get(&format!("{ATTEMPT}/cases?case=2")).json();
    assert_eq!(inner["cases"][0]["superseded"], true);
}

/// The fields of the attempt are those of the run itself.
#[test]
fn the_run_of_an_episode_names_its_case() {
    let run = |attempt| EpisodeRun { run: "2026".to_owned(), test: Some(0), attempt };
    let json_of = |attempt| serde_json::to_value(run(attempt)).unwrap();
    let batched = EpisodeAttempt { attempt: 1, case: Some(17) };
    let whole = EpisodeAttempt { case: None, ..batched };
    let wanted = json!({"run": "2026", "test": 0, "attempt": 1, "case": 17});
    assert_eq!(json_of(Some(batched)), wanted);
    assert_eq!(json_of(Some(whole)), json!({"run": "2026", "test": 0, "attempt": 1}));
    assert_eq!(json_of(None), json!({"run": "2026", "test": 0}));
}
