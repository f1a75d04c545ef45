//! The guard: whichever process is killed, the robot is parked once and no process is left.

use std::os::unix::process::CommandExt;
use std::process::{Command, Stdio};
use std::time::Duration;

use rtf_model::{EventKind, HookId, Phase, Source, TestId, Verdict};

use crate::host_modes::{MODES, Mode};
use crate::support::{Folder, Journal, Random, Running, nothing_left, number, send, wait_until};

/// A simulator that prints all the time, and a daemon that detaches itself twice.
const SIMULATOR: &str = "<fixture type='process' name='arm'>\
    <command>sh -c 'echo $$ > arm.pid; (setsid sh -c \"sleep 1000 &amp; touch started; exec sleep 1000\" &amp;); \
     until test -e started; do sleep 0.01; done; echo up; while :; do echo tick; done'</command>\
    <ready log='up'/></fixture>";
/// Parks only while the simulator is there.
const PARK: &str = "<hook name='park' on='interrupt end'>\
    <command>sh -c 'kill -0 $(cat arm.pid) &amp;&amp; echo $RTF_HOOK_TRIGGER $RTF_HOOK_TEST >> parked'</command></hook>";
const PATIENT: &str =
    "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(1000)\n";

fn suite(folder: &Folder, inside: &str, test: &str) {
    folder.file("T.py", test);
    folder.file("s.xml", &format!("<suite name='s'>{inside}<test type='python'>T</test></suite>"));
}

fn is_in_run(kind: &EventKind) -> bool {
    matches!(kind, EventKind::TestPhase { phase: Phase::Run, .. })
}

fn lines(folder: &Folder, file: &str) -> Vec<String> {
    let text = std::fs::read_to_string(folder.path().join(file)).unwrap_or_default();
    text.lines().map(str::to_owned).collect()
}

fn died(journal: &Journal) -> (&str, Vec<String>) {
    match &journal.events.last().expect("events").kind {
        EventKind::RunnerDied { reason, leaked: left } => {
            let owners = left.iter().filter_map(|process| process.owner.clone());
            (reason, owners.collect())
        }
        other => panic!("the last event is {other:?}"),
    }
}

#[test]
fn a_killed_runner_leaves_nothing_and_the_robot_is_parked() {
    let folder = Folder::new();
    suite(&folder, &format!("{SIMULATOR}{PARK}"), PATIENT);
    let running = folder.start(&["run", "s.xml", "--report", "junit=junit.xml"]);
    running.wait_for(is_in_run);
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    let told = "error: the runner died: signal 9 (SIGKILL)\n  hook park: parked\n";
    assert!(finished.stderr.starts_with(told), "{}", finished.stderr);
    assert!(nothing_left(&folder));
    assert_eq!(lines(&folder, "parked"), ["interrupt T"]);
    let journal = folder.journal();
    let (reason, owners) = died(&journal);
    assert_eq!(reason, "signal 9 (SIGKILL)");
    assert!(owners.is_empty(), "all of them ended when they were asked to: {owners:?}");
    assert_eq!(journal.record.final_verdict(TestId(0)), Verdict::Interrupted);
    let shown = folder.rtf(&["show", "latest"]);
    assert_eq!(shown.code, Some(5));
    assert!(shown.stdout.contains("the runner died: signal 9 (SIGKILL)"), "{}", shown.stdout);
    assert!(folder.path().join("junit.xml").exists(), "the reports are written nevertheless");
}

#[test]
fn a_hook_that_has_begun_comes_to_its_end_and_is_not_started_again() {
    let command = "<hook name='park' on='failure interrupt end'><command>sh -c 'echo begun >> parked; echo waiting; \
         until test -f go; do echo waiting; done; echo ended >> parked'</command></hook>";
    let plugin = "<hook name='park' on='failure interrupt end' type='python'>Park</hook>";
    for hook in [command, plugin] {
        let folder = Folder::new();
        folder.file("Park.py", "import os, rtf\nclass Park(rtf.TestCase):\n    def run(self):\n        open('parked', 'a').write('begun\\n')\n        while not os.path.exists('go'):\n            self.report('waiting')\n            self.sleep(0.001)\n        open('parked', 'a').write('ended\\n')\n");
        let test =
            "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.fail('no')\n";
        suite(&folder, hook, test);
        let running = folder.start(&["run", "s.xml"]);
        wait_until("the hook", || (lines(&folder, "parked") == ["begun"]).then_some(()));
        running.kill_runner();
        let runner = std::path::PathBuf::from(format!("/proc/{}/exe", running.child.id()));
        assert!(runner.exists(), "the guard lives");
        folder.file("go", "");
        let finished = running.finish();
        assert_eq!(finished.code, Some(5), "{hook}: {}", finished.stderr);
        assert_eq!(lines(&folder, "parked"), ["begun", "ended"]);
        let journal = folder.journal();
        assert_eq!(journal.record.hooks[0].runs.len(), 1, "{:?}", journal.record.hooks[0]);
        assert!(nothing_left(&folder));
    }
}

#[test]
fn a_plugin_hook_that_was_not_begun_is_run_by_the_guard() {
    let folder = Folder::new();
    folder.file("Park.py", "import rtf\nclass Park(rtf.TestCase):\n    def run(self):\n        self.report('parking')\n        open('parked', 'a').write('once\\n')\n");
    suite(&folder, "<hook name='park' on='interrupt' type='python'>Park</hook>", PATIENT);
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    assert_eq!(lines(&folder, "parked"), ["once"]);
    let said = folder.journal().events.into_iter().any(|event| {
        matches!(event.kind, EventKind::Message { source: Source::Hook(HookId(0)), message, .. } if message.text == "parking")
    });
    assert!(said, "what it reported is in the journal");
}

#[test]
fn a_hook_that_hangs_or_fails_is_told() {
    for (command, limit, problem) in [
        ("sleep 1000", "200ms", "it did not end within 200ms"),
        ("false", "10s", "it ended with exit code 1"),
        ("sh -c 'kill -KILL $$'", "10s", "it ended with signal 9 (SIGKILL)"),
    ] {
        let folder = Folder::new();
        let hook = format!(
            "<hook name='park' on='interrupt' timeout='{limit}'><command>{command}</command></hook>"
        );
        suite(&folder, &hook, PATIENT);
        let running = folder.start(&["run", "s.xml"]);
        running.wait_for(is_in_run);
        running.kill_runner();
        let finished = running.finish();
        assert_eq!(finished.code, Some(4), "{}", finished.stderr);
        let told = format!("  hook park: NOT PARKED: {problem}\n");
        assert!(finished.stderr.contains(&told), "{}", finished.stderr);
        let record = folder.journal().record;
        assert!(record.hook_failed());
        assert!(nothing_left(&folder));
    }
}

/// A hook is over when its process is, whoever still prints in its name.
#[test]
fn a_hook_that_leaves_a_process_that_prints_for_ever_comes_to_its_end() {
    let folder = Folder::new();
    let hook = "<hook name='park' on='interrupt'><command>sh -c 'for i in 1 2 3 4; do yes &amp; yes >&amp;2 &amp; done; exit 0'</command></hook>";
    suite(&folder, hook, PATIENT);
    let running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    running.kill_runner();
    let finished = running.finish();
    assert_eq!(finished.code, Some(5), "{}", finished.stderr);
    assert!(finished.stderr.contains("  hook park: parked\n"), "{}", finished.stderr);
    assert!(nothing_left(&folder));
}

#[test]
fn a_killed_runner_leaves_no_temporary_files() {
    let folder = Folder::new();
    let temporary = folder.path().join("tmp");
    std::fs::create_dir(&temporary).expect("a folder");
    suite(&folder, "", PATIENT);
    let mut command = folder.command(&["run", "s.xml"]);
    command.env("TMPDIR", &temporary);
    let running = folder.start_command(command);
    running.wait_for(is_in_run);
    let files = || std::fs::read_dir(&temporary).expect("the folder").count();
    assert_eq!(files(), 1);
    running.kill_runner();
    assert_eq!(running.finish().code, Some(5));
    assert_eq!(files(), 0);
}

#[test]
fn a_killed_guard_lets_the_runner_tear_down_in_order() {
    let folder = Folder::new();
    suite(&folder, &format!("{SIMULATOR}{PARK}"), PATIENT);
    let mut running = folder.start(&["run", "s.xml"]);
    running.wait_for(is_in_run);
    running.child.kill().expect("the guard is killed");
    // The runner has the same outputs: they close with its end.
    assert_eq!(running.finish().code, None);
    let journal = folder.journal();
    assert_eq!(journal.record.interrupted(), Some("the death of the guard"));
    assert_eq!(journal.record.verdict(TestId(0)), Some(Verdict::Interrupted));
    assert_eq!(lines(&folder, "parked").len(), 1);
    let stopped =
        |kind: &EventKind| matches!(kind, EventKind::FixtureStopped { problem: None, .. });
    assert!(journal.events.iter().any(|event| stopped(&event.kind)), "torn down in order");
    wait_until("the end of the runner", || nothing_left(&folder).then_some(()));
}

/// Starts `rtf` as a shell in a terminal does: in a group of its own, which
/// gets the terminal's signals.
fn in_own_group(folder: &Folder) -> Running {
    let mut command = folder.command(&["run", "s.xml"]);
    command.stdout(Stdio::piped()).stderr(Stdio::piped()).process_group(0);
    let running = folder.watch(command.spawn().expect("rtf starts"));
    running.wait_for(is_in_run);
    running
}

fn signal_group(running: &Running, signal: &str) {
    let group = format!("-{}", running.child.id());
    let status = Command::new("kill").args(["-s", signal, "--", &group]).status();
    assert!(status.expect("kill").success());
}

#[test]
fn a_terminals_ctrl_c_counts_once() {
    let folder = Folder::new();
    suite(&folder, &format!("{SIMULATOR}{PARK}"), PATIENT);
    let running = in_own_group(&folder);
    // Ctrl-Z does not stop a run that supervises a robot.
    signal_group(&running, "TSTP");
    signal_group(&running, "INT");
    assert_eq!(running.finish().code, Some(130));
    let journal = folder.journal();
    assert_eq!(journal.record.interrupted(), Some("SIGINT"));
    let stopped =
        |kind: &EventKind| matches!(kind, EventKind::FixtureStopped { problem: None, .. });
    assert!(journal.events.iter().any(|event| stopped(&event.kind)), "torn down, not killed");
    assert!(nothing_left(&folder));
}

#[test]
fn whoever_keeps_hitting_ctrl_c_ends_a_run_whose_runner_was_stopped() {
    let folder = Folder::new();
    suite(&folder, SIMULATOR, PATIENT);
    let mut running = in_own_group(&folder);
    send(running.runner(), "STOP");
    wait_until("the end", || {
        let ended = running.child.try_wait().expect("a child").is_some();
        if !ended {
            signal_group(&running, "INT");
        }
        ended.then_some(())
    });
    let finished = running.finish();
    assert_eq!(finished.code, Some(130), "{}", finished.stderr);
    assert_eq!(folder.journal().record.interrupted(), Some("SIGINT"));
    assert!(nothing_left(&folder));
}

#[test]
fn exit_codes_pass_through() {
    let folder = Folder::new();
    let body = |what: &str| {
        format!("import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        {what}\n")
    };
    let failing = "<hook name='park' on='end'><command>false</command></hook>";
    for (inside, test, code) in [
        ("", "pass", 0),
        ("", "self.fail('no')", 1),
        ("<nonsense/>", "pass", 2),
        (failing, "pass", 4),
    ] {
        suite(&folder, inside, &body(test));
        assert_eq!(folder.rtf(&["run", "s.xml"]).code, Some(code));
    }
}

#[test]
fn a_runner_killed_at_any_moment_leaves_nothing_and_parks_once() {
    let mut random = Random::from_environment();
    for run in 0..number("RTF_CHAOS_RUNS").unwrap_or(100) {
        let folder = Folder::new();
        let test =
            "import rtf\nclass T(rtf.TestCase):\n    def run(self):\n        self.sleep(0.05)\n";
        suite(&folder, &format!("{SIMULATOR}{PARK}"), test);
        let mode = MODES[random.below(3) as usize];
        in_mode(&folder, mode);
        if run % 4 == 0 {
            let path = folder.path().join("s.xml");
            let text = std::fs::read_to_string(path).expect("the suite");
            folder.file("s.xml", &text.replace("<suite ", "<suite isolate='network' "));
        }
        let running = folder.start(&["run", "--fork", mode.fork, "s.xml"]);
        running.runner();
        // Not to wait for something: this is the random moment.
        std::thread::sleep(Duration::from_micros(random.below(500_000)));
        let over = !running.try_kill_runner();
        let finished = running.finish();
        let context = format!("run {run}, {}: {}{}", mode.name, finished.stdout, finished.stderr);
        assert!(nothing_left(&folder), "{context}");
        check_any_moment(&folder, over, finished.code, &context);
    }
}

/// Three tests instead of one, so that hosts are forked or shared.
fn in_mode(folder: &Folder, mode: Mode) {
    let isolation = mode.isolation;
    let text = folder
        .read("s.xml")
        .replace("<test type", &format!("<test repetition='3' isolation='{isolation}' type"));
    folder.file("s.xml", &text);
}

fn check_any_moment(folder: &Folder, over: bool, code: Option<i32>, context: &str) {
    let path = folder.path().join("rtf-results/latest/events.jsonl");
    let begun = path.exists() && std::fs::metadata(&path).is_ok_and(|file| file.len() > 0);
    let parked = lines(folder, "parked").len();
    if !begun {
        // The guard knew of the suite before the first event was written.
        let hook_failed = context.contains("NOT PARKED");
        let expected = if hook_failed { 4 } else { 5 };
        assert_eq!((parked, code), (0, Some(expected)), "{context}");
        return;
    }
    let journal = folder.journal();
    let kinds = || journal.events.iter().map(|event| &event.kind);
    let suite_began = kinds().any(|kind| matches!(kind, EventKind::SuiteStarted { .. }));
    let fixture_ready = kinds().any(|kind| matches!(kind, EventKind::FixtureReady { .. }));
    assert!(parked <= 1, "parked {parked} times\n{context}");
    // Without the simulator the hook fails, which it says.
    assert!(!fixture_ready || parked == 1, "parked {parked} times\n{context}");
    let runs = journal.record.hooks.first().map_or(0, |hook| hook.runs.len());
    assert!(!suite_began || runs == 1, "{runs} runs\n{context}");
    let expected: &[i32] = match (over, journal.record.is_complete()) {
        (true, true) => &[0],
        // It died while it ended.
        (false, true) => &[0, 5],
        (_, false) if journal.record.hook_failed() => &[4],
        (_, false) => &[5],
    };
    assert!(code.is_some_and(|code| expected.contains(&code)), "{code:?}\n{context}");
}
