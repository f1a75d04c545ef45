//! The two routes of robot-testing-framework 2.x, for its clients.

use std::collections::VecDeque;

use axum::extract::State;
use axum::http::{HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use rtf_model::{
    Event, EventKind, MessageKind, Record, Source, SuiteId, SuiteRecord, TestFinished, TestRecord,
    Verdict,
};
use rtf_report::journal::parse_event;
use rtf_report::run_dir::LATEST;
use serde::Serialize;

use crate::app::App;
use crate::index::{Index, LineReader};
use crate::problem::Problem;
use crate::runs::Run;

/// How many lines of the log are answered.
const LINES: usize = 500;
/// In how much of the journal's end they are looked for.
const END: u64 = 512 * 1024;

#[derive(Serialize)]
struct Status {
    name: String,
    #[serde(rename = "testStatus")]
    tests: Vec<u8>,
}

/// A line with the type and the end that it had: programs strip one character of it, which
/// was the `\r` of its chunk.
#[derive(Debug)]
pub struct Line(String);

impl IntoResponse for Line {
    fn into_response(self) -> Response {
        let kind = HeaderValue::from_static("text/turtle");
        ([(header::CONTENT_TYPE, kind)], self.0 + "\r\n").into_response()
    }
}

async fn read(
    app: App,
    view: impl FnOnce(&Run, &Index) -> Result<String, Problem> + Send + 'static,
) -> Result<Line, Problem> {
    let runs = app.runs.clone();
    let current = crate::app::blocking(move || Ok(runs.current())).await?;
    let current = current.unwrap_or_else(|| LATEST.to_owned());
    app.with_run(current, move |run| Ok(Line(view(run, &*run.read()?)?))).await
}

/// The suite that runs or ran last, and its tests.
pub async fn status(State(app): State<App>) -> Result<Line, Problem> {
    read(app, |_, index| {
        let record = &index.record;
        let suite = last(record);
        let tests = suite.map_or(&[][..], |suite| &suite.tests);
        let tests = tests.iter().filter_map(|id| record.tests.get(id.index())).map(number);
        let name = suite.map(|suite| suite.plan.name.clone()).unwrap_or_default();
        let status = Status { name, tests: tests.collect() };
        let failed = StatusCode::INTERNAL_SERVER_ERROR;
        serde_json::to_string(&status).map_err(|error| Problem::new(failed, error.to_string()))
    })
    .await
}

fn last(record: &Record) -> Option<&SuiteRecord> {
    let started = record.suites.iter().filter(|suite| suite.started.is_some());
    started.max_by_key(|suite| suite.started).or(record.suites.first())
}

/// 0 pending, 1 running, 2 did not pass, 3 passed.
fn number(test: &TestRecord) -> u8 {
    match test.verdict() {
        Some(Verdict::Passed) => 3,
        Some(_) => 2,
        None if test.is_running() => 1,
        None => 0,
    }
}

/// The last lines of what was reported, as HTML.
pub async fn update(State(app): State<App>) -> Result<Line, Problem> {
    read(app, |run, index| {
        let failed = crate::runs::unreadable;
        let end = index.offset;
        let start = index.positions.at(end.saturating_sub(END));
        let mut lines = LineReader::between(run.journal()?, start, end).map_err(failed)?;
        let mut shown = VecDeque::new();
        while let Some(line) = lines.next().map_err(failed)? {
            let event = parse_event(line.text);
            shown.extend(event.ok().and_then(|event| html(&event, &index.record)));
            if shown.len() > LINES {
                shown.pop_front();
            }
        }
        Ok(shown.into_iter().collect())
    })
    .await
}

/// The line of an event.
fn html(event: &Event, record: &Record) -> Option<String> {
    let suite = |id: SuiteId| record.suites.get(id.index()).map_or("", |it| &it.plan.name);
    let test = |id| name(record, Source::Test(id));
    Some(match &event.kind {
        EventKind::RunStarted(_) => title("Starting test runner."),
        EventKind::RunFinished { .. } => title("Ending test runner."),
        EventKind::SuiteStarted { suite: id } => {
            title(&format!("Test suite {} started...", suite(*id)))
        }
        EventKind::SuiteFinished { suite: id } => {
            let word = word(suite_passed(record, *id));
            title(&format!("Test suite {} {word}", suite(*id)))
        }
        EventKind::TestStarted { test: id, .. } => {
            title(&format!("Test case {} started...", test(*id)))
        }
        EventKind::TestFinished(finished) => ended(test(finished.test), finished),
        EventKind::FixtureCollapsed { fixture, reason, .. } => {
            problem(name(record, Source::Fixture(*fixture)), &format!("collapsed : {reason}"))
        }
        EventKind::Message { source, message, .. } => {
            let about = name(record, *source);
            match message.kind {
                MessageKind::Report => said(GREEN, "INFO", about, &["reports", &message.text]),
                MessageKind::Check => said(GREEN, "INFO", about, &["checks", &message.text]),
                MessageKind::Failure => said(RED, "FAIL", about, &["checks", &message.text]),
                MessageKind::Error => problem(about, &message.text),
            }
        }
        _ => return None,
    })
}

/// The end of an attempt, with its reason unless the test reported it.
fn ended(test: &str, finished: &TestFinished) -> String {
    let end = title(&format!("Test case {test} {}", word(finished.verdict.is_green())));
    let reported = [Verdict::Passed, Verdict::Skipped, Verdict::Failed, Verdict::Error];
    if reported.contains(&finished.verdict) {
        return end;
    }
    let reason = finished.reason.as_deref().unwrap_or_default();
    problem(test, &format!("{} : {reason}", finished.verdict)) + &end
}

fn word(passed: bool) -> &'static str {
    if passed { "passed!" } else { "failed!" }
}

fn suite_passed(record: &Record, id: SuiteId) -> bool {
    let mut tests = record.tests.iter().filter(|test| test.plan.suite == id);
    tests.all(|test| record.is_test_green(test)) && record.suite_problems(id).is_empty()
}

fn name(record: &Record, source: Source) -> &str {
    let name = match source {
        Source::Test(id) => record.tests.get(id.index()).map(|test| &test.plan.name),
        Source::Fixture(id) => record.fixture(id).map(|fixture| &fixture.plan.name),
        Source::Hook(id) => record.hooks.get(id.index()).map(|hook| &hook.plan.name),
    };
    name.map_or("", String::as_str)
}

const BLUE: &str = "blue";
const GREEN: &str = "green";
const RED: &str = "red";

fn bold(colour: &str, html: &str) -> String {
    format!("<font color=\"{colour}\"><b>{html}</b></font>")
}

fn title(text: &str) -> String {
    format!("<br> {}", bold(BLUE, &format!(" {} ", escaped(text))))
}

fn problem(about: &str, text: &str) -> String {
    said(RED, "ERROR", about, &[text])
}

/// `[INFO]  (about) reports : text.`
fn said(colour: &str, word: &str, about: &str, parts: &[&str]) -> String {
    // The texts are in one column.
    let blanks = "&nbsp;".repeat(6 - word.len());
    let word = bold(colour, &format!("[{word}]{blanks}"));
    format!("<br> {word} ({}) {}.", escaped(about), escaped(&parts.join(" : ")))
}

/// As text between tags.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&apos;",
            '\n' => out += "<br>",
            c if c.is_control() => out.push('\u{FFFD}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_is_text_in_a_line_of_its_own() {
        let hostile = "\"><script>alert('\\')</script>\u{1b}[31m\n&amp; 🤖";
        assert_eq!(
            said(RED, "FAIL", "<arm>", &["checks", hostile]),
            "<br> <font color=\"red\"><b>[FAIL]&nbsp;&nbsp;</b></font> (&lt;arm&gt;) checks : \
             &quot;&gt;&lt;script&gt;alert(&apos;\\&apos;)&lt;/script&gt;\u{FFFD}[31m<br>&amp;amp; 🤖."
        );
    }
}
