//! Reports of the corpus in `tests/frameworks/doctest`, as the framework wrote them.
//! The reader of Catch2 has the same tests: sharing them would not be shorter.

use rtf_model::ExitStatus;

use super::Reader;
use crate::frameworks::recorded::{replay, replay_in_pieces};

const SIGSEGV: ExitStatus = ExitStatus::Signal(11);

fn reader() -> Reader {
    Reader::new(&[])
}

#[test]
fn everything_in_a_report_arrives() {
    let report = include_bytes!("../recorded.xml");
    insta::assert_snapshot!(replay_in_pieces(reader, report, ExitStatus::Code(1)));
}

#[test]
fn a_case_with_a_fatal_signal_stays_open() {
    let report = include_bytes!("../crashed.xml");
    insta::assert_snapshot!(replay_in_pieces(reader, report, SIGSEGV));
}

#[test]
fn every_part_of_a_report_is_accepted_after_a_crash() {
    let report = include_bytes!("../recorded.xml");
    for end in (0..report.len()).step_by(13) {
        let text = replay(reader(), &report[..end], 4096, SIGSEGV).expect("a good report");
        let count = |method: &str| text.matches(method).count();
        assert_eq!(count("case-started"), count("case-finished"), "the first {end} bytes");
    }
}

#[test]
fn a_report_without_its_end_is_an_error() {
    let report = "<doctest>\n";
    let text = replay(reader(), report.as_bytes(), 4096, ExitStatus::Code(0)).expect("a report");
    assert!(text.contains("the report of the program is incomplete"), "{text}");
}

#[test]
fn another_document_is_garbage() {
    let garbage = replay(reader(), b"<robots/>", 4096, ExitStatus::Code(0)).unwrap_err();
    assert_eq!(garbage.0, "it begins with `<robots`, not with `<doctest`");
}
