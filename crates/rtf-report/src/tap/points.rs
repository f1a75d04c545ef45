//! Test points and what stands below them.

use std::time::Duration;

use rtf_model::{Location, Record, SuiteRecord, TestRecord, Verdict};

use super::yaml::Yaml;
use crate::explain::{self, Extent};
use crate::{escape, words};

/// A subtest is written four columns further in than its parent.
const SUBTEST: usize = 4;

/// Maximum number of output lines.
const OUTPUT_LINES: usize = 50;

/// The point of a test, in its suite's subtest.
pub(super) fn test(text: &mut String, number: usize, test: &TestRecord) {
    let verdict = test.final_verdict();
    let indent = " ".repeat(SUBTEST);
    let name = description(&test.plan.name);
    if verdict == Verdict::Skipped {
        let unspoken = "the run ended before the test started";
        let reason = test.reason().unwrap_or(unspoken);
        *text += &format!("{indent}ok {number} - {name} # SKIP {}\n", description(reason));
        return;
    }
    let ok = if verdict.is_green() { "ok" } else { "not ok" };
    *text += &format!("{indent}{ok} {number} - {name}\n");
    let mut yaml = Yaml::new(text, SUBTEST);
    yaml.number("duration_ms", millis(test.duration()));
    if !verdict.is_green() {
        explained(&mut yaml, test, verdict);
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
    yaml.text("verdict", verdict.as_str());
    yaml.text("severity", if verdict == Verdict::Failed { "fail" } else { "error" });
    yaml.text(
        "message",
        if test.verdict().is_some() { test.reason().unwrap_or_default() } else { unspoken },
    );
    let Some(attempt) = test.decisive_attempt() else { return };
    let mut locations = attempt.failures().filter_map(|failure| failure.location.as_ref());
    if let Some(Location { file, line }) = locations.next() {
        yaml.place(file, *line);
    }
    if test.plan.is_repeated() {
        yaml.number("repetition", f64::from(attempt.repetition));
    }
    let mut lines = Vec::new();
    explain::explain(attempt, Extent::ALL, &mut |_, line| lines.push(line.to_owned()));
    explain::left(&attempt.leaked, &mut |_, line| lines.push(line.to_owned()));
    yaml.lines("details", lines);
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
    let well = suite.finished.is_some() && passed == total && problems.is_empty();
    let ok = if well { "ok" } else { "not ok" };
    *text += &format!("{ok} {number} - {}\n", description(&suite.plan.name));
    let mut yaml = Yaml::new(text, 0);
    if let Some(started) = suite.started {
        let end = suite.finished.unwrap_or(record.last_at);
        yaml.number("duration_ms", millis(end.since(started)));
    }
    if !well {
        let total = words::count(total as u64, "test");
        yaml.text("message", &format!("{passed} of {total} passed"));
        yaml.lines("problems", problems);
    }
    yaml.end();
}

fn millis(duration: Duration) -> f64 {
    duration.as_micros() as f64 / 1000.0
}

/// One line in which `#` does not begin a directive.
fn description(text: &str) -> String {
    escape::line(text).replace('\\', "\\\\").replace('#', "\\#")
}
