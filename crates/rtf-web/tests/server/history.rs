//! Results over time: the answers of the history, and what is said if there is none.

use rtf_history::Store;
use rtf_model::{Manifest, Origin, Revision, TestId, Verdict};
use serde_json::{Value, json};

use crate::world::{TEST, World, Writer};

const HOSTILE: &str = "<script>alert(1)</script>";

/// Imports a run of the tests `steady` and `<script>…`, of which the latter has this verdict.
pub fn import(world: &World, day: u32, branch: &str, verdict: Verdict, lag: f64) {
    let mut run = Writer::new(world.temp.path(), &format!("run-{day:02}"));
    run.plan_of("arm", &["steady", HOSTILE], &|started| {
        started.started_at = format!("2026-11-{day:02}T06:30:12Z");
        let commit = format!("{:040}", day / 10);
        let revision = Revision {
            commit,
            branch: Some(branch.to_owned()),
            dirty: Some(false),
            ..Revision::default()
        };
        let origin = Origin { id: format!("id-{day}"), host: "bench".into(), ..Origin::default() };
        *started.manifest =
            Manifest { revision: Some(revision), origin: Some(origin), ..Manifest::default() };
    });
    run.start(TEST);
    run.measure(lag, 1.0);
    run.finish(TEST, Verdict::Passed);
    run.start(TestId(1));
    run.finish(TestId(1), verdict);
    let record = run.end();
    let mut store = Store::open(world.temp.path().join("history.db")).unwrap();
    store.import(&record).unwrap();
}

/// Twelve runs: the second test is flaky, and `settling` changes on day 7.
fn world() -> World {
    let (world, _run) = World::new();
    for day in 1..=12 {
        let verdict = if day % 5 == 0 { Verdict::Failed } else { Verdict::Passed };
        let branch = if day > 10 { "arm" } else { "main" };
        let lag = f64::from(day % 2) * 0.01 + if day < 7 { 0.2 } else { 0.6 };
        import(&world, day, branch, verdict, lag);
    }
    world
}

fn get(world: &World, path: &str) -> Value {
    let answer = world.get(&format!("/api/v1/history/{path}"));
    assert_eq!(answer.status, 200, "{path}: {}", answer.text());
    answer.json()
}

#[test]
fn a_matrix_has_a_letter_per_run_and_a_page_of_tests() {
    let world = world();
    let first = get(&world, "matrix?limit=1");
    assert_eq!((&first["total"], &first["next"]), (&json!(2), &json!(1)));
    assert_eq!(first["runs"].as_array().unwrap().len(), 12);
    assert_eq!(first["runs"][0]["name"], "run-01", "the oldest is the first");
    let hostile = json!({"suite": "arm", "test": HOSTILE, "verdicts": "ppppfppppfpp"});
    assert_eq!(first["tests"], json!([hostile]));
    let second = get(&world, "matrix?limit=1&after=1");
    assert_eq!(second["tests"][0]["verdicts"], "pppppppppppp");
    assert_eq!(second.get("next"), None);
    let last = get(&world, "matrix?last=3&filter=steady&branch=");
    assert_eq!((&last["tests"][0]["verdicts"], &last["total"]), (&json!("ppp"), &json!(1)));
    let branch = get(&world, "matrix?branch=arm");
    assert_eq!(branch["runs"].as_array().unwrap().len(), 2);
}

#[test]
fn a_test_and_a_measurement_have_change_points_and_limits() {
    let world = world();
    let found = get(&world, "test?test=arm/steady");
    assert_eq!(found["tests"][0]["results"].as_array().unwrap().len(), 12);
    assert_eq!(found["tests"][0]["series"][0]["points"][0]["high"], 1.0);
    let trend = get(&world, "trend?series=settling");
    assert_eq!(trend["series"][0]["points"].as_array().unwrap().len(), 12);
    let change = &trend["changes"][0];
    assert_eq!(trend["changes"].as_array().unwrap().len(), 1, "{trend}");
    assert_eq!((&change["run"], &change["series"]["name"]), (&json!("id-7"), &json!("settling")));
    assert!(change["after"].as_f64() > change["before"].as_f64(), "{change}");
    let of_other = world.get("/api/v1/history/trend?series=settling&test=arm/none");
    assert_eq!(of_other.status, 404);
}

#[test]
fn flaky_and_slow_tests_and_branches_side_by_side() {
    let world = world();
    let flaky = get(&world, "flaky");
    assert_eq!(flaky["tests"][0]["test"], HOSTILE);
    assert_eq!(flaky["tests"].as_array().unwrap().len(), 1);
    assert_eq!(get(&world, "slow?limit=1")["tests"].as_array().unwrap().len(), 1);
    assert_eq!(get(&world, "runs?last=2")["runs"][0]["name"], "run-12", "the newest is the first");
    let compared = &get(&world, "compare?a=branch:main&b=branch:arm")["comparison"];
    assert_eq!((&compared["runs_a"], &compared["runs_b"]), (&json!(10), &json!(2)));
    assert_eq!(compared["tests"][0]["verdicts_a"], json!({"passed": 8, "failed": 2}));
    let unknown = world.get("/api/v1/history/compare?a=latest&b=branch:leg");
    assert_eq!(
        (unknown.status, &unknown.json()["detail"]),
        (404, &json!("no run of the history matches `branch:leg`"))
    );
}

#[test]
fn a_wrong_question_is_refused() {
    let world = world();
    for query in [
        "matrix?filter=!",
        "matrix?since=soon",
        "matrix?last=0",
        "flaky?limit=1001",
        "runs?cases=2",
    ] {
        let answer = world.get(&format!("/api/v1/history/{query}"));
        assert_eq!(answer.status, 400, "{query}: {}", answer.text());
    }
    assert_eq!(world.get("/api/v1/history/test?test=arm/none").status, 404);
}

#[test]
fn without_a_history_the_answer_says_how_to_get_one() {
    let (world, _run) = World::new();
    let answer = world.get("/api/v1/history/matrix");
    assert_eq!(answer.status, 404);
    let hint = answer.json()["hint"].as_str().unwrap_or_default().to_owned();
    assert!(hint.contains("rtf history import"), "{hint}");
}

#[test]
fn a_history_that_cannot_be_read_is_unavailable_and_unchanged() {
    let world = world();
    let path = world.temp.path().join("history.db");
    std::fs::write(&path, "this is no database, but long enough to be one").unwrap();
    for sibling in ["history.db-wal", "history.db-shm"] {
        drop(std::fs::remove_file(world.temp.path().join(sibling)));
    }
    let answer = world.get("/api/v1/history/flaky");
    assert_eq!(answer.status, 503, "{}", answer.text());
    assert!(answer.json()["detail"].as_str().unwrap_or_default().contains("is damaged"));
    assert!(answer.json()["hint"].is_string());
    let left = std::fs::read_to_string(&path).unwrap();
    assert!(left.starts_with("this is no database"), "{left}");
}
