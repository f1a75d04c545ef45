//! Logs and reports of the corpus in `tests/frameworks/boost`, as Boost.Test wrote them.

use std::path::Path;

use rtf_model::ExitStatus;

use super::*;
use crate::case::StartedCase;
use crate::frameworks::recorded::{replay, replay_in_pieces};

/// A reader whose case has started, as the supervisor starts it.
struct Started(Reader, bool);

impl Started {
    fn start(&mut self, cases: &mut CaseReporter<'_>) {
        if !std::mem::replace(&mut self.1, true) {
            let name = self.0.case.clone();
            cases.start(StartedCase { name, ..StartedCase::default() });
        }
    }
}

impl ReportReader for Started {
    fn report(&mut self, bytes: &[u8], cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        self.start(cases);
        self.0.report(bytes, cases)
    }

    fn finish(&mut self, end: ExitStatus, cases: &mut CaseReporter<'_>) -> Result<(), Garbage> {
        self.start(cases);
        self.0.finish(end, cases)
    }
}

fn reader(case: &str, report: &str) -> Started {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/frameworks/boost");
    Started(Reader::new(case.to_owned(), dir.join(report)), false)
}

#[test]
fn everything_in_a_log_arrives() {
    let log = include_bytes!("../fails.log.xml");
    let read = || reader("fails", "fails.report.xml");
    insta::assert_snapshot!(replay_in_pieces(read, log, ExitStatus::Code(200)));
}

#[test]
fn a_signal_that_boost_caught_is_a_crash() {
    let log = include_bytes!("../crashes.log.xml");
    let read = || reader("crashes", "crashes.report.xml");
    insta::assert_snapshot!(replay_in_pieces(read, log, ExitStatus::Code(201)));
}

#[test]
fn without_a_report_the_program_ended_in_the_case() {
    let log = include_bytes!("../fails.log.xml");
    let text = replay(reader("fails", "missing.xml"), log, 4096, ExitStatus::Code(0));
    let text = text.expect("a good log");
    assert!(text.contains("check position == 42") && text.contains("it crashed"), "{text}");
}

#[test]
fn another_document_is_garbage() {
    let read = reader("fails", "fails.report.xml");
    let garbage = replay(read, b"<robots/>", 4096, ExitStatus::Code(0)).unwrap_err();
    assert_eq!(garbage.0, "it begins with `<robots`, not with `<TestLog`");
}

#[test]
fn numbers_are_compared() {
    let numbers = comparison("check position == 42 has failed [41 != 42]").expect("numbers");
    assert_eq!((numbers.got[0], numbers.expected[0]), (Some(41.0), Some(42.0)));
    assert_eq!(comparison("check speed != 2 has failed [2 == 2]"), None);
    assert_eq!(comparison("critical"), None);
}
