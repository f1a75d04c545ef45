//! How each verdict counts: one table, with which console, JUnit, TAP and the colour of the
//! run must agree.

use junit_parser::TestStatus;
use rtf_model::{Event, EventKind, Record};
use rtf_report::Reporter;
use rtf_report::console::Console;
use rtf_report::console::ConsoleOptions;

use crate::support::*;

const STREAM: &str = "known-failures";
const TABLE: &str = include_str!("../golden/verdicts.txt");

/// A row of the table.
struct Row {
    test: &'static str,
    is_green: bool,
    console: &'static str,
    junit: &'static str,
    tap: &'static str,
}

fn rows() -> Vec<Row> {
    let lines = TABLE.lines().filter(|line| !line.starts_with('#'));
    let row = |line: &'static str| {
        let columns: Vec<_> = line.split_whitespace().collect();
        let [test, exit, console, junit, tap] = columns[..] else { panic!("{line}") };
        Row { test, is_green: exit == "0", console, junit, tap }
    };
    lines.map(row).collect()
}

/// Numbers of JUnit test cases, failures, errors and skips.
pub fn totals() -> (u64, u64, u64, u64) {
    let rows = rows();
    let count = |junit: &str| rows.iter().filter(|row| row.junit == junit).count() as u64;
    (rows.len() as u64, count("failure"), count("error"), count("skipped"))
}

#[test]
fn the_table_has_every_test() {
    let record = record(STREAM);
    let names: Vec<_> = record.tests.iter().map(|test| test.plan.name.as_str()).collect();
    assert_eq!(rows().iter().map(|row| row.test).collect::<Vec<_>>(), names);
}

#[test]
fn the_run_is_as_green_as_its_only_test() {
    let all = record(STREAM);
    for (row, test) in rows().iter().zip(&all.tests) {
        let mut one = all.clone();
        one.tests = vec![test.clone()];
        assert_eq!(one.is_green(), row.is_green, "{}", row.test);
    }
}

#[test]
fn console() {
    let text = console_of(ConsoleOptions::default());
    let (live, summary) = text.split_once("tests that did not pass:").unwrap();
    let (failed, rest) = summary.split_once("\ntests that passed although").unwrap();
    let (unexpected, known) = rest.split_once("\nknown failures").unwrap();
    for Row { test, is_green, console, .. } in rows() {
        let end = format!(" s  arm/{test}");
        let line = live.lines().find(|line| line.ends_with(&end)).unwrap();
        assert_eq!(line.split_whitespace().next(), Some(console), "{test}: {line}");
        let is_in =
            |part: &str| part.lines().any(|line| line.trim_end() == format!("  arm/{test}"));
        let begins = |part: &str| part.contains(&format!("  arm/{test}  "));
        assert_eq!(begins(failed) || is_in(unexpected), !is_green, "{test}: the summary");
        let is_known = matches!(console, "expected" | "quarantined");
        assert_eq!(begins(known), is_known, "{test}: the known failures");
    }
}

fn console_of(options: ConsoleOptions) -> String {
    let text = crate::support::console(STREAM, options);
    anstream::adapter::strip_str(&text).to_string()
}

#[test]
fn junit() {
    let xml = crate::support::junit(STREAM);
    let suites = junit_parser::from_reader(xml.as_bytes()).unwrap();
    let cases: Vec<_> = suites.suites.iter().flat_map(|suite| &suite.cases).collect();
    for Row { test, junit, .. } in rows() {
        let is_of_test = |case: &&&junit_parser::TestCase| match test.starts_with("case-") {
            true => case.classname.as_deref() == Some(&format!("arm.{test}")),
            false => case.original_name == test,
        };
        let [case] = cases.iter().filter(is_of_test).collect::<Vec<_>>()[..] else {
            panic!("{test} has not one test case")
        };
        let found = match &case.status {
            TestStatus::Success => "success",
            TestStatus::Failure(_) => "failure",
            TestStatus::Error(_) => "error",
            TestStatus::Skipped(_) => "skipped",
        };
        assert_eq!(found, junit, "{test}");
    }
}

#[test]
fn tap() {
    let mut report = Vec::new();
    rtf_report::tap::write(&mut report, &record(STREAM)).unwrap();
    let report = String::from_utf8(report).unwrap();
    for (number, row) in (1..).zip(rows()) {
        let Row { test, tap, .. } = row;
        let ok = if tap.starts_with("not") { "not ok" } else { "ok" };
        let start = format!("    {ok} {number} - {test}");
        let line = report.lines().find(|line| {
            line.strip_prefix(&start).is_some_and(|rest| rest.is_empty() || rest.starts_with(' '))
        });
        let line = line.unwrap_or_else(|| panic!("{test} is not `{ok}`"));
        assert_eq!(line.contains(" # TODO "), tap.ends_with("todo"), "{line}");
        assert_eq!(line.contains(" # SKIP "), tap.ends_with("skip"), "{line}");
    }
}

/// The stream in which a test or a case that skips itself makes the run red.
fn events_with_failing_skips() -> Vec<Event> {
    let mut events = events(STREAM).0;
    for event in &mut events {
        if let EventKind::SuitePlanned(suite) = &mut event.kind {
            suite.skips_fail = true;
        }
    }
    events
}

#[test]
fn a_skip_that_fails_is_red_in_every_report() {
    let (mut record, paper) = (Record::default(), Paper::default());
    let mut console = Console::new(Box::new(paper.clone()), ConsoleOptions::default());
    for event in &events_with_failing_skips() {
        record.apply(event);
        console.event(event, &record).unwrap();
    }
    console.finish(&record).unwrap();
    let console = anstream::adapter::strip_str(&paper.text()).to_string();
    let (mut junit, mut tap, mut github) = (Vec::new(), Vec::new(), Vec::new());
    rtf_report::junit::write(&mut junit, &record, None).unwrap();
    rtf_report::tap::write(&mut tap, &record).unwrap();
    rtf_report::github::write(&mut github, &record, None).unwrap();
    let junit = junit_parser::from_reader(junit.as_slice()).unwrap();
    let (_, failures, errors, skipped) = totals();
    // One skipped case, and a skipped test with each of the four marks.
    let counts = (junit.failures, junit.errors, junit.skipped);
    assert_eq!(counts, (failures + 5, errors, skipped - 5));
    let (tap, github) = (String::from_utf8(tap).unwrap(), String::from_utf8(github).unwrap());
    for mark in ["case", "expected", "quarantined", "expired", "listed"] {
        let test = format!("{mark}-skipped");
        let has = |report: &str, start: &str, name: &str| {
            report.lines().any(|line| line.starts_with(start) && line.contains(name))
        };
        assert!(has(&tap, "    not ok", &format!(" - {test}")), "{test}: {tap}");
        assert!(has(&github, "::error", &format!("title=arm/{test} ")), "{test}: {github}");
        let summary = console.split_once("tests that did not pass:").unwrap().1;
        assert!(has(summary, "  arm/", &format!("{test}  ")), "{test}: {summary}");
    }
}
