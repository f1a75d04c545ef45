//! Failed tests that `rtf serve` reruns for a browser.

use rtf_model::Verdict;
use serde_json::{Value, json};

use crate::support::{Folder, nothing_left, wait_until};
use crate::web::{Web, until_test_runs};
use crate::web_client::{Stream, get};

/// One passes, one fails at once, until the file `patient` is there: then it waits.
const FAILS: &str = "function TestCase.run()
  if io.open('patient') then rtf.sleep(1000) end
  rtf.fail('broken')
end
";
const SUITE: &str = "<suite name='arm'>
  <hook name='park' on='interrupt'><command>touch parked</command></hook>
  <test type='lua'>fine.lua</test>
  <test type='lua' name='fails'>fails.lua</test>
</suite>";

/// A run in which one of two tests failed, and a server over it.
fn failed() -> (Folder, Web) {
    let folder = Folder::new();
    folder.file("fine.lua", "function TestCase.run() end\n").file("fails.lua", FAILS);
    folder.file("arm.xml", SUITE);
    assert_eq!(folder.rtf(&["run", "arm.xml"]).code, Some(1));
    let web = Web::start(&folder, &["serve", "--web=127.0.0.1:0"]);
    (folder, web)
}

/// Asks for it; the name of the new run.
fn rerun(web: &Web, run: &str) -> String {
    let answer = web.post_to(run, "/rerun");
    assert_eq!(answer.status, 202, "{}", answer.text());
    answer.json()["run"].as_str().expect("a name").to_owned()
}

fn events(web: &Web, run: &str) -> Stream {
    Stream::open(web.address, &format!("/api/v1/runs/{run}/events?from=0&details=none"), &[])
}

fn server(web: &Web) -> Value {
    get(web.address, "/api/v1").json()
}

#[test]
fn the_failed_tests_are_run_again_as_a_new_run() {
    let (folder, web) = failed();
    assert_eq!((&server(&web)["mode"], &server(&web)["rerun"]), (&json!("serve"), &json!(true)));
    assert_eq!(web.post_to("latest", "/stop").status, 409, "there is nothing to stop");
    let first = rerun(&web, "latest");
    let rest = events(&web, &first).rest();
    assert_eq!(rest.last().map(|sent| &sent.data), Some(&json!({"state": "finished"})));
    let tests = get(web.address, &format!("/api/v1/runs/{first}/tests")).json();
    assert_eq!((&tests["total"], &tests["tests"][0]["name"]), (&json!(1), &json!("fails")));
    assert_eq!(tests["tests"][0]["verdict"], "failed");
    // Mended, it passes; after that there is nothing to run again.
    folder.file("fails.lua", "function TestCase.run() end\n");
    wait_until("the end of the first", || server(&web)["controlled"].is_null().then_some(()));
    let second = rerun(&web, &first);
    events(&web, &second).rest();
    let info = get(web.address, &format!("/api/v1/runs/{second}")).json();
    assert_eq!(info["green"], true, "{info}");
    wait_until("the end of the second", || server(&web)["controlled"].is_null().then_some(()));
    let nothing = web.post_to(&second, "/rerun");
    assert_eq!(nothing.status, 409);
    let said = format!("no test of `{second}` failed: nothing to rerun");
    assert_eq!(nothing.json()["detail"], said);
    // What the runner says about the suite is passed on, and is no run.
    std::fs::remove_file(folder.path().join("arm.xml")).expect("the suite");
    let gone = web.post_to(&first, "/rerun");
    assert_eq!(gone.status, 409);
    let detail = gone.json()["detail"].to_string();
    assert!(detail.contains("arm.xml"), "{detail}");
    assert_eq!(server(&web)["controlled"], Value::Null);
    assert_eq!(web.end("TERM").code, Some(143));
    assert!(nothing_left(&folder));
}

#[test]
fn one_run_at_a_time_is_started_and_stopped() {
    let (folder, web) = failed();
    let past = folder.journal().record.run.expect("a beginning").run;
    folder.file("patient", "");
    let run = rerun(&web, &past);
    let mut seen = events(&web, &run);
    until_test_runs(&mut seen, 0);
    assert_eq!(server(&web)["controlled"], json!(run));
    assert_eq!(web.post_to(&past, "/rerun").status, 409, "one goes on");
    assert_eq!(web.post_to(&run, "/tests/0/stop").status, 409, "all of it or nothing");
    assert_eq!(web.post_to(&run, "/stop").status, 202);
    let rest = seen.rest();
    assert_eq!(rest.last().map(|sent| &sent.data), Some(&json!({"state": "interrupted"})));
    let record = folder.journal().record;
    assert_eq!(record.interrupted(), Some("SIGINT"));
    assert_eq!(record.totals().of(Verdict::Interrupted), 1);
    assert!(folder.path().join("parked").exists());
    assert_eq!(web.end("INT").code, Some(130));
    assert!(nothing_left(&folder));
}

/// The server's signal is passed on once: the robot is parked before it ends.
#[test]
fn a_server_that_ends_takes_its_run_with_it() {
    for (signal, code) in [("INT", 130), ("TERM", 143), ("HUP", 129)] {
        let (folder, web) = failed();
        folder.file("patient", "");
        let run = rerun(&web, "latest");
        until_test_runs(&mut events(&web, &run), 0);
        let ended = web.end(signal);
        assert_eq!(ended.code, Some(code));
        assert!(nothing_left(&folder), "{signal}");
        assert!(folder.path().join("parked").exists(), "{signal}");
        assert_eq!(folder.journal().record.interrupted(), Some(&*format!("SIG{signal}")));
    }
}

#[test]
fn a_server_that_is_killed_takes_its_run_with_it() {
    let (folder, web) = failed();
    folder.file("patient", "");
    let run = rerun(&web, "latest");
    until_test_runs(&mut events(&web, &run), 0);
    assert_eq!(web.end("KILL").code, None);
    wait_until("the end of the run", || nothing_left(&folder).then_some(()));
    let record = folder.journal().record;
    assert_eq!(record.interrupted(), Some("SIGTERM"));
    assert!(folder.path().join("parked").exists());
}

/// A run that another process makes is not stopped here, and nothing is started beside it.
#[test]
fn what_others_run_is_left_alone() {
    let (folder, web) = failed();
    let past = folder.journal().record.run.expect("a beginning").run;
    folder.file("patient", "");
    let running = folder.start(&["run", "arm.xml"]);
    let current =
        wait_until("the other run", || Some(server(&web)["current"].as_str()?.to_owned()));
    assert_eq!(server(&web)["controlled"], Value::Null);
    assert_eq!(web.post_to(&current, "/stop").status, 409);
    let refused = web.post_to(&past, "/rerun");
    assert_eq!(refused.status, 409);
    assert_eq!(refused.json()["detail"], format!("the run `{current}` goes on"));
    running.signal("INT");
    running.finish();
    web.end("TERM");
    assert!(nothing_left(&folder));
}
