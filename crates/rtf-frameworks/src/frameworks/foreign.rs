//! The parsers of what programs of other frameworks write, without the programs: for tests that
//! give them arbitrary bytes.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use rtf_host::Session;
use rtf_model::{ExitStatus, Outcome};

use super::{boost, catch2, ctest, doctest, gtest, junit};
use crate::case::{CaseResult, ListedCase, Selection};
use crate::case_reporter::CaseReporter;
use crate::framework::{Launch, OpenChannel, ReportReader, TestProgram};
use crate::last_output::OutputStream;
use crate::report_dir;

/// The types whose list of cases [`count_listed`] reads.
pub const LISTS: [&str; 6] = ["boost", "catch2", "ctest", "doctest", "gtest", "junit"];

/// The types whose report [`read_report`] reads.
pub const REPORTS: [&str; 10] =
    ["boost", "cargo", "catch2", "ctest", "doctest", "go", "gtest", "junit", "rostest", "tap"];

/// Reads the list of cases that a program of this type prints, and returns how many there are.
/// `None` if it is no list, or the type has none.
#[must_use]
pub fn count_listed(framework: &str, printed: &[u8]) -> Option<usize> {
    let cases = match framework {
        "boost" => boost::parse_list(&String::from_utf8_lossy(printed)),
        "catch2" => catch2::parse_list(printed),
        "ctest" => {
            ctest::parse_list(printed).ok().map(|tests| tests.iter().map(ctest::listed).collect())
        }
        "doctest" => doctest::parse_list(printed),
        "gtest" => gtest::parse_list(printed, false),
        "junit" => junit::parse_list(printed),
        _ => None,
    };
    cases.map(|cases: Vec<ListedCase>| cases.len())
}

/// What a process of a program wrote, for [`read_report`].
#[derive(Clone, Copy, Debug)]
pub struct Written<'a> {
    /// The file that it wrote at its end; for `CTest` the list of tests, of which it is the first;
    /// for others its standard error.
    pub document: &'a [u8],
    /// The report, or its output for frameworks whose output is the report.
    pub report: &'a [u8],
    /// The size of the pieces in which the report arrives, at least 1.
    pub piece: usize,
    pub end: ExitStatus,
}

/// Reads what a process wrote and sends the notifications to `session`. The process ran these
/// cases, at least one; if the type has a process for each case, the first one. `scratch` is an
/// empty directory. Returns whether the report is as the framework writes it; `None` without such
/// a type.
pub fn read_report(
    framework: &str,
    cases: &[&str],
    written: &Written<'_>,
    session: &Session,
    scratch: &Path,
) -> Option<bool> {
    let (_, adapter) = super::by_name(framework)?;
    let listed = |name: &&str| ListedCase { name: (*name).to_owned(), ..ListedCase::default() };
    let listed: Vec<ListedCase> = cases.iter().map(listed).collect();
    let first = listed.first()?;
    let test = TestProgram { file: PathBuf::from("/tests/program"), args: Vec::new() };
    let cases = Selection { cases: &listed, is_all: false };
    let (channel, wanted, finished) = (OpenChannel::None, &[], &HashMap::new());
    let launch = Launch { test: &test, cases, channel, wanted, finished, scratch };
    let mut reader = match framework {
        "ctest" => ctest::reader_of_first(written.document, &first.name),
        _ => {
            place(framework, scratch, written.document)?;
            adapter.reader(&launch)
        }
    };
    let mut reporter = CaseReporter::new(session);
    reporter.begin_process(&cases);
    if adapter.needs_separate_processes() {
        // The supervisor starts the case.
        reporter.start(first.start());
    }
    let is_good = feed(&mut *reader, written, &mut reporter);
    reporter.end_open(&CaseResult::new(Outcome::Crashed, "it crashed"));
    reporter.end_process();
    Some(is_good)
}

/// Writes the file where the reader expects it.
fn place(framework: &str, scratch: &Path, document: &[u8]) -> Option<()> {
    let file = match framework {
        "boost" | "gtest" => report_dir::results_file(scratch),
        "rostest" => scratch.join("ros/test_results/rostest-fuzz.xml"),
        _ => return Some(()),
    };
    std::fs::create_dir_all(file.parent()?).ok()?;
    std::fs::write(file, document).ok()
}

fn feed(
    reader: &mut dyn ReportReader,
    written: &Written<'_>,
    reporter: &mut CaseReporter<'_>,
) -> bool {
    for piece in written.report.chunks(written.piece) {
        if reader.report(piece, reporter).is_err() {
            return false;
        }
    }
    for piece in written.report.chunks(written.piece) {
        reader.output(OutputStream::Stdout, piece, reporter);
    }
    reader.settle(reporter);
    // Otherwise the size of the pieces would matter: cases are released when nothing arrives.
    if reader.holds_back() {
        reader.release(reporter);
    }
    for piece in written.document.chunks(written.piece) {
        reader.output(OutputStream::Stderr, piece, reporter);
    }
    let is_complete = reader.finish(written.end, reporter).is_ok();
    // A reason is read even if it is not needed.
    let _ = reader.crash_reason();
    is_complete
}
