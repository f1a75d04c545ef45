//! Cases inside a test, known failures and matrix parameters in the API.

use rtf_model::{
    CaseFinished, CaseId, CaseStart, CaseStarted, EventKind, ExpectedFailure, Message, MessageKind,
    Parameter, Source, TestId, TestPlanned, Verdict,
};
use serde_json::{Value, json};

use crate::world::{TEST, World, Writer};

fn start(run: &mut Writer, case: u32, name: &str, parent: Option<u32>) {
    let joint = Parameter { name: "joint".to_owned(), value: case.to_string() };
    let start = CaseStart {
        parent: parent.map(CaseId),
        parameters: vec![joint],
        tags: vec![format!("tag {case}")],
        ..CaseStart::new(CaseId(case), name.to_owned())
    };
    run.emit(EventKind::CaseStarted(Box::new(CaseStarted { test: TEST, start })));
}

fn finish(run: &mut Writer, case: u32, verdict: Verdict) {
    let reason = (!verdict.is_green()).then(|| format!("case {case} is {verdict}"));
    run.emit(EventKind::CaseFinished(CaseFinished {
        test: TEST,
        case: CaseId(case),
        verdict,
        reason,
        decided_by: None,
        duration_us: None,
        carried: false,
        rerun: false,
        episode: None,
    }));
}

fn fail_in(run: &mut Writer, case: u32) {
    let message = Message {
        kind: MessageKind::Failure,
        text: "stuck".to_owned(),
        location: None,
        comparison: None,
        critical: false,
        case: Some(CaseId(case)),
        interval: None,
    };
    run.emit(EventKind::Message { source: Source::Test(TEST), message, test: None });
}

/// `Arm` contains `Home`, which passes, and `Wave`, which runs; `Legs` did not start.
fn running_cases() -> (World, Writer) {
    let (world, mut run) = World::new();
    run.plan("robot", &["first", "second"]);
    run.start(TEST);
    let names = vec!["Arm".to_owned(), "Legs".to_owned()];
    run.emit(EventKind::CasesPlanned { test: TEST, names });
    start(&mut run, 1, "Arm", None);
    start(&mut run, 2, "Home", Some(1));
    finish(&mut run, 2, Verdict::Passed);
    start(&mut run, 3, "Wave", Some(1));
    fail_in(&mut run, 3);
    run.flush();
    (world, run)
}

const CASES: &str = "/api/v1/runs/own/tests/0/attempts/1/cases";

#[test]
fn cases_of_an_attempt_are_listed_while_it_runs() {
    let (world, mut run) = running_cases();
    let wave = json!({"case": 3, "parent": 1, "name": "Wave", "path": "Arm/Wave",
        "parameters": [{"name": "joint", "value": "3"}], "tags": ["tag 3"], "started": 100});
    let seen = world.get(CASES).json();
    assert_eq!(seen["cases"][1]["verdict"], "passed");
    assert_eq!(seen["cases"][1]["duration_us"], 10);
    assert_eq!((&seen["cases"][2], &seen["not_run"]), (&wave, &json!(["Legs"])));
    finish(&mut run, 3, Verdict::Failed);
    finish(&mut run, 1, Verdict::Failed);
    run.flush();
    let failed = world.get(&format!("{CASES}?verdict=failed,crashed")).json();
    let ids: Vec<_> = failed["cases"].as_array().unwrap().iter().map(|c| &c["case"]).collect();
    assert_eq!(ids, [&json!(1), &json!(3)]);
    assert_eq!(failed["cases"][1]["reason"], "case 3 is failed");
    let detail = world.get("/api/v1/runs/own/tests/0").json();
    let counts = &detail["attempts"][0]["cases"];
    assert_eq!((&counts["total"], &counts["not_run"]), (&json!(4), &json!(1)));
    assert_eq!(
        (&counts["verdicts"]["failed"], &counts["verdicts"]["passed"]),
        (&json!(2), &json!(1))
    );
    let said = world.get("/api/v1/runs/own/tests/0/attempts/1/messages").json();
    assert_eq!(said["messages"][0]["message"]["case"], 3);
}

#[test]
fn pages_of_cases_contain_each_case_once() {
    let (world, run) = running_cases();
    run.end();
    let mut ids = Vec::new();
    let mut after = Value::from(0);
    loop {
        let page = world.get(&format!("{CASES}?limit=2&after={after}")).json();
        ids.extend(page["cases"].as_array().unwrap().iter().map(|case| case["case"].clone()));
        let Some(next) = page.get("next") else {
            assert_eq!(page["not_run"], json!(["Legs"]), "only on the last page");
            break;
        };
        assert_eq!(page.get("not_run"), None);
        after = next.clone();
    }
    assert_eq!(ids, [json!(1), json!(2), json!(3)]);
    for (bad, status) in [("?limit=0", 400), ("?verdict=green", 400), ("?after=-1", 400)] {
        assert_eq!(world.get(&format!("{CASES}{bad}")).status, status, "{bad}");
    }
    let missing = "/api/v1/runs/own/tests/0/attempts/2/cases";
    assert_eq!(world.get(missing).status, 404);
    assert_eq!(world.get(&missing.replace("/2/", "/0/")).status, 404);
}

#[test]
fn tests_are_found_by_their_cases() {
    let (world, run) = running_cases();
    run.end();
    let found = |words: &str| world.get(&format!("/api/v1/runs/own/tests?case={words}")).json();
    assert_eq!(found("WAVE%20arm")["tests"][0]["id"], 0);
    assert_eq!(found("wave")["total"], 1);
    assert_eq!(found("wave%20leg")["total"], 0, "all words are in one path");
}

/// Cases are details: a page of 10 000 tests receives only those of the test that it shows.
#[test]
fn events_of_cases_are_sent_with_the_details_of_their_test() {
    let (world, mut run) = running_cases();
    finish(&mut run, 3, Verdict::Failed);
    finish(&mut run, 1, Verdict::Failed);
    run.finish(TEST, Verdict::Failed);
    run.end();
    let count = |details: &str| {
        let path = format!("/api/v1/runs/own/events?from=0&details={details}");
        let text = world.get(&path).text();
        ["cases-planned", "case-started", "case-finished"]
            .map(|kind| text.matches(&format!("\"type\":\"{kind}\"")).count())
    };
    assert_eq!(count("test:0"), [1, 3, 3]);
    assert_eq!(count("test:1"), [0, 0, 0]);
    assert_eq!(count("none"), [0, 0, 0]);
}

/// A run of one test that is marked, with this verdict.
fn marked(expected: ExpectedFailure, verdict: Verdict) -> (Value, Value) {
    let (world, _own) = World::new();
    let parameters = vec![Parameter { name: "speed".to_owned(), value: "slow".to_owned() }];
    let mut run = Writer::new(world.temp.path(), "marked");
    run.plan_tests("robot", &["Move[speed=slow]"], &|plan: &mut TestPlanned| {
        plan.expected = Some(Box::new(expected.clone()));
        plan.parameters.clone_from(&parameters);
    });
    run.start(TestId(0));
    run.finish(TestId(0), verdict);
    run.end();
    let test = world.get("/api/v1/runs/marked/tests/0").json()["test"].clone();
    let green = world.get("/api/v1/runs/marked").json()["green"].clone();
    assert_eq!(test["parameters"], json!([{"name": "speed", "value": "slow"}]));
    assert_eq!(test["green"], green, "the only test decides");
    (test, green)
}

#[test]
fn a_known_failure_is_green_and_an_unexpected_pass_is_red() {
    let known = ExpectedFailure {
        verdicts: vec![Verdict::Failed],
        issue: Some("https://example.org/7".to_owned()),
        ..ExpectedFailure::default()
    };
    let quarantined = ExpectedFailure { quarantined: true, ..known.clone() };
    let expired = ExpectedFailure { expired: true, ..known.clone() };
    for (mark, verdict, significance, is_green) in [
        (&known, Verdict::Failed, json!("expected"), true),
        (&known, Verdict::Passed, json!("unexpected-pass"), false),
        (&known, Verdict::Crashed, Value::Null, false),
        (&quarantined, Verdict::Failed, json!("quarantined"), true),
        (&quarantined, Verdict::Passed, json!("quarantined"), true),
        (&expired, Verdict::Failed, Value::Null, false),
        (&known, Verdict::Skipped, json!("skipped-itself"), true),
    ] {
        let (test, green) = marked(mark.clone(), verdict);
        let got = (test.get("significance").cloned().unwrap_or_default(), green);
        assert_eq!(got, (significance, json!(is_green)), "{verdict} {mark:?}");
        assert_eq!(test["expected"]["issue"], "https://example.org/7");
    }
}
