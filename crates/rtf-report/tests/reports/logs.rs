//! The files with what each process printed.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use crate::support::*;
use rtf_model::{Event, EventKind, Micros, Record, TestId, TestPlanned};
use rtf_report::journal;
use rtf_report::logs::{Logs, attempt_log, test_log};

fn logs(name: &str) -> BTreeMap<String, String> {
    let folder = tempfile::tempdir().unwrap();
    journal::replay(&stream_path(name), &mut Logs::new(folder.path())).unwrap();
    let Ok(entries) = fs::read_dir(folder.path().join("logs")) else { return BTreeMap::new() };
    let file = |entry: fs::DirEntry| {
        let text = fs::read_to_string(entry.path()).unwrap();
        (entry.file_name().into_string().unwrap(), text)
    };
    entries.map(|entry| file(entry.unwrap())).collect()
}

#[test]
fn who_prints_nothing_leaves_no_file() {
    assert!(logs("silent").is_empty());
}

#[test]
fn each_test_and_fixture_has_a_log_with_all_that_it_printed() {
    let logs = logs("verdicts");
    let names: Vec<_> = logs.keys().map(String::as_str).collect();
    let wanted = [
        "arm.EncoderTest.log",
        "arm.GripperTest.log",
        "arm.SegvTest.log",
        "arm.fixture-simulator.log",
    ];
    assert_eq!(names, wanted);
    assert_eq!(logs["arm.GripperTest.log"].lines().count(), 31);
    assert_eq!(logs["arm.SegvTest.log"], "about to crash");
}

#[test]
fn repetitions_and_restarts_have_logs_of_their_own() {
    let repetitions = logs("repetitions");
    assert_eq!(repetitions["arm.MoveTest.r2.log"], "second time\n");
    assert_eq!(repetitions["arm.MoveTest.r3.log"], "third time\n");
    let broken = logs("collapse-broken");
    assert_eq!(broken["arm.fixture-simulator.a2.log"], "cannot open display\n");
}

#[test]
fn each_run_of_a_hook_has_a_log_of_its_own() {
    let logs = logs("hooks");
    assert_eq!(logs["arm.hook-park.log"], "moving to the rest position\nparked\n");
    assert_eq!(logs["arm.hook-park.a2.log"], "moving to the rest position\n");
    assert_eq!(logs["arm.hook-park.a3.log"], "parked\n");
    assert!(logs["arm.hook-brakes.log"].ends_with("last words"));
}

#[test]
fn a_log_of_a_killed_run_holds_what_was_printed_until_then() {
    assert_eq!(logs("killed")["arm.MoveTest.log"], "moving\n");
}

#[test]
fn names_that_would_leave_the_folder_do_not() {
    let logs = logs("nasty");
    for name in logs.keys() {
        let plain = |c: char| c.is_ascii_alphanumeric() || "._-~".contains(c);
        assert!(name.chars().all(plain) && !name.starts_with('.'), "{name}");
    }
    assert!(logs.values().any(|text| text.contains("[… 123456 bytes left out …]\ntail ]]>\n")));
}

#[test]
fn names_that_look_alike_get_files_of_their_own() {
    let mut record = Record::default();
    let names = ["a b", "a_b", "a/b", "a.b", "a", "fixture-x", "hook-x", "a.r2", "ä", ""];
    let mut events: Vec<_> =
        events("silent").0.into_iter().take(2).map(|event| event.kind).collect();
    for (id, name) in (0..).zip(names) {
        events.push(EventKind::TestPlanned(TestPlanned {
            learned: Vec::new(),
            test: TestId(id),
            suite: rtf_model::SuiteId(0),
            name: name.to_owned(),
            plugin_type: "dll".into(),
            plugin: String::new(),
            repetitions: 2,
            timed: false,
            tags: Vec::new(),
            plugin_hash: None,
            source_hash: None,
            was: None,
            expected: None,
            parameters: Vec::new(),
        }));
    }
    for (seq, kind) in (0..).zip(events) {
        record.apply(&Event { seq, at: Micros(0), kind });
    }
    let mut paths = Vec::new();
    for test in &record.tests {
        for number in [(1, 1), (2, 1), (2, 2)] {
            let path = attempt_log(&record, test.plan.test, number);
            assert_eq!(path.parent(), Some(Path::new("logs")));
            paths.push(path);
        }
    }
    assert_eq!(test_log(&record, TestId(1)), attempt_log(&record, TestId(1), (1, 1)));
    let total = paths.len();
    paths.sort();
    paths.dedup();
    assert_eq!(paths.len(), total);
}

#[test]
fn what_a_suite_has_for_itself_has_a_log() {
    let logs = logs("prepared");
    let [(name, text)] = logs.iter().collect::<Vec<_>>()[..] else { panic!("{logs:?}") };
    assert_eq!(name, "arm.suite.log");
    assert!(text.contains("port sim: 20019\nROS_DOMAIN_ID=7 (inherited)\n"), "{text}");
    assert!(text.ends_with("RTF_PORT_SIM=20019 ${SHELL:-sh}\n"), "{text}");
}
