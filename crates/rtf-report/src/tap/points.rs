//! Test points and what stands below them.

use rtf_model::{Location, Record, Significance, SuiteRecord, TestRecord, Verdict};

use super::cases;
use super::syntax::{SUBTEST, description, severity};
use super::yaml::Yaml;
use crate::cases::TestCases;
use crate::explain::{self, Extent, Sink};
use crate::{known_failure, words};

/// Maximum number of output lines.
const OUTPUT_LINES: usize = 50;

/// The point of a test, in its suite's subtest.
pub(super) fn test(text: &mut String, number: usize, record: &Record, test: &TestRecord) {
    let verdict = test.final_verdict();
    let indent = " ".repeat(SUBTEST);
    let name = description(&test.plan.name);
    let cases = TestCases::of(test);
    if let Some(cases) = &cases {
        cases::subtest(text, record, test, cases);
    }
    let red_reason = known_failure::red_reason(record, test);
    if verdict == Verdict::Skipped && red_reason.is_none() {
        let unspoken = match test.significance() {
            Significance::SkippedItself => "",
            _ => "the run ended before the test started",
        };
        let reason = test.reason().unwrap_or(unspoken);
        let line = format!("{indent}ok {number} - {name} # SKIP {}", description(reason));
        *text += line.trim_end();
        text.push('\n');
        return;
    }
    let is_known = known_failure::is_known(test);
    let is_ok = verdict.is_green() && red_reason.is_none();
    let ok = if is_ok { "ok" } else { "not ok" };
    let todo = match is_known {
        true => format!(" # TODO {}", description(&known_failure::describe(test))),
        false => String::new(),
    };
    *text += &format!("{indent}{ok} {number} - {name}{todo}\n");
    let mut yaml = Yaml::new(text, SUBTEST);
    yaml.duration(test.duration());
    if let Some(reason) = &red_reason {
        yaml.problem(verdict, "fail", reason);
    } else if !verdict.is_green() {
        explained(&mut yaml, test, verdict);
    }
    if let Some(cases) = &cases {
        yaml.text("cases", &cases.totals().describe());
    }
    let measurements = test.deciding_attempts().flat_map(|attempt| &attempt.measurements);
    // The others are among the details.
    let good = measurements.filter(|measurement| measurement.is_within_limits());
    yaml.lines("measurements", good.map(explain::measurement));
    let series = test.deciding_attempts().flat_map(|attempt| &attempt.series);
    yaml.lines("series", series.filter(|series| series.outside == 0).map(explain::series));
    yaml.end();
}

fn explained(yaml: &mut Yaml<'_>, test: &TestRecord, verdict: Verdict) {
    let unspoken = "the run ended before the test did";
    let is_over = test.verdict().is_some();
    let reason = if is_over { test.reason().unwrap_or_default() } else { unspoken };
    yaml.problem(verdict, severity(verdict), reason);
    let Some(attempt) = test.decisive_attempt() else { return };
    let failures = explain::own_failures(attempt).chain(attempt.failures());
    let mut locations = failures.filter_map(|failure| failure.location.as_ref());
    if let Some(Location { file, line }) = locations.next() {
        yaml.place(file, *line);
    }
    if test.plan.is_repeated() {
        yaml.number("repetition", f64::from(attempt.repetition));
    }
    let explained = |sink: Sink<'_>| explain::attempt(attempt, Extent::ALL, sink);
    yaml.lines("details", explain::lines(explained));
    let (tail, total) = words::tail(&attempt.output, OUTPUT_LINES);
    let cut = (total > OUTPUT_LINES).then(|| format!("… the last {OUTPUT_LINES} of {total} lines"));
    yaml.lines("output", cut.into_iter().chain(tail.map(str::to_owned)));
}

/// The point of a suite, after its subtest: whether all in it is well.
pub(super) fn suite(text: &mut String, number: usize, record: &Record, suite: &SuiteRecord) {
    let tests = || suite.tests.iter().filter_map(|id| record.tests.get(id.index()));
    let problems = record.suite_problems(suite.plan.suite);
    let passed = tests().filter(|test| test.final_verdict().is_green()).count();
    let total = tests().count();
    let are_green = tests().all(|test| record.is_test_green(test));
    let well = suite.finished.is_some() && are_green && problems.is_empty();
    let ok = if well { "ok" } else { "not ok" };
    *text += &format!("{ok} {number} - {}\n", description(&suite.plan.name));
    let mut yaml = Yaml::new(text, 0);
    if let Some(started) = suite.started {
        let end = suite.finished.unwrap_or(record.last_at);
        yaml.duration(end.since(started));
    }
    if !well {
        let total = words::count(total as u64, "test");
        yaml.text("message", &format!("{passed} of {total} passed"));
        yaml.lines("problems", problems);
    }
    yaml.end();
}
