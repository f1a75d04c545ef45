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

fn whole(lines: &[String]) -> String {
    lines.iter().map(|line| format!("{line}\n")).collect()
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
    let notice = EventKind::TestPhase { test: TestId(0), phase: Phase::Notify };
    for (seq, kind) in [(0, EventKind::SuiteStarted { suite: SuiteId(0) }), (1, notice)] {
        let event = Event { seq, at: Micros::default(), kind };
        journal.event(&event, &Record::default()).unwrap();
    }
    assert_eq!(fs::read_to_string(&path).unwrap().lines().count(), 2);
}

/// The record of a journal that was cut off at any byte is that of its whole lines.
#[test]
fn a_journal_may_be_torn_anywhere() {
    let bytes = sealed("collapse-restart");
    let folder = tempfile::tempdir().unwrap();
    for end in 0..bytes.len() {
        let part = &bytes[..end];
        let stored = journal::read(&journal_of(folder.path(), part)).unwrap();
        let whole =
            part.split_inclusive(|byte| *byte == b'\n').filter(|line| line.ends_with(b"\n"));
        assert_eq!(stored.record.events, whole.count() as u64, "cut off at byte {end}");
        assert!(
            stored.record.damages.is_empty(),
            "cut off at byte {end}: {:?}",
            stored.record.damages
        );
        assert!(!stored.record.is_green(), "cut off at byte {end}");
        assert_eq!(stored.torn, !part.is_empty() && !part.ends_with(b"\n"), "{end}");
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
    assert!(!stored.torn && stored.record.damages.is_empty(), "{:?}", stored.record.damages);
    assert_eq!(stored.record.runner_death(), Some("signal 9 (SIGKILL)"));
    assert!(!stored.record.is_complete() && !stored.record.is_green());
    assert_eq!(stored.record.final_verdict(TestId(1)), Verdict::Interrupted);
}

#[test]
fn damage_is_named_with_its_line_and_the_rest_is_read() {
    let mut lines = lines("silent");
    let total = lines.len() as u64;
    lines[6] = "garbage".into();
    lines[8] = "\0\0\0\u{fffd}".into();
    let stored = read(whole(&lines)).unwrap();
    let places: Vec<_> = stored.record.damages.iter().map(|damage| damage.line).collect();
    assert_eq!(places, [7, 9]);
    assert!(stored.record.damages[0].problem.starts_with("this is not an event: "));
    assert_eq!(stored.record.events, total - 2);
    assert_eq!(stored.record.verdict(TestId(0)), Some(Verdict::Passed));
    assert!(!stored.record.is_green());
}

/// The fault that made this necessary: a failed test that is not planned any
/// more takes its failure along.
#[test]
fn a_journal_with_one_changed_byte_is_damaged_and_not_green() {
    let mut bytes = sealed("silent");
    assert!(read(&bytes).unwrap().record.is_green());
    let planned = "\"type\":\"test-planned\"";
    let text = String::from_utf8(bytes.clone()).unwrap();
    bytes[text.find(planned).unwrap() + planned.len() - 2] ^= 1;
    let stored = read(&bytes).unwrap();
    assert!(stored.record.is_damaged() && !stored.record.is_green());
    assert_eq!(stored.record.damages[0].line, 3);
}

/// Each byte of a journal with check values matters, also those of the check values.
#[test]
fn a_change_of_any_byte_is_found() {
    let bytes = sealed("silent");
    for place in 0..bytes.len() {
        let mut changed = bytes.clone();
        changed[place] ^= 0x04;
        let found = read(&changed).map(|stored| stored.record.is_green());
        assert!(!matches!(found, Ok(true)), "byte {place}");
    }
}

#[test]
fn a_line_that_was_removed_added_or_moved_is_found() {
    let text = String::from_utf8(sealed("verdicts")).unwrap();
    let lines: Vec<_> = text.lines().map(str::to_owned).collect();
    let damages = |lines: &[String]| read(whole(lines)).unwrap().record.damages;
    assert_eq!(damages(&lines), []);
    for line in 1..lines.len() - 1 {
        let (mut removed, mut twice, mut moved) = (lines.clone(), lines.clone(), lines.clone());
        removed.remove(line);
        twice.insert(line, lines[line].clone());
        moved.swap(line, line + 1);
        for changed in [removed, twice, moved] {
            assert!(!damages(&changed).is_empty(), "line {line}");
        }
    }
}

/// The order in which reporters need it: before anything of the run.
#[test]
fn a_replay_knows_all_damage_from_the_first_event_on() {
    struct First(Option<usize>);
    impl Reporter for First {
        fn event(&mut self, _: &Event, record: &Record) -> Result<(), rtf_report::ReportError> {
            self.0.get_or_insert(record.damages.len());
            Ok(())
        }
    }
    let mut lines = lines("silent");
    let last = lines.len() - 1;
    lines[last - 1] = "garbage".into();
    let folder = tempfile::tempdir().unwrap();
    let mut first = First(None);
    let stored = journal::replay(&journal_of(folder.path(), whole(&lines)), &mut first).unwrap();
    assert_eq!((first.0, stored.record.damages.len()), (Some(1), 1));
}

#[test]
fn events_that_come_twice_count_once() {
    let mut lines = lines("silent");
    lines.insert(5, lines[4].clone());
    let stored = read(whole(&lines)).unwrap();
    assert_eq!(stored.record.damages.len(), 1);
    assert_eq!(stored.record.damages[0].line, 6);
    assert_eq!(stored.record.verdict(TestId(0)), Some(Verdict::Passed));
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
    assert!(read(later + "\n").unwrap().record.is_green());
}

/// Another process changes the file during the run.
mod interference {
    use super::*;

    struct Run {
        folder: tempfile::TempDir,
        journal: Journal,
        record: Record,
    }

    impl Run {
        /// A run of which half is written.
        fn begun() -> Self {
            let folder = tempfile::tempdir().unwrap();
            fs::create_dir(folder.path().join("run")).unwrap();
            let journal = Journal::create(&folder.path().join("run/events.jsonl")).unwrap();
            let mut run = Self { folder, journal, record: Record::default() };
            let events = events("verdicts").0;
            run.write(&events[..events.len() / 2]).unwrap();
            run
        }

        fn path(&self, name: &str) -> PathBuf {
            self.folder.path().join(name)
        }

        fn write(&mut self, events: &[Event]) -> Result<(), rtf_report::ReportError> {
            for event in events {
                self.record.apply(event);
                self.journal.event(event, &self.record)?;
            }
            self.journal.idle(&self.record)
        }

        /// Writes the rest; returns the error at the end.
        fn rest(&mut self) -> String {
            let events = events("verdicts").0;
            let written = self.write(&events[events.len() / 2..]);
            let closed = written.and_then(|()| self.journal.finish(&self.record));
            let error = closed.unwrap_err();
            std::error::Error::source(&error).unwrap().to_string()
        }
    }

    #[test]
    fn a_journal_that_is_removed_is_missed() {
        let mut run = Run::begun();
        fs::remove_dir_all(run.path("run")).unwrap();
        assert_eq!(run.rest(), "it was removed during the run");
    }

    #[test]
    fn a_folder_that_is_moved_is_missed_and_found() {
        let mut run = Run::begun();
        fs::rename(run.path("run"), run.path("elsewhere")).unwrap();
        let told = run.rest();
        assert!(told.starts_with("it was moved during the run"), "{told}");
        let stored = journal::read(&run.path("elsewhere/events.jsonl")).unwrap();
        assert!(stored.record.is_complete() && !stored.record.is_damaged());
    }

    #[test]
    fn a_journal_that_is_replaced_is_noticed() {
        let mut run = Run::begun();
        let journal = run.path("run/events.jsonl");
        fs::rename(&journal, run.path("run/old.jsonl")).unwrap();
        fs::copy(run.path("run/old.jsonl"), &journal).unwrap();
        let told = run.rest();
        assert!(told.starts_with("it was replaced during the run"), "{told}");
    }

    #[test]
    fn a_journal_that_somebody_else_cuts_or_appends_to_is_noticed() {
        let mut run = Run::begun();
        fs::write(run.path("run/events.jsonl"), "").unwrap();
        let told = run.rest();
        assert!(told.starts_with("it has 0 bytes instead of "), "{told}");
        let mut run = Run::begun();
        let mut bytes = fs::read(run.path("run/events.jsonl")).unwrap();
        bytes.extend_from_slice(b"{}\n");
        fs::write(run.path("run/events.jsonl"), bytes).unwrap();
        let told = run.rest();
        assert!(told.ends_with("something else changed it"), "{told}");
        // Written again by its own writer, the file would hide it.
        let stored = journal::read(&run.path("run/events.jsonl")).unwrap();
        assert!(stored.record.is_damaged());
    }
}
