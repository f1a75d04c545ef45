//! Cases on several threads, in forked children, after `run`, in a run that is interrupted, and
//! in large numbers.

use std::io::{BufRead as _, BufReader};
use std::time::Duration;

use rtf_model::{AttemptRecord, EventKind, Measurement, Verdict};

use crate::host_modes::{FORKED, MODES, Mode, PROCESS};
use crate::support::{Folder, Journal, build_cpp, next_request, nothing_left, root};

/// Writes protocol messages to the channel, instead of its host.
const RAW: &str = r#"
import json
import os
import rtf


def send(method, **params):
    line = json.dumps({"jsonrpc": "2.0", "method": method, "params": params})
    for fd in range(3, 64):
        try:
            if os.readlink(f"/proc/self/fd/{fd}").startswith("socket:"):
                return os.write(fd, line.encode() + b"\n")
        except OSError:
            continue


class T(rtf.TestCase):
    def run(self):
        if self.param == "twice":
            send("case-started", case=1, name="pose")
            send("case-finished", case=1)
            send("case-finished", case=1)
        if self.param == "gap":
            send("case-started", case=2, name="pose")
        if self.param == "order":
            send("case-started", case=1, name="Arm")
            send("case-started", case=2, name="Moves", parent=1)
            send("case-finished", case=1)
        self.sleep(1)
"#;

fn folder_with_plugin() -> Folder {
    let folder = Folder::new();
    let built = build_cpp(&root().join("crates/rtf/tests/e2e/cpp"), "e2e-cpp").join("Cases.so");
    std::fs::copy(&built, folder.path().join("Cases.so")).expect("a copy");
    folder
}

/// Runs the C++ plug-in with this parameter.
fn run(mode: Mode, param: &str) -> Journal {
    let folder = folder_with_plugin();
    let isolation = mode.isolation;
    let test = format!("<test name='T' isolation='{isolation}' param='{param}'>Cases.so</test>");
    folder.file("s.xml", &format!("<suite name='s'>{test}</suite>\n"));
    let finished = folder.rtf(&["run", "--fork", mode.fork, "s.xml"]);
    assert!(finished.code.is_some_and(|code| code < 2), "{}{}", finished.stdout, finished.stderr);
    assert!(!finished.stdout.contains('\x1b'), "{}", finished.stdout);
    assert!(nothing_left(&folder));
    folder.journal()
}

fn attempt(journal: &Journal) -> &AttemptRecord {
    &journal.record.tests[0].attempts[0]
}

fn verdict(journal: &Journal) -> Verdict {
    attempt(journal).finished.as_ref().expect("an end").1.verdict
}

fn reason(journal: &Journal) -> &str {
    attempt(journal).finished.as_ref().and_then(|(_, end)| end.reason.as_deref()).unwrap_or("")
}

/// The paths of the cases, with their verdicts.
fn cases(journal: &Journal) -> Vec<(&str, Option<Verdict>)> {
    let kept = attempt(journal).cases.kept();
    kept.iter().map(|case| (case.path.as_str(), case.verdict())).collect()
}

/// The messages, each with the path of its case.
fn messages(journal: &Journal) -> Vec<(&str, &str)> {
    let attempt = attempt(journal);
    let path = |case| attempt.cases.get(case).map_or("?", |case| &case.path);
    let messages = attempt.messages.iter();
    messages.map(|m| (m.case.map_or("", path), m.text.as_str())).collect()
}

#[test]
fn threads_report_in_their_own_cases() {
    for mode in MODES {
        let journal = run(mode, "threads");
        assert_eq!((verdict(&journal), reason(&journal)), (Verdict::Passed, ""), "{}", mode.name);
        let messages = messages(&journal);
        assert_eq!(messages.len(), 2 * 2 * 200 + 2);
        for (case, text) in messages {
            assert_eq!(case, text);
        }
        let cases = cases(&journal);
        assert_eq!(cases.len(), 2 * 2 * 200 + 1);
        assert!(cases.iter().all(|(_, verdict)| *verdict == Some(Verdict::Passed)), "{cases:?}");
    }
}

#[test]
fn a_forked_child_reports_in_the_case_of_its_parent() {
    for mode in MODES {
        let journal = run(mode, "fork");
        assert_eq!((verdict(&journal), reason(&journal)), (Verdict::Passed, ""), "{}", mode.name);
        assert_eq!(cases(&journal), [("parent", Some(Verdict::Passed))]);
        let expected = [
            ("parent", "from the child"),
            ("parent", "after the child's case"),
            ("parent", "from the parent"),
        ];
        assert_eq!(messages(&journal), expected, "{}", mode.name);
    }
}

#[test]
fn a_case_after_run_is_an_error() {
    for mode in MODES {
        let journal = run(mode, "late");
        let expected = (Verdict::Error, "cases are allowed in `run` only");
        assert_eq!((verdict(&journal), reason(&journal)), expected, "{}", mode.name);
        assert_eq!(cases(&journal), []);
    }
}

#[test]
fn samples_measurements_and_attachments_belong_to_their_case() {
    let journal = run(PROCESS, "samples");
    assert_eq!(verdict(&journal), Verdict::Passed, "{}", reason(&journal));
    let mut found = Vec::new();
    for event in &journal.events {
        match &event.kind {
            EventKind::Sampled { samples, .. } => {
                found.push((samples.points[0].1, samples.case.map(|case| case.0)));
            }
            EventKind::Measured { measurement: Measurement { value, case, .. }, .. } => {
                found.push((*value, case.map(|case| case.0)));
            }
            EventKind::Attached { attachment, .. } => {
                found.push((None, attachment.case.map(|case| case.0)));
            }
            _ => {}
        }
    }
    let expected = [
        (Some(1.0), None),
        (Some(2.0), Some(1)),
        (Some(3.0), Some(1)),
        (None, Some(1)),
        (Some(4.0), None),
    ];
    assert_eq!(found, expected);
}

#[test]
fn control_characters_in_a_name_are_shown_escaped() {
    let journal = run(PROCESS, "names");
    let name = "line 1\nline 2 \x1b[31mred \u{fffd}";
    let expected = [(name, Some(Verdict::Failed)), ("case 2", Some(Verdict::Passed))];
    assert_eq!(cases(&journal), expected);
    assert_eq!(reason(&journal), format!("case `{name}`: it moves"));
}

#[test]
fn an_interrupted_run_finishes_its_open_cases() {
    for mode in MODES {
        let folder = folder_with_plugin();
        let isolation = mode.isolation;
        let test = format!("<test name='T' isolation='{isolation}' param='stuck'>Cases.so</test>");
        folder.file("s.xml", &format!("<suite name='s'>{test}</suite>\n"));
        let running = folder.start(&["run", "--fork", mode.fork, "s.xml"]);
        running.wait_for(
            |kind| matches!(kind, EventKind::CaseStarted(case) if case.start.name == "arm"),
        );
        next_request();
        running.signal("INT");
        let finished = running.finish();
        assert_ne!(finished.code, Some(0), "{}", finished.stdout);
        let journal = folder.journal();
        assert_eq!(verdict(&journal), Verdict::Interrupted, "{}", reason(&journal));
        let interrupted = Some(Verdict::Interrupted);
        assert_eq!(cases(&journal), [("bench", interrupted), ("bench/arm", interrupted)]);
        assert!(nothing_left(&folder), "{}", mode.name);
    }
}

#[test]
fn a_host_that_reports_cases_in_a_wrong_order_is_an_error() {
    let folder = Folder::new();
    folder.file("T.py", RAW);
    for (param, expected) in [
        ("twice", "finished case 1, which is not open"),
        ("gap", "started case 2 after case 0"),
        ("order", "finished case 1 before a case that it contains"),
    ] {
        folder.file("s.xml", &format!("<suite name='s'><test param='{param}'>T.py</test></suite>"));
        let finished = folder.rtf(&["run", "--fork", FORKED.fork, "s.xml"]);
        assert_eq!(finished.code, Some(1), "{}{}", finished.stdout, finished.stderr);
        let journal = folder.journal();
        assert_eq!(verdict(&journal), Verdict::Error, "{param}");
        assert!(reason(&journal).contains(expected), "{param}: {}", reason(&journal));
    }
}

/// The largest resident memory of a process, in MiB.
fn peak_mib(pid: i32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{pid}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? / 1024)
}

/// More than a record keeps. A debug build takes a minute for a million.
const MANY: u64 = if cfg!(debug_assertions) { 110_000 } else { 1_000_000 };

#[test]
fn the_runner_keeps_many_cases_in_little_memory() {
    let folder = folder_with_plugin();
    let test = format!("<test name='T' param='{MANY} cases'>Cases.so</test>");
    folder.file("s.xml", &format!("<suite name='s'>{test}</suite>\n"));
    let mut running = folder.start(&["run", "s.xml"]);
    let runner = running.runner();
    let mut peak = 0;
    while running.child.try_wait().expect("its state").is_none() {
        peak = peak.max(peak_mib(runner).unwrap_or_default());
        std::thread::sleep(Duration::from_millis(5));
    }
    let finished = running.finish();
    assert_eq!(finished.code, Some(0), "{}{}", finished.stdout, finished.stderr);
    println!("{MANY} cases: {peak} MiB");
    assert!((1..=200).contains(&peak), "the runner used {peak} MiB");
    let journal = folder.path().join("rtf-results/latest/events.jsonl");
    let lines = BufReader::new(std::fs::File::open(journal).expect("a journal")).lines();
    let is_end = |line: &String| line.contains(r#""type":"case-finished""#);
    let finished = lines.map(|line| line.expect("a line")).filter(is_end).count();
    assert_eq!(finished as u64, MANY);
}
