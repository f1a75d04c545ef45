//! Reports and lists of other frameworks. The first bytes of an input decide how it arrives; a zero
//! byte separates the report from a file that the program writes at its end.

use std::collections::HashSet;
use std::path::Path;

use rtf_frameworks::foreign::{LISTS, Written, count_listed, read_report};
use rtf_host::Session;
use rtf_model::ExitStatus;
use rtf_model::protocol::Notification;
use rtf_process::codec::{HostMessage, decode};

/// The cases that the process runs: the first, or all.
const CASES: [&str; 2] = ["Arm.moves", "Arm.other"];

macro_rules! targets {
    ($($name:ident),*) => {
        $(
            /// What a program of this framework writes.
            pub fn $name(data: &[u8]) {
                check(stringify!($name), data);
            }
        )*
    };
}

targets!(boost, cargo, catch2, ctest, doctest, go, gtest, junit, rostest, tap);

fn check(framework: &str, data: &[u8]) {
    if LISTS.contains(&framework) {
        let cases = count_listed(framework, data);
        assert!(cases.is_none_or(|cases| cases <= data.len()), "{cases:?} cases");
    }
    let Some(([end, piece], rest)) = data.split_first_chunk() else { return };
    let (report, document) = match rest.iter().position(|byte| *byte == 0) {
        Some(at) => (&rest[..at], &rest[at + 1..]),
        None => (rest, &[][..]),
    };
    let cases = if end / 3 % 2 == 0 { &CASES[..1] } else { &CASES };
    let end = match end % 3 {
        0 => ExitStatus::Code(0),
        1 => ExitStatus::Code(1),
        _ => ExitStatus::Signal(11),
    };
    let scratch = tempfile::tempdir().expect("a directory");
    let in_pieces =
        |piece| run(framework, cases, &Written { document, report, piece, end }, scratch.path());
    let whole = in_pieces(report.len().max(1));
    let pieces = in_pieces(usize::from(piece % 16) + 1);
    if whole.0 && pieces.0 {
        assert_eq!(whole.1, pieces.1, "the size of the pieces matters");
    }
}

/// Whether the report is good, and the notifications without what depends on the size of pieces.
fn run(
    framework: &str,
    cases: &[&str],
    written: &Written<'_>,
    scratch: &Path,
) -> (bool, Vec<String>) {
    let session = Session::without_runner().expect("a session");
    let is_good = read_report(framework, cases, written, &session, scratch);
    let bytes = session.take_sent();
    let lines = bytes.split(|byte| *byte == b'\n').filter(|line| !line.is_empty());
    (is_good.expect("a type with reports"), check_notifications(lines))
}

/// Checks that the runner understands each line, and that each case that starts finishes once.
fn check_notifications<'a>(lines: impl Iterator<Item = &'a [u8]>) -> Vec<String> {
    let (mut open, mut shown) = (HashSet::new(), Vec::new());
    for line in lines {
        let message = decode(line);
        let Ok(HostMessage::Notification(mut notification)) = message else {
            panic!("{message:?}: {}", String::from_utf8_lossy(line))
        };
        match &mut notification {
            Notification::CaseStarted(start) => assert!(open.insert(start.case), "started twice"),
            Notification::CaseFinished { case, duration_us, .. } => {
                assert!(open.remove(case), "a case finished that is not open");
                *duration_us = None;
            }
            _ => {}
        }
        shown.push(format!("{notification:?}"));
    }
    assert!(open.is_empty(), "cases without an end: {open:?}");
    shown
}
