//! Locks: one suite at a time uses an exclusive resource.

use std::process::{Output, Stdio};
use std::time::Duration;

use insta::assert_snapshot;
use rtf_model::EventKind;

use crate::support::{Folder, Random, Running, build_cpp, nothing_left, root, send, wait_until};

/// Says that it runs, and waits until it may end.
const WAITS: &str = "TestCase = {}\nfunction TestCase.run()\n  io.open('begun', 'w'):close()\n  \
                     rtf.wait_until(function() return io.open('end') end, 60, 'the end')\nend\n";

fn folder() -> Folder {
    let folder = Folder::new();
    folder.file("W.lua", WAITS);
    folder.file("P.lua", "TestCase = {}\nfunction TestCase.run() end\n");
    folder
        .file("long.xml", "<suite requires='robot arm:left/2'>\n  <test>W.lua</test>\n</suite>\n");
    folder.file("next.xml", "<suite requires='robot'>\n  <test>P.lua</test>\n</suite>\n");
    folder
}

fn rtf(folder: &Folder, args: &[&str]) -> Output {
    let mut command = folder.command(args);
    command.env("RTF_LOCKS", folder.path().join("locks"));
    command.output().expect("rtf runs")
}

fn locks(folder: &Folder) -> String {
    String::from_utf8(rtf(folder, &["locks"]).stdout).expect("text")
}

/// A run of `long.xml` whose test has begun.
fn long(folder: &Folder) -> crate::support::Running {
    let mut command = folder.command(&["run", "--results", "long", "long.xml"]);
    command.env("RTF_LOCKS", folder.path().join("locks")).env("USER", "ada");
    command.stdout(Stdio::piped()).stderr(Stdio::piped());
    let running = folder.watch(command.spawn().expect("rtf starts"));
    wait_until("the test", || folder.path().join("begun").exists().then_some(()));
    running
}

#[test]
fn two_who_compete_200_times_never_overlap_also_when_one_is_killed() {
    let plugins = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp");
    let folder = folder();
    let test = plugins.join("Alone.so");
    let suite = format!("<suite requires='robot'>\n  <test>{}</test>\n</suite>\n", test.display());
    folder.file("alone.xml", &suite);
    std::thread::scope(|scope| {
        for worker in ["one", "two"] {
            let folder = &folder;
            let mut random = Random::from_environment();
            scope.spawn(move || {
                for round in 0..100 {
                    let mut command = folder.command(&["run", "--results", worker, "alone.xml"]);
                    command.env("RTF_LOCKS", folder.path().join("locks"));
                    command.stdout(Stdio::piped()).stderr(Stdio::piped());
                    let running = folder.watch(command.spawn().expect("rtf starts"));
                    if round % 5 == 0 {
                        // Not to wait for something: the moment is what is drawn.
                        std::thread::sleep(Duration::from_millis(random.below(30)));
                        let killed = running.try_kill_runner();
                        let code = running.finish().code;
                        assert!(code == Some(0) || (killed && code == Some(5)), "{code:?}");
                    } else {
                        let finished = running.finish();
                        assert_eq!(finished.code, Some(0), "{}", finished.stdout);
                    }
                }
            });
        }
    });
    assert_eq!(locks(&folder), "");
    let told = rtf(&folder, &["locks"]).stderr;
    assert_eq!(String::from_utf8_lossy(&told), "no locks are held\n");
    assert!(nothing_left(&folder));
}

#[test]
fn who_waits_says_for_whom_and_gives_up() {
    let folder = folder();
    let running = long(&folder);
    let shown = locks(&folder);
    assert!(shown.starts_with("arm:left #1  ada@"), "{shown}");
    assert!(shown.contains("\nrobot #1  ada@") && shown.contains("(suite long of run "), "{shown}");
    let late = rtf(&folder, &["locks", "--wait", "robot", "--timeout", "10ms"]);
    assert_eq!(late.status.code(), Some(1));
    let gave_up = rtf(&folder, &["run", "--lock-timeout", "300ms", "next.xml"]);
    let text = String::from_utf8_lossy(&gave_up.stdout);
    assert_eq!(gave_up.status.code(), Some(1), "{text}");
    assert!(text.contains("waiting  suite next waits for `robot`, held by ada@"), "{text}");
    // The time that it really waited: on a busy machine more than its limit.
    assert!(text.contains("`robot` is held by ada@"), "{text}");
    assert!(text.contains("; given up after "), "{text}");
    folder.file("end", "");
    assert_eq!(running.finish().code, Some(0));
    let free = rtf(&folder, &["locks", "--wait", "robot"]);
    assert_eq!((free.status.code(), free.stdout.len()), (Some(0), 0));
    assert_eq!(rtf(&folder, &["run", "--lock-timeout", "10s", "next.xml"]).status.code(), Some(0));
}

#[test]
fn ctrl_c_ends_the_wait() {
    let folder = folder();
    let running = long(&folder);
    let mut command = folder.command(&["run", "next.xml"]);
    command.env("RTF_LOCKS", folder.path().join("locks")).stdout(Stdio::piped());
    let waiting = folder.watch(command.spawn().expect("rtf starts"));
    waiting.wait_for(|event| matches!(event, EventKind::SuiteWaiting { .. }));
    waiting.signal("INT");
    assert_eq!(waiting.finish().code, Some(130));
    let record = folder.journal().record;
    assert_eq!(record.tests[0].skipped.as_deref(), Some("stopped by SIGINT"));
    folder.file("end", "");
    assert_eq!(running.finish().code, Some(0));
}

#[test]
fn the_lock_of_a_killed_runner_stays_until_its_guard_has_parked_the_robot() {
    let folder = folder();
    folder.file(
        "long.xml",
        "<suite requires='robot'>\n  <test>W.lua</test>\n  <hook on='end' name='park'>\n    \
         <command>sh -c 'touch parking; while [ ! -e parked ]; do sleep 0.01; done'</command>\n  \
         </hook>\n</suite>\n",
    );
    let running = long(&folder);
    running.kill_runner();
    wait_until("the hook", || folder.path().join("parking").exists().then_some(()));
    assert!(locks(&folder).starts_with("robot #1  ada@"));
    folder.file("parked", "");
    assert_eq!(running.finish().code, Some(5));
    assert_eq!(locks(&folder), "");
}

#[test]
fn mistakes_in_requires() {
    let folder = folder();
    let requires = "robot arm/0 arm/two robot /etc .hidden";
    folder.file("s.xml", &format!("<suite requires='{requires}'><test>P.lua</test></suite>"));
    let finished = folder.rtf(&["check", "s.xml"]);
    assert_snapshot!(folder.shown(&finished), @"
    exit code 2
    ----- stdout
    ----- stderr
    error: `arm/0` has `0`, expected a number from 1 to 1000
     --> s.xml:1:24
      |
    1 | <suite requires='robot arm/0 arm/two robot /etc .hidden'><test>P.lua</test></suite>
      |                        ^^^^^
      |
      = help: with `gpu/2`, two suites at a time can use a `gpu`

    error: `arm/two` has `two`, expected a number from 1 to 1000
     --> s.xml:1:30
      |
    1 | <suite requires='robot arm/0 arm/two robot /etc .hidden'><test>P.lua</test></suite>
      |                              ^^^^^^^
      |
      = help: with `gpu/2`, two suites at a time can use a `gpu`

    error: `robot` is required twice
     --> s.xml:1:38
      |
    1 | <suite requires='robot arm/0 arm/two robot /etc .hidden'><test>P.lua</test></suite>
      |                                      ^^^^^

    error: `/etc` has `etc`, expected a number from 1 to 1000
     --> s.xml:1:44
      |
    1 | <suite requires='robot arm/0 arm/two robot /etc .hidden'><test>P.lua</test></suite>
      |                                            ^^^^
      |
      = help: with `gpu/2`, two suites at a time can use a `gpu`

    error: `.hidden` is not the name of a resource
     --> s.xml:1:49
      |
    1 | <suite requires='robot arm/0 arm/two robot /etc .hidden'><test>P.lua</test></suite>
      |                                                 ^^^^^^^
      |
      = help: letters, digits, `_`, `-`, `.` and `:`, for example `robot:icub`

    5 errors; nothing was started
    ");
}

/// The last line of defence: the driver lives, its lock is free, and nobody has
/// parked the robot.
#[test]
fn what_a_run_left_whose_guard_was_killed_too_is_stopped_before_the_robot_is_used() {
    let folder = folder();
    let driver = "<fixture type='process'><command>sh -c 'echo $$ > driver; echo up; exec sleep 1000'</command><ready log='up'/></fixture>";
    let suite = format!("<suite requires='robot'>{driver}<test>W.lua</test></suite>");
    folder.file("long.xml", &suite);
    let finds = "<fixture type='process'><command>sh -c 'grep -q . /proc/$(cat driver)/cmdline &amp;&amp; touch met; echo up; exec sleep 1000'</command><ready log='up'/></fixture>";
    let suite = format!("<suite requires='robot'>{finds}<test>P.lua</test></suite>");
    folder.file("next.xml", &suite);
    let running = long(&folder);
    send(running.child.id().cast_signed(), "STOP");
    running.kill_runner();
    send(running.child.id().cast_signed(), "KILL");
    // Its driver has its outputs: they stay open.
    let Running { mut child, .. } = running;
    child.wait().expect("the guard was killed");
    assert!(!nothing_left(&folder), "the driver lives");
    let next = rtf(&folder, &["run", "next.xml"]);
    let shown = String::from_utf8_lossy(&next.stdout).into_owned();
    assert_eq!(next.status.code(), Some(0), "{shown}");
    assert!(!folder.path().join("met").exists(), "{shown}");
    assert!(shown.contains("(suite long of run"), "{shown}");
    assert!(shown.contains("were killed: its hooks did not run"), "{shown}");
    assert!(shown.contains("sleep 1000"), "what was stopped is named: {shown}");
    wait_until("the end of the driver", || nothing_left(&folder).then_some(()));
    let again = rtf(&folder, &["run", "next.xml"]);
    let shown = String::from_utf8_lossy(&again.stdout).into_owned();
    assert!(!shown.contains("were killed"), "it is said once: {shown}");
}
