//! Browsers and other clients cannot exhaust the resources of a run.

use std::net::TcpStream;
use std::process::Command;

use rtf_model::Verdict;

use crate::support::{Folder, nothing_left};
use crate::web::Web;
use crate::web_client::get;

/// More connections than the process may have open files.
const CONNECTIONS: usize = 400;

/// `rtf` that may have this many open files.
fn with_open_files(folder: &Folder, limit: u32, args: &[&str]) -> Command {
    let rtf = folder.command(args);
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -n {limit}; exec \"$0\" \"$@\"")]);
    command.arg(rtf.get_program()).args(rtf.get_args()).current_dir(folder.path());
    for (name, value) in rtf.get_envs() {
        match value {
            Some(value) => command.env(name, value),
            None => command.env_remove(name),
        };
    }
    command.stdin(std::process::Stdio::null());
    command
}

#[test]
fn idle_connections_keep_no_hook_from_running() {
    let folder = Folder::new();
    folder.file("wait.lua", "function TestCase.run() rtf.sleep(1000) end\n");
    folder.file(
        "suite.xml",
        "<suite name='arm'>
           <fixture type='process' name='robot'>
             <command>sh -c 'echo $$ > pid; echo up; exec sleep 1000'</command><ready log='up'/></fixture>
           <hook name='park' on='collapse'><command>touch parked</command></hook>
           <test type='lua' name='wait' after-collapse='fail'>wait.lua</test>
         </suite>",
    );
    let args = ["run", "--web=127.0.0.1:0", "suite.xml"];
    let web = Web::of(folder.start_command(with_open_files(&folder, 256, &args)));
    let mut events = web.events("?from=0&details=none");
    crate::web::until_test_runs(&mut events, 0);
    let idle: Vec<_> =
        (0..CONNECTIONS).filter_map(|_| TcpStream::connect(web.address).ok()).collect();
    let robot = folder.read("pid").trim().parse().expect("a process id");
    assert!(crate::support::kill(robot));
    let seen = events.rest();
    assert_eq!(seen.last().map(|sent| sent.name.as_str()), Some("end"), "who was there is served");
    let finished = web.finish();
    assert_eq!(finished.code, Some(1), "{}", finished.stderr);
    assert!(folder.path().join("parked").exists(), "{}", finished.stderr);
    assert!(!finished.stderr.contains("Too many open files"), "{}", finished.stderr);
    let record = folder.journal().record;
    assert_eq!(record.verdict(rtf_model::TestId(0)), Some(Verdict::Collapsed));
    assert!(nothing_left(&folder));
    drop(idle);
}

#[test]
fn a_run_that_is_over_is_shown_for_as_long_as_was_asked_for() {
    let folder = Folder::new();
    folder.file("quick.lua", "function TestCase.run() rtf.check(true, 'fine') end\n");
    let args = ["run", "--web=127.0.0.1:0", "--web-linger=10min", "quick.lua"];
    let web = Web::start(&folder, &args);
    crate::support::wait_until("the end of the run", || {
        let lingers = get(web.address, "/api/v1").json()["lingers_s"].as_u64();
        lingers.filter(|left| (1..=600).contains(left))
    });
    let run = get(web.address, "/api/v1/runs/current").json();
    assert_eq!((&run["state"], &run["green"]), (&"finished".into(), &true.into()));
    let messages = get(web.address, "/api/v1/runs/current/tests/0/attempts/1/messages").json();
    assert_eq!(messages["messages"][0]["message"]["text"], "fine");
    let finished = web.end("TERM");
    assert_eq!(finished.code, Some(0), "the verdict is the run's: {}", finished.stderr);
}

#[test]
fn a_run_that_was_interrupted_does_not_linger() {
    let folder = Folder::new();
    folder.file("wait.lua", "function TestCase.run() rtf.sleep(1000) end\n");
    let args = ["run", "--web=127.0.0.1:0", "--web-linger=10min", "wait.lua"];
    let web = Web::start(&folder, &args);
    crate::web::until_test_runs(&mut web.events("?from=0&details=none"), 0);
    assert_eq!(web.end("INT").code, Some(130));
}

#[test]
fn a_run_that_is_interrupted_while_it_writes_its_reports_does_not_linger() {
    let folder = Folder::new();
    let lines = "for i = 1, 5000 do rtf.report(('x'):rep(100)) end";
    folder.file("wordy.lua", &format!("function TestCase.run() {lines} end\n"));
    let args = ["run", "-v", "--web=127.0.0.1:0", "--web-linger=10min", "wordy.lua"];
    let web = Web::start(&folder, &args);
    // Nobody reads its standard output yet, so the reports are not finished.
    crate::support::wait_until("the end of the run", || {
        let run = get(web.address, "/api/v1/runs/current").json();
        (run["state"] == "finished").then_some(())
    });
    let finished = web.end("TERM");
    assert_eq!(finished.code, Some(0), "the verdict is the run's: {}", finished.stderr);
}
