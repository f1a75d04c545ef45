//! What the predecessor printed and wrote, made of every stored stream.

use std::path::Path;

use anstream::StripStream;
use rtf_model::{EventKind, Record};
use rtf_report::Reporter;
use rtf_report::journal;
use rtf_report::predecessor::{self, ResultList, ResultListOptions};

use crate::support::*;

fn console(name: &str, options: ResultListOptions) -> String {
    let paper = Paper::default();
    let plain = StripStream::new(Box::new(paper.clone()) as Box<dyn std::io::Write + Send>);
    journal::replay(&stream_path(name), &mut ResultList::new(Box::new(plain), options)).unwrap();
    paper.text()
}

fn file(name: &str, detail: bool) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("result.txt");
    let mut file = predecessor::file(&path, &stream_path(name), detail).unwrap();
    assert!(!path.exists(), "nothing is there before the end");
    file.finish(&Record::default()).unwrap();
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn result_file() {
    for name in names() {
        insta::assert_snapshot!(format!("predecessor-file-{name}"), file(&name, false));
    }
}

#[test]
fn quiet_and_talkative() {
    let quiet = ResultListOptions { summary: true, ..ResultListOptions::default() };
    let talkative = ResultListOptions { verbose: true, detail: true, summary: false };
    for name in ["verdicts", "silent", "hooks", "nasty", "killed"] {
        insta::assert_snapshot!(format!("predecessor-quiet-{name}"), console(name, quiet));
        insta::assert_snapshot!(format!("predecessor-verbose-{name}"), console(name, talkative));
    }
    insta::assert_snapshot!("predecessor-detail", file("verdicts", true));
}

/// The file of the predecessor was all green after a collapse in the last test.
#[test]
fn every_test_that_did_not_pass_is_failed_in_the_file_and_in_the_counts() {
    for name in names() {
        let (text, record) = (file(&name, false), record(&name));
        let count = |end: &str| text.lines().filter(|line| line.ends_with(end)).count();
        let passed = record.tests.iter().filter(|test| record.is_test_green(test)).count();
        let cases = |line: &str| line.starts_with("Test case ") && line.ends_with(" passed!");
        assert_eq!(text.lines().filter(|line| cases(line)).count(), passed, "{name}");
        let failed = record.tests.len() - passed;
        assert_eq!(count(&format!("failed test cases  : {failed}")), 1, "{name}\n{text}");
        assert_eq!(count(&format!("passed test cases  : {passed}")), 1, "{name}\n{text}");
        assert_eq!(
            text.contains("[FAIL]") || text.contains("[ERROR]"),
            !record.is_green(),
            "{name}"
        );
    }
}

#[test]
fn junit_report() {
    for name in ["verdicts", "nasty"] {
        let (path, mut xml) = (stream_path(name), Vec::new());
        predecessor::write_junit(&mut xml, &record(name), &path, false).unwrap();
        let folder = path.parent().unwrap().display().to_string();
        let xml = String::from_utf8(xml).unwrap().replace(&folder, "/run");
        insta::assert_snapshot!(format!("predecessor-junit-{name}"), xml);
    }
}

/// The file contains all messages, because it is generated from the journal.
#[test]
fn a_journal_that_cannot_be_read_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("result.txt");
    let mut file = predecessor::file(&path, Path::new("/nowhere/events.jsonl"), false).unwrap();
    assert!(file.finish(&Record::default()).is_err());
    assert!(!path.exists());
}

/// A suite is named when it begins and when it ends.
#[test]
fn what_begins_ends() {
    for name in names() {
        let text = file(&name, false);
        let (events, _) = events(&name);
        let started = events
            .iter()
            .filter(|e| matches!(e.kind, EventKind::TestStarted { repetition: 1, attempt: 1, .. }));
        let begun = text
            .lines()
            .filter(|line| line.starts_with("Test case ") && line.ends_with(" started..."));
        assert_eq!(begun.count(), started.count(), "{name}");
    }
}
