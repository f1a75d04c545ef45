//! Access control.

use crate::client::{ask, get};
use crate::world::{STARTED, World, Writer, settings};
use rtf_model::{AnswerChannel, EventKind, Question, QuestionAsked, QuestionClosed, Respondent};
use rtf_web::{BoundServer, ServeError};

const STOP: &str = "/api/v1/runs/own/stop";

fn running() -> (World, Writer) {
    let (world, mut run) = World::new();
    run.plan("arm", &["first"]);
    run.start(crate::world::TEST);
    run.flush();
    (world, run)
}

/// The cookie of a session, as a browser would send it.
fn session(world: &World) -> String {
    let body = format!("{{\"token\":\"{}\"}}", world.token());
    let answer = world.post("/api/v1/session", &["Content-Type: application/json"], &body);
    assert_eq!(answer.status, 204);
    let cookie = answer.header("set-cookie").unwrap();
    assert!(cookie.contains("; HttpOnly; SameSite=Strict; Path=/"), "{cookie}");
    assert!(!cookie.contains(&world.token()), "the token itself stays out of the browser");
    format!("Cookie: other=1; {}", cookie.split(';').next().unwrap())
}

#[test]
fn control_needs_the_token() {
    let (world, _run) = running();
    let bearer = format!("Authorization: Bearer {}", world.token());
    for lines in [&[][..], &["Authorization: Bearer guess"], &["Cookie: rtf=1"]] {
        assert_eq!(world.post(STOP, lines, "").status, 401, "{lines:?}");
    }
    let wrong =
        world.post("/api/v1/session", &["Content-Type: application/json"], "{\"token\":\"x\"}");
    assert_eq!((wrong.status, wrong.header("set-cookie")), (401, None));
    assert!(world.asked().is_empty());
    assert_eq!(world.post(STOP, &[&bearer], "").status, 202);
    assert_eq!(world.post("/api/v1/runs/own/tests/0/stop", &[&bearer], "").status, 202);
    assert_eq!(world.post("/api/v1/runs/own/suites/0/skip", &[&bearer], "").status, 202);
    assert_eq!(world.asked(), ["stop", "stop test 0", "skip suite 0"]);
    assert_eq!(world.post("/api/v1/runs/own/tests/7/stop", &[&bearer], "").status, 404);
}

/// A test that asks, with the number of its question in the journal.
fn asking() -> (World, Writer) {
    let (world, mut run) = running();
    let question = Question {
        question: 3,
        text: "Is it <b>closed</b>?".to_owned(),
        choices: vec!["yes".to_owned(), "no".to_owned()],
        default: Some("no".to_owned()),
        timeout_ms: 60_000,
        picture: Some("attachments/0/1/1-hand.png".to_owned()),
        ..Question::default()
    };
    let asked = QuestionAsked { test: crate::world::TEST, question };
    run.emit(EventKind::QuestionAsked(Box::new(asked)));
    run.flush();
    (world, run)
}

const ANSWER: &str = "/api/v1/runs/own/tests/0/questions/3/answer";

#[test]
fn a_question_is_answered_with_the_token_only() {
    let (world, mut run) = asking();
    let (json, body) = ("Content-Type: application/json", "{\"answer\":\"yes\"}");
    let bearer = format!("Authorization: Bearer {}", world.token());
    let (cookie, own) = (session(&world), format!("Origin: http://{}", world.address()));
    for lines in [&[json][..], &[json, "Authorization: Bearer guess"], &[json, "Cookie: rtf=1"]] {
        assert_eq!(world.post(ANSWER, lines, body).status, 401, "{lines:?}");
    }
    assert_eq!(world.post(ANSWER, &[json, &cookie], body).status, 403, "a cookie alone");
    assert_eq!(
        world.post(ANSWER, &[json, &cookie, "Origin: http://evil.example"], body).status,
        403
    );
    for wrong in ["{}", "{\"answer\":\"maybe\"}", "{\"answer\":\"yes\\n\"}", "{\"answer\":7}", "x"]
    {
        assert_eq!(world.post(ANSWER, &[json, &bearer], wrong).status, 400, "{wrong}");
    }
    let elsewhere = |path: &str| world.post(path, &[json, &bearer], body).status;
    assert_eq!(elsewhere("/api/v1/runs/own/tests/0/questions/4/answer"), 409);
    assert_eq!(elsewhere("/api/v1/runs/own/tests/7/questions/3/answer"), 404);
    assert!(world.asked().is_empty());
    assert_eq!(world.post(ANSWER, &[json, &bearer], body).status, 202);
    assert_eq!(world.post(ANSWER, &[json, &cookie, &own], body).status, 202);
    let answer = "answer yes to question 3 of test 0 by 127.0.0.1";
    let expected = [format!("{answer}, over the API"), format!("{answer}, on the page")];
    assert_eq!(world.asked(), expected);
    let (answer, reason) = (Some("yes".to_owned()), None);
    let test = crate::world::TEST;
    let closed = QuestionClosed { test, question: 3, answer, by: None, reason };
    run.emit(EventKind::QuestionClosed(closed));
    run.flush();
    assert_eq!(elsewhere(ANSWER), 409, "it was answered");
}

#[test]
fn a_question_is_in_the_snapshot_while_it_waits_and_in_the_details_later() {
    let (world, mut run) = asking();
    let snapshot = || get(world.address(), "/api/v1/runs/own/snapshot").json();
    let asked = snapshot()["tests"][0]["questions"][0].clone();
    assert_eq!(asked["question"]["text"], "Is it <b>closed</b>?");
    assert_eq!(asked["url"], "/api/v1/runs/own/files/attachments/0/1/1-hand.png");
    let by = Respondent { via: AnswerChannel::Console, who: Some("alice".to_owned()) };
    let (answer, by) = (Some("yes".to_owned()), Some(by));
    let test = crate::world::TEST;
    let closed = QuestionClosed { test, question: 3, answer, by, reason: None };
    run.emit(EventKind::QuestionClosed(closed));
    run.flush();
    assert!(snapshot()["tests"][0].get("questions").is_none());
    let route = "/api/v1/runs/own/tests/0/attempts/1/questions";
    let details = get(world.address(), route).json();
    let closed = &details["questions"][0]["closed"];
    assert_eq!((&closed["answer"], &closed["by"]["who"]), (&"yes".into(), &"alice".into()));
    assert_eq!(get(world.address(), "/api/v1/runs/own/tests/0/attempts/2/questions").status, 404);
}

#[test]
fn wrong_tokens_are_slowed_down_and_reported() {
    let (world, _run) = running();
    let start = std::time::Instant::now();
    for guess in 0..5 {
        let guess = format!("Authorization: Bearer guess{guess}");
        assert_eq!(world.post(STOP, &[&guess], "").status, 401);
    }
    let body = "{\"token\":\"guess\"}";
    let session = world.post("/api/v1/session", &["Content-Type: application/json"], body);
    assert_eq!(session.status, 401);
    assert!(start.elapsed().as_millis() >= 125 + 250 + 500 + 1000 + 1000, "{:?}", start.elapsed());
    // A cookie of another server at the same port is no guess.
    let cookie = format!("Cookie: rtf-{}=old", world.address().port());
    let _ = ask(world.address(), "GET /api/v1", &[&cookie], "");
    let bearer = format!("Authorization: Bearer {}", world.token());
    assert_eq!(world.post(STOP, &[&bearer], "").status, 202, "the right one is taken");
    assert_eq!(world.wrong_tokens(3), [1, 2, 4]);
    assert_eq!(world.asked(), ["stop"]);
}

#[test]
fn a_browser_controls_from_its_own_page_only() {
    let (world, _run) = running();
    let (cookie, host) = (session(&world), world.address());
    let own = format!("Origin: http://{host}");
    let post = |lines: &[&str]| world.post(STOP, &[&[&*cookie][..], lines].concat(), "").status;
    assert_eq!(post(&[]), 403, "a cookie alone proves nothing");
    for foreign in ["http://evil.example", "null", "https://localhost:1", "http://127.0.0.1"] {
        assert_eq!(post(&[&format!("Origin: {foreign}")]), 403, "{foreign}");
    }
    assert_eq!(post(&[&own, "Sec-Fetch-Site: cross-site"]), 403);
    assert!(world.asked().is_empty());
    assert_eq!(post(&[&own, "Sec-Fetch-Site: same-origin"]), 202);
    let server = ask(host, "GET /api/v1", &[&cookie], "").json();
    assert_eq!((&server["control"], &server["authorised"]), (&true.into(), &true.into()));
}

/// What a form on another site can send without asking first.
#[test]
fn a_form_of_another_site_does_nothing() {
    let (world, _run) = running();
    let (cookie, token) = (session(&world), world.token());
    let own = format!("Origin: http://{}", world.address());
    for kind in ["application/x-www-form-urlencoded", "multipart/form-data", "text/plain"] {
        let kind = format!("Content-Type: {kind}");
        let own = [&*kind, &*cookie, &*own];
        assert_eq!(world.post(STOP, &own, "a=b").status, 415, "{kind}");
        let evil = [&*kind, &*cookie, "Origin: http://evil.example"];
        assert_eq!(world.post(STOP, &evil, "a=b").status, 403, "{kind}");
        let body = format!("{{\"token\":\"{token}\"}}");
        assert_eq!(world.post("/api/v1/session", &[&kind], &body).status, 415, "{kind}");
    }
    let long = format!("{{\"token\":\"{}\"}}", "x".repeat(5000));
    let long = world.post("/api/v1/session", &["Content-Type: application/json"], &long);
    assert_eq!(long.status, 413);
    assert!(world.asked().is_empty());
}

/// A page whose name leads here (DNS rebinding) reads nothing.
#[test]
fn another_host_is_refused_everywhere() {
    let (world, _run) = running();
    let port = world.address().port();
    for path in ["/", "/api/v1", "/api/v1/runs", "/status", "/update", "/api/v1/openapi.json"] {
        let get = |host: &str| {
            ask(world.address(), &format!("GET {path}"), &[&format!("Host: {host}")], "").status
        };
        assert_eq!(get(&format!("localhost:{port}")), 200, "{path}");
        assert_eq!(get(&format!("evil.example:{port}")), 421, "{path}");
        assert_eq!(get("localhost:1"), 421, "{path}");
        assert_eq!(get(""), 421, "{path}");
    }
}

#[test]
fn every_answer_has_its_headers() {
    let (world, _run) = running();
    for path in ["/", "/nothing", "/api/v1", "/api/v1/runs/none", "/api/docs", "/status"] {
        let answer = world.get(path);
        let policy = answer.header("content-security-policy").unwrap_or_default();
        assert!(policy.starts_with("default-src 'self'"), "{path}: {policy}");
        assert!(
            policy.contains("frame-ancestors 'none'") && !policy.contains("script-src"),
            "{path}"
        );
        assert_eq!(answer.header("x-content-type-options"), Some("nosniff"), "{path}");
        assert_eq!(answer.header("referrer-policy"), Some("no-referrer"), "{path}");
        assert_eq!(answer.header("access-control-allow-origin"), None, "{path}");
    }
    assert_eq!(world.get("/api/v1").header("cache-control"), Some("no-store"));
    let wrong = ask(world.address(), "PUT /api/v1/runs", &[], "");
    assert_eq!((wrong.status, wrong.json()["status"].as_u64()), (405, Some(405)));
    let allowed = |path: &str| {
        let wrong = ask(world.address(), &format!("TRACE {path}"), &[], "");
        wrong.header("allow").map(str::to_owned)
    };
    assert_eq!(allowed("/api/v1/runs").as_deref(), Some("GET,HEAD"));
    assert_eq!(allowed("/api/v1/session").as_deref(), Some("POST,DELETE"));
}

#[test]
fn beyond_this_machine_nothing_is_read_without_the_token() {
    let remote = "0.0.0.0:0".parse().unwrap();
    let refused = BoundServer::new(&rtf_web::Settings { address: remote, ..settings() });
    let error = refused.expect_err("it is not allowed");
    assert!(matches!(error, ServeError::Remote(_)) && error.hint().is_some(), "{error}");
}

#[test]
fn a_token_may_come_from_a_file() {
    let temp = tempfile::tempdir().unwrap();
    let path = temp.path().join("token");
    std::fs::write(&path, "my-own-token-of-some-length\n").unwrap();
    let mode = std::os::unix::fs::PermissionsExt::from_mode;
    std::fs::set_permissions(&path, mode(0o640)).unwrap();
    let open = rtf_web::Settings { token_file: Some(path.clone()), ..settings() };
    let refused = BoundServer::new(&open).expect_err("others can read it");
    assert!(refused.to_string().contains("can be read by other users"), "{refused}");
    assert!(refused.hint().is_some_and(|hint| hint.contains("chmod 600")));
    std::fs::set_permissions(&path, mode(0o600)).unwrap();
    let (world, mut run) = World::with(&rtf_web::Settings { token_file: Some(path), ..settings() });
    run.plan("arm", &["first"]);
    run.flush();
    let bearer = "Authorization: Bearer my-own-token-of-some-length";
    assert_eq!(world.post(STOP, &[bearer], "").status, 202);
    assert_eq!(world.asked(), ["stop"]);
}

#[test]
fn a_run_of_others_and_one_that_is_over_are_not_controlled() {
    let (world, run) = running();
    let bearer = format!("Authorization: Bearer {}", world.token());
    let mut other = Writer::new(world.temp.path(), "other");
    other.plan("arm", &["first"]);
    other.flush();
    assert_eq!(world.post("/api/v1/runs/other/stop", &[&bearer], "").status, 409);
    run.end();
    assert_eq!(world.post(STOP, &[&bearer], "").status, 409);
    assert!(world.asked().is_empty());
    assert_eq!(get(world.address(), "/api/v1/runs/other").status, 200);
}

#[test]
fn failed_tests_are_run_again_by_a_server_that_makes_no_run() {
    const AGAIN: &str = "/api/v1/runs/own/rerun";
    let (world, mut run) = World::showing();
    run.plan("arm", &["first"]);
    run.flush();
    let bearer = format!("Authorization: Bearer {}", world.token());
    let post = |path: &str| world.post(path, &[&bearer], "");
    assert_eq!(world.post(AGAIN, &[], "").status, 401);
    assert_eq!(post(AGAIN).status, 409, "it goes on");
    assert!(world.asked().is_empty());
    run.end();
    let mut other = Writer::new(world.temp.path(), "other");
    other.plan("arm", &["first"]);
    other.flush();
    let answer = post(AGAIN);
    assert_eq!((answer.status, world.asked().len()), (409, 0));
    assert_eq!(answer.json()["detail"], "the run `other` goes on");
    other.end();
    let answer = post("/api/v1/runs/other/rerun");
    assert_eq!(answer.status, 409);
    let problem = answer.json();
    assert_eq!(
        (&problem["detail"], &problem["hint"]),
        (&"nothing failed".into(), &"so what".into())
    );
    assert_eq!(post(STOP).status, 409, "it was not started here");
    let answer = post(AGAIN);
    assert_eq!((answer.status, &answer.json()["run"]), (202, &STARTED.into()));
    assert_eq!(world.asked(), ["rerun other in /robot", "rerun own in /robot"]);
    let server = world.get("/api/v1").json();
    assert_eq!((&server["controlled"], &server["rerun"]), (&STARTED.into(), &true.into()));
    Writer::new(world.temp.path(), STARTED).plan("arm", &["first"]);
    assert_eq!(post("/api/v1/runs/anew/tests/0/stop").status, 409, "the whole run or nothing");
    assert_eq!(post("/api/v1/runs/anew/stop").status, 202);
    assert_eq!(world.asked().last().map(String::as_str), Some("stop what was started"));
}

#[test]
fn a_server_that_makes_a_run_starts_no_other() {
    let (world, run) = running();
    run.end();
    let bearer = format!("Authorization: Bearer {}", world.token());
    let answer = world.post("/api/v1/runs/own/rerun", &[&bearer], "");
    assert_eq!(answer.status, 409);
    assert_eq!(answer.json()["hint"], "`rtf serve` runs failed tests again");
    assert!(world.asked().is_empty());
}
