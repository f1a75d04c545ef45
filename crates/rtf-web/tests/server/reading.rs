//! What is read of runs: the list, the snapshot, pages of details, and that
//! nothing that a test says can be more than text.

use rtf_model::{MessageKind, TestId, Verdict};
use serde_json::{Value, json};

use crate::client::ask;
use crate::world::{TEST, World, Writer};

/// Text that needs escaping.
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
    let detail = world.get("/api/v1/runs/current/tests/1").json();
    assert_eq!(detail["command"], "rtf run suite.xml::1", "how it is run again");
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
fn a_query_that_makes_no_sense_is_a_bad_request() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.flush();
    let attempt = "/api/v1/runs/own/tests/0/attempts/1";
    for query in [
        "/api/v1/runs/own/tests?verdict=green",
        "/api/v1/runs/own/tests?verdict=",
        "/api/v1/runs/own/tests?verdict=passed,nonsense",
        "/api/v1/runs/own/tests?state=gone",
        "/api/v1/runs/own/tests?suite=4294967296",
        "/api/v1/runs/own/tests?suite=-1",
        "/api/v1/runs/own/tests?after=9223372036854775808",
        &format!("{attempt}/messages?kind=nonsense"),
        &format!("{attempt}/messages?after=9007199254740992"),
        &format!("{attempt}/output?after=18446744073709551616"),
        "/api/v1/runs/own/events?from=9007199254740992",
        "/api/v1/runs/own/events?details=",
        "/api/v1/runs/own/events?details=test:",
        "/api/v1/runs/own/events?details=test:-1",
        "/api/v1/runs/own/events?details=test:1,,",
    ] {
        let answer = world.get(query);
        assert_eq!(answer.status, 400, "{query}");
        assert!(answer.json()["detail"].is_string(), "{query}: {}", answer.text());
    }
    for last in ["x", "-1", "9007199254740992", ""] {
        let line = format!("Last-Event-ID: {last}");
        let answer = ask(world.address(), "GET /api/v1/runs/own/events", &[&line], "");
        assert_eq!(answer.status, 400, "{last}");
    }
    let bad = world.get("/api/v1/runs/own/tests?verdict=passed,green").json();
    let detail = bad["detail"].as_str().unwrap();
    assert!(detail.starts_with("`verdict` has `green`, expected some of `passed`, "), "{detail}");
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
    let path = "/api/v1/runs/own/tests/0/attempts/1/series";
    let part = world.get(&format!("{path}?from=0.4&to=0.6")).json();
    let part = &part["series"][0];
    assert_eq!((&part["times"], &part["count"]), (&json!([0.5]), &json!(3)));
    for bad in ["from=x", "from=NaN", "to=inf"] {
        assert_eq!(world.get(&format!("{path}?{bad}")).status, 400, "{bad}");
    }
    let none = world.get("/api/v1/runs/own/tests/0/attempts/2/series");
    assert_eq!(none.json()["status"], 404);
}

/// The curve of a million samples has a thousand points; that of a part has them all.
#[test]
fn a_part_of_a_long_signal_comes_in_full_resolution() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    let values: Vec<f64> = (0..20_000).map(|n| f64::from(n % 7)).collect();
    run.sample(0.0, &values);
    run.flush();
    let path = "/api/v1/runs/own/tests/0/attempts/1/series";
    let whole = world.get(path).json();
    assert!(whole["series"][0]["times"].as_array().unwrap().len() <= 1024);
    let part = world.get(&format!("{path}?from=1000&to=1100")).json();
    let times = part["series"][0]["times"].as_array().unwrap();
    assert_eq!((times.len(), &times[0]), (201, &json!(1000.0)));
    assert_eq!(part["series"][0]["count"], 20_000);
}

#[test]
fn values_near_the_end_of_their_range_have_a_mean() {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(TEST);
    run.sample(0.0, &[1e308, -1e308, 1e308, -1e308]);
    run.flush();
    let seen = world.get("/api/v1/runs/own/tests/0/attempts/1/series").json();
    let signal = &seen["series"][0];
    let mean = signal["mean"].as_f64().expect("a number");
    assert!(mean.abs() < 1e300, "{signal}");
    assert_eq!((&signal["min"], &signal["max"]), (&json!(-1e308), &json!(1e308)));
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
    ] {
        let answer = world.get(&path);
        assert_eq!(answer.header("content-type"), Some("application/json"), "{path}");
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"));
        assert_eq!(answer.json().pointer(pointer), Some(&json!(HOSTILE)), "{path}");
    }
    let output = world.get(&format!("{test}/attempts/1/output")).json();
    assert_eq!(output["output"][1]["text"].as_str().map(str::len), Some(long.len()));
    let status = world.get("/status");
    assert_eq!(status.json(), json!({"name": HOSTILE, "testStatus": [2]}));
    let update = world.get("/update");
    for answer in [&status, &update] {
        assert_eq!(answer.header("content-type"), Some("text/turtle"), "as in 2.x");
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"));
        // The last character belonged to the end of its line.
        assert_eq!(answer.text().match_indices("\r\n").count(), 1);
        assert!(answer.text().ends_with("\r\n"));
    }
    let html = update.text();
    assert!(!html.contains("<script") && html.starts_with("<br> <font"), "{html}");
}

/// `/update` was a string in JSON, with quotation marks that an old page showed.
#[test]
fn the_clients_of_the_predecessor_get_its_html() {
    let (world, mut run) = World::new();
    run.plan("arm", &["only"]);
    run.start(TEST);
    run.say(MessageKind::Report, "moving");
    run.say(MessageKind::Check, "closed");
    run.say(MessageKind::Failure, "too fast");
    run.say(MessageKind::Error, "no bus");
    run.finish(TEST, Verdict::Failed);
    run.flush();
    let html = world.get("/update").text().replace("</b></font>", "");
    let lines: Vec<_> = html.trim_end().split("<br> <font color=").skip(1).collect();
    let wanted = [
        "\"blue\"><b> Starting test runner. ",
        "\"blue\"><b> Test suite arm started... ",
        "\"blue\"><b> Test case only started... ",
        "\"green\"><b>[INFO]&nbsp;&nbsp; (only) reports : moving.",
        "\"green\"><b>[INFO]&nbsp;&nbsp; (only) checks : closed.",
        "\"red\"><b>[FAIL]&nbsp;&nbsp; (only) checks : too fast.",
        "\"red\"><b>[ERROR]&nbsp; (only) no bus.",
        "\"blue\"><b> Test case only failed!",
    ];
    assert_eq!(lines, wanted, "{html}");
}

#[test]
fn runs_are_found_by_what_they_were() {
    let (world, mut run) = World::new();
    run.plan("arm", &["only"]);
    run.flush();
    for (name, suite, branch, robot, verdict) in [
        ("2026-01-01", "walk", "main", "red", Verdict::Passed),
        ("2026-01-02", "walk", "main", "blue", Verdict::Failed),
        ("2026-01-03", "grasp", "new/hand", "red", Verdict::Passed),
    ] {
        let mut past = Writer::new(world.temp.path(), name);
        past.plan_of(suite, &["only"], &|started| {
            let commit = format!("{name:0<40}").replace('-', "a");
            let revision = rtf_model::Revision {
                commit,
                branch: Some(branch.to_owned()),
                ..rtf_model::Revision::default()
            };
            started.started_at = format!("{name}T06:30:12+01:00");
            started.manifest.revision = Some(revision);
            started.manifest.profile = Some(format!("{branch} profile"));
            started.manifest.set = vec![format!("robot={robot}"), "speed=3".to_owned()];
        });
        past.start(TEST);
        past.finish(TEST, verdict);
        past.end();
    }
    let found = |query: &str| {
        let page = world.get(&format!("/api/v1/runs?{query}")).json();
        let runs = page["runs"].as_array().unwrap_or_else(|| panic!("{query}: {page}"));
        let days = runs.iter().map(|run| run["run"].as_str().unwrap().replace("2026-01-0", ""));
        days.collect::<Vec<_>>().join(" ")
    };
    for (query, wanted) in [
        ("", "own 3 2 1"),
        ("result=running", "own"),
        ("result=green", "3 1"),
        ("result=red", "2"),
        ("result=damaged", ""),
        ("suite=walk", "2 1"),
        ("branch=new%2Fhand", "3"),
        ("commit=2026A01a02", "2"),
        ("robot=red", "3 1"),
        ("profile=main%20profile", "2 1"),
        ("since=2026-01-02&until=2026-01-03", "3 2"),
        ("q=MAIN%20blue", "2"),
        ("q=main&result=green&robot=red", "1"),
        ("suite=walk&limit=1", "2"),
        ("suite=nothing", ""),
    ] {
        assert_eq!(found(query), wanted, "{query}");
    }
    let page = world.get("/api/v1/runs?suite=walk&limit=1").json();
    assert_eq!(page["next"], "2026-01-02", "the next page begins after what was found");
    let info = &page["runs"][0];
    assert_eq!(
        (&info["suite_names"], &info["robots"], &info["revision"]["branch"]),
        (&json!(["walk"]), &json!(["blue"]), &json!("main"))
    );
    for bad in ["result=good", "commit=xyz", "commit=ab", "since=yesterday", "until=2026-1-1"] {
        assert_eq!(world.get(&format!("/api/v1/runs?{bad}")).status, 400, "{bad}");
    }
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
