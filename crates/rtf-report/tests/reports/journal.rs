//! The journal: what is written comes back, also from a damaged file.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use crate::support::*;
use rtf_model::{Event, EventKind, Micros, Phase, Record, SuiteId, TestId, Verdict};
use rtf_report::journal::{self, Journal, JournalError, Stored};
use rtf_report::{Fanout, Reporter};

fn journal_of(folder: &Path, bytes: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.join("events.jsonl");
    fs::write(&path, bytes).unwrap();
    path
}

fn read(bytes: impl AsRef<[u8]>) -> Result<Stored, JournalError> {
    let folder = tempfile::tempdir().unwrap();
    journal::read(&journal_of(folder.path(), bytes))
}

fn lines(name: &str) -> Vec<String> {
    let text = fs::read_to_string(stream_path(name)).unwrap();
    text.lines().map(str::to_owned).collect()
}

#[test]
fn what_is_written_is_what_was_read() {
    for name in names().into_iter().filter(|name| name != KILLED) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("events.jsonl");
        let (events, _) = events(&name);
        let fanout = Fanout::start(vec![Box::new(Journal::create(&path).unwrap())]).unwrap();
        events.iter().for_each(|event| fanout.send(event.clone()));
        assert!(fanout.join().errors.is_empty());
        let mut again: Vec<Event> = Vec::new();
        let stored = journal::read_with(&path, |event, _| {
            again.push(event.clone());
            Ok(())
        });
        assert_eq!(again, events, "{name}");
        assert!(!stored.unwrap().torn);
    }
}

#[test]
fn an_earlier_journal_is_not_overwritten() {
    let folder = tempfile::tempdir().unwrap();
    let path = journal_of(folder.path(), "precious");
    assert!(Journal::create(&path).is_err());
    assert_eq!(fs::read_to_string(path).unwrap(), "precious");
}

/// The runner may be killed at any moment: the end of a test must be on disk within
/// a millisecond, although the queue was never empty since.
#[test]
fn the_end_of_a_test_is_written_soon() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("events.jsonl");
    let mut journal = Journal::create(&path).unwrap();
    let mut record = Record::default();
    let verdict = || journal::read(&path).unwrap().record.verdict(TestId(0));
    for event in events("silent").0 {
        record.apply(&event);
        journal.event(&event, &record).unwrap();
        if record.verdict(TestId(0)).is_some() {
            break;
        }
    }
    // Something that need not be there soon by itself brings it along.
    std::thread::sleep(Duration::from_millis(1));
    let test = TestId(1);
    let kind = EventKind::TestPhase { test, phase: Phase::Run };
    journal.event(&Event { seq: record.events, at: record.last_at, kind }, &record).unwrap();
    assert_eq!(verdict(), Some(Verdict::Passed));
}

/// A recorder reads what its test has told, as soon as it hears of its end.
#[test]
fn what_fixtures_may_read_is_written_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("events.jsonl");
    let mut journal = Journal::create(&path).unwrap();
    let notice = EventKind::TestPhase { test: TestId(0), phase: Phase::Notice };
    for (seq, kind) in [(0, EventKind::SuiteStarted { suite: SuiteId(0) }), (1, notice)] {
        let event = Event { seq, at: Micros::default(), kind };
        journal.event(&event, &Record::default()).unwrap();
    }
    assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 2);
}

/// The record of a journal that was cut off at any byte is that of its whole lines.
#[test]
fn a_journal_may_be_torn_anywhere() {
    let bytes = fs::read(stream_path("collapse-restart")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    for end in 0..bytes.len() {
        let part = &bytes[..end];
        let stored = journal::read(&journal_of(folder.path(), part)).unwrap();
        let whole = part
            .split_inclusive(|byte| *byte == b'\n')
            .filter(|line| line.ends_with(b"\n") || serde_json::from_slice::<Event>(line).is_ok());
        assert_eq!(stored.record.events, whole.count() as u64, "cut off at byte {end}");
        assert!(stored.damages.is_empty(), "cut off at byte {end}: {:?}", stored.damages);
        assert!(!stored.record.is_green(), "cut off at byte {end}");
        let read_all = stored.record.events == part.iter().filter(|b| **b == b'\n').count() as u64;
        assert_eq!(stored.torn, read_all && !part.is_empty() && !part.ends_with(b"\n"), "{end}");
    }
}

/// The guard cuts off the line that the runner was writing when it died, runs
/// the hooks and closes the journal: that is a whole journal of a run that is not.
#[test]
fn what_the_guard_adds_to_a_torn_journal_is_read() {
    let torn = fs::read_to_string(stream_path(KILLED)).unwrap();
    let (whole, rest) = torn.split_at(torn.rfind('\n').unwrap() + 1);
    assert!(!rest.is_empty());
    let seq = whole.lines().count();
    let end = format!(
        "{{\"seq\":{seq},\"at\":900000,\"type\":\"runner-died\",\"reason\":\"signal 9 (SIGKILL)\"}}\n"
    );
    let stored = read(whole.to_owned() + &end).unwrap();
    assert!(!stored.torn && stored.damages.is_empty(), "{:?}", stored.damages);
    assert_eq!(stored.record.died(), Some("signal 9 (SIGKILL)"));
    assert!(!stored.record.is_complete() && !stored.record.is_green());
    assert_eq!(stored.record.final_verdict(TestId(1)), Verdict::Interrupted);
}

#[test]
fn damage_is_told_with_its_line_and_the_rest_is_read() {
    let mut lines = lines("silent");
    let total = lines.len() as u64;
    lines[6] = "garbage".into();
    lines[8] = "\0\0\0\u{fffd}".into();
    let stored = read(lines.join("\n")).unwrap();
    let places: Vec<_> = stored.damages.iter().map(|damage| damage.line).collect();
    assert_eq!(places, [7, 8, 9, 10]);
    assert!(stored.damages[0].problem.starts_with("this is not an event: "));
    assert_eq!(stored.damages[1].problem, "event 7 stands where event 6 should be");
    assert_eq!(stored.record.events, total - 2);
    assert_eq!(stored.record.verdict(TestId(0)), Some(Verdict::Passed));
}

#[test]
fn events_that_come_twice_count_once() {
    let mut lines = lines("silent");
    lines.insert(5, lines[4].clone());
    let stored = read(lines.join("\n")).unwrap();
    assert_eq!(stored.damages.len(), 1);
    assert_eq!(stored.damages[0].line, 6);
    assert!(stored.record.is_green());
}

#[test]
fn a_file_that_is_no_journal_is_refused() {
    let error = read("\x7fELF\n\0\0\n").unwrap_err();
    assert!(matches!(error, JournalError::NotAJournal { .. }), "{error}");
    let error = read("one line").unwrap_err();
    assert!(matches!(error, JournalError::NotAJournal { .. }), "{error}");
    assert!(read("").unwrap().record.run.is_none());
    let missing = journal::read(Path::new("there/is/no/such/file")).unwrap_err();
    assert!(matches!(missing, JournalError::Read { .. }), "{missing}");
}

#[test]
fn a_journal_of_a_newer_version_is_refused() {
    let newer = lines("silent").join("\n").replacen("\"version\":1", "\"version\":2", 1);
    let error = read(newer).unwrap_err();
    assert!(matches!(error, JournalError::Version { found: 2, .. }), "{error}");
}

#[test]
fn fields_of_a_later_runner_are_ignored() {
    let later = lines("silent").join("\n").replace("\"seq\":", "\"mood\":\"good\",\"seq\":");
    assert!(read(later).unwrap().record.is_green());
}
