//! Problems of a run outside its tests, as additional cases.

use quick_junit::{NonSuccessKind, TestCase, TestCaseStatus, TestSuite};
use rtf_model::{FixtureRecord, Record, SuiteRecord};

use super::{described, first_line, text};
use crate::explain::{self, Tone};
use crate::finding;

/// The case of a fixture, when something went wrong with it.
pub(super) fn of_fixture(
    record: &Record,
    suite: &SuiteRecord,
    fixture: &FixtureRecord,
) -> Option<TestCase> {
    let problems = fixture.problems(suite.plan.tolerates_collapse);
    let first = problems.first()?;
    let lines = explain::lines(|sink| {
        problems.iter().for_each(|problem| sink(Tone::Bad, &text(problem)));
        fixture.messages.iter().for_each(|message| explain::message(message, sink));
        explain::left(&fixture.leaked, sink);
        explain::printed(fixture.log_tail.iter().map(String::as_str), sink);
    });
    let status = TestCaseStatus::non_success(NonSuccessKind::Error);
    let status = described(status, "fixture", first_line(first), lines.join("\n"));
    let mut case = TestCase::new(text(&format!("fixture {}", fixture.plan.name)), status);
    case.set_classname(text(&suite.plan.name));
    case.timestamp = fixture.started.and_then(|at| super::time::at(record, at));
    Some(case)
}

/// A separate suite for problems of the run as a whole.
pub(super) fn of_run(record: &Record) -> Option<TestSuite> {
    let problem = finding::run_problem(record)?;
    let mut status = TestCaseStatus::non_success(NonSuccessKind::Error);
    status.set_message(text(&problem));
    status.set_type("run");
    if !record.leaked.is_empty() || record.is_damaged() {
        let mut lines = vec![text(&problem)];
        lines.extend(record.damages.iter().map(|damage| text(&damage.to_string())));
        explain::left(&record.leaked, &mut |_, line| lines.push(line.to_owned()));
        status.set_description(lines.join("\n"));
    }
    let mut case = TestCase::new("run", status);
    case.set_classname("rtf");
    let mut suite = TestSuite::new("rtf");
    suite.add_test_case(case);
    Some(suite)
}
