//! What is read of runs: the list, the snapshot, pages of details, and that
//! nothing that a test says can be more than text.

use rtf_model::{MessageKind, TestId, Verdict};
use serde_json::{Value, json};

use crate::world::{TEST, World, Writer};

/// Text that breaks whoever does not escape.
const HOSTILE: &str = "\"</script><script>alert('\\')</script>\u{0}\u{1b}[31m\r\n\u{202e}🤖&amp;";

#[test]
fn a_run_is_seen_as_it_goes_on() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first", "second"]);
    run.start(TEST);
    run.say(MessageKind::Failure, "stuck");
    run.measure(0.5, 1.0);
    run.measure(2.0, 1.0);
    run.print("four");
    run.flush();
    let seen = world.get("/api/v1/runs/current/snapshot").json();
    let info = &seen["info"];
    assert_eq!(
        (&info["state"], &info["seq"], info.get("green")),
        (&json!("running"), &json!(10), None)
    );
    assert_eq!(info["totals"]["running"], 1);
    let test = &seen["tests"][0];
    assert_eq!((&test["state"], test.get("verdict")), (&json!("running"), None));
    let counts = json!({"messages": 1, "failures": 1, "measurements": 2, "violations": 1,
        "attachments": 0, "output_bytes": 4});
    assert_eq!(test["counts"], counts);
    run.finish(TEST, Verdict::Failed);
    run.start(TestId(1));
    run.finish(TestId(1), Verdict::Passed);
    run.end();
    let info = world.get("/api/v1/runs/own").json();
    assert_eq!((&info["state"], &info["green"]), (&json!("finished"), &json!(false)));
    assert_eq!(info["totals"]["verdicts"]["failed"], 1);
    let tests = world.get("/api/v1/runs/latest/tests?verdict=failed,crashed&q=FIR").json();
    assert_eq!((&tests["total"], &tests["tests"][0]["name"]), (&json!(1), &json!("first")));
}

#[test]
fn a_signal_is_seen_in_numbers_and_as_a_curve() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.sample(0.0, &[0.25, 1.0]);
    run.sample(1.0, &[1.75]);
    run.flush();
    let seen = world.get("/api/v1/runs/own/tests/0/attempts/1/series").json();
    let expected = json!({"series": [{
        "name": "elbow", "unit": "rad", "high": 1.5, "count": 3, "min": 0.25, "mean": 1.0,
        "max": 1.75, "last": 1.75, "outside": 1,
        "problem": "`elbow` is 1.75 rad at 1 s, its limits are ≤ 1.5",
        "times": [0.0, 0.5, 1.0], "values": [0.25, 1.0, 1.75],
    }]});
    assert_eq!(seen, expected);
    let none = world.get("/api/v1/runs/own/tests/0/attempts/2/series");
    assert_eq!(none.json()["status"], 404);
}

#[test]
fn details_come_page_by_page_and_go_on_while_the_test_runs() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    for number in 0..25 {
        run.say(MessageKind::Report, &format!("message {number}"));
        run.print("noise\n");
    }
    run.flush();
    let path = "/api/v1/runs/own/tests/0/attempts/1/messages";
    let (mut after, mut texts) = (String::new(), Vec::new());
    loop {
        let page = world.get(&format!("{path}?limit=10{after}")).json();
        let messages = page["messages"].as_array().unwrap();
        texts.extend(messages.iter().map(|said| said["message"]["text"].clone()));
        let Some(next) = page.get("next") else { break };
        after = format!("&after={next}");
    }
    let wanted: Vec<_> = (0..25).map(|number| json!(format!("message {number}"))).collect();
    assert_eq!(texts, wanted);
    run.say(MessageKind::Failure, "late");
    run.flush();
    let late = world.get(&format!("{path}?kind=failure,error")).json();
    assert_eq!(late["messages"][0]["message"]["text"], "late");
    for (bad, status) in [("?limit=0", 400), ("?limit=x", 400), ("?limit=1001", 400)] {
        assert_eq!(world.get(&format!("{path}{bad}")).status, status, "{bad}");
    }
    assert_eq!(world.get("/api/v1/runs/own/tests/0/attempts/2/messages").status, 404);
    assert_eq!(world.get("/api/v1/runs/own/tests/9").status, 404);
}

#[test]
fn whatever_a_test_says_it_stays_text() {
    let (world, mut run) = World::new();
    run.plan(HOSTILE, &[HOSTILE]);
    run.start(TEST);
    let long = "x".repeat(1 << 20);
    run.say(MessageKind::Error, HOSTILE);
    run.print(HOSTILE);
    run.print(&long);
    run.finish(TEST, Verdict::Error);
    run.flush();
    let test = "/api/v1/runs/own/tests/0";
    for (path, pointer) in [
        ("/api/v1/runs/own/suites".to_owned(), "/suites/0/name"),
        (test.to_owned(), "/test/name"),
        (format!("{test}/attempts/1/messages"), "/messages/0/message/text"),
        (format!("{test}/attempts/1/output"), "/output/0/text"),
        ("/status".to_owned(), "/name"),
    ] {
        let answer = world.get(&path);
        assert_eq!(answer.header("content-type"), Some("application/json"), "{path}");
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"));
        assert_eq!(answer.json().pointer(pointer), Some(&json!(HOSTILE)), "{path}");
    }
    let output = world.get(&format!("{test}/attempts/1/output")).json();
    assert_eq!(output["output"][1]["text"].as_str().map(str::len), Some(long.len()));
    assert_eq!(world.get("/status").json()["testStatus"], json!([2]));
    let update = world.get("/update");
    let Value::String(html) = update.json() else { panic!("a string") };
    assert_eq!(update.text(), format!("\"{html}\""), "the same for those who take it as HTML");
    assert!(html.contains("[ERROR]") && !html.contains("<script"), "{html}");
}

#[test]
fn past_runs_are_listed_the_newest_first_and_a_broken_one_is_told() {
    let (world, mut run) = World::new();
    for name in ["2026-01-01", "2026-01-02", "2026-01-03"] {
        let mut past = Writer::new(world.temp.path(), name);
        past.plan("arm", &["only"]);
        past.start(TEST);
        past.finish(TEST, Verdict::Passed);
        past.end();
    }
    // Its runner is gone, and there is no end.
    Writer::new(world.temp.path(), "2026-01-04").plan("arm", &["only"]);
    run.plan("arm", &["only"]);
    run.flush();
    std::fs::create_dir(world.temp.path().join("no-run")).unwrap();
    let page = world.get("/api/v1/runs?limit=3").json();
    let states = |page: &Value| -> Vec<(String, String)> {
        let runs = page["runs"].as_array().unwrap().iter();
        let text = |value: &Value| value.as_str().unwrap().to_owned();
        runs.map(|run| (text(&run["run"]), text(&run["state"]))).collect()
    };
    let named = |pairs: &[(&str, &str)]| -> Vec<_> {
        pairs.iter().map(|(name, state)| ((*name).to_owned(), (*state).to_owned())).collect()
    };
    let wanted = [("own", "running"), ("2026-01-04", "incomplete"), ("2026-01-03", "finished")];
    assert_eq!(states(&page), named(&wanted));
    let rest = world.get(&format!("/api/v1/runs?before={}", page["next"].as_str().unwrap())).json();
    assert_eq!(states(&rest), named(&[("2026-01-02", "finished"), ("2026-01-01", "finished")]));
    assert_eq!((rest.get("next"), &rest["runs"][0]["green"]), (None, &json!(true)));
    for nowhere in ["no-run", "..", "%2e%2e", "own%2f..%2fown", ".hidden", "nothing"] {
        assert_eq!(world.get(&format!("/api/v1/runs/{nowhere}")).status, 404, "{nowhere}");
    }
}
