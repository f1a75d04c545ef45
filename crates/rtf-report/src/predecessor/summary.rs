//! The block of counts at the end.

use rtf_model::{Record, SuiteId, SuiteRecord, TestId};

use crate::words;

/// Whether it is a suite of a file: plug-ins of the command line are gathered
/// in one that the predecessor did not know.
pub(super) fn is_suite(suite: &SuiteRecord) -> bool {
    !suite.plan.file.is_empty()
}

/// Whether a suite has tests, all of them passed, and nothing else was wrong with it.
pub(super) fn suite_passed(record: &Record, id: SuiteId) -> bool {
    let tests = record.suites.get(id.index()).map_or(&[][..], |suite| &suite.tests);
    !tests.is_empty()
        && tests.iter().all(|id| is_green(record, *id))
        && record.suite_problems(id).is_empty()
}

fn is_green(record: &Record, id: TestId) -> bool {
    record.tests.get(id.index()).is_some_and(|test| record.is_test_green(test))
}

/// The block, with an empty line before it.
pub(super) fn of(record: &Record, title: &str) -> String {
    let mut block = format!("\n---------- {title} -----------\n");
    block.extend(words::damage(record).map(|damage| damage + "\n"));
    let suites: Vec<_> = record.suites.iter().filter(|suite| is_suite(suite)).collect();
    if !suites.is_empty() {
        let passed = suites.iter().filter(|s| suite_passed(record, s.plan.suite)).count();
        block += &counts("suites", suites.len(), passed);
    }
    let passed = record.tests.iter().filter(|test| record.is_test_green(test)).count();
    block + &counts("cases", record.tests.len(), passed)
}

fn counts(what: &str, total: usize, passed: usize) -> String {
    let line = |label: &str, number: usize| format!("{label:<28} : {number}\n");
    line(&format!("Total number of test {what}"), total)
        + &line(&format!("Number of passed test {what}"), passed)
        + &line(&format!("Number of failed test {what}"), total - passed)
}
