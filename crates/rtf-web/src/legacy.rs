//! The two routes of robot-testing-framework 2.x, for its clients.

use axum::extract::State;
use rtf_model::{Event, EventKind, MessageKind, Record, SuiteRecord, TestRecord, Verdict};
use rtf_report::journal::parse_event;
use rtf_report::run_dir::LATEST;
use serde::Serialize;

use crate::app::{App, JsonResult};
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

async fn read<T: Serialize>(
    app: App,
    view: impl FnOnce(&Run, &Index) -> Result<T, Problem> + Send + 'static,
) -> JsonResult {
    let runs = app.runs.clone();
    let current = crate::app::blocking(move || Ok(runs.current())).await?;
    app.read(current.unwrap_or_else(|| LATEST.to_owned()), view).await
}

/// The suite that runs or ran last, and its tests.
pub async fn status(State(app): State<App>) -> JsonResult {
    read(app, |_, index| {
        let record = &index.record;
        let suite = last(record);
        let tests = suite.map_or(&[][..], |suite| &suite.tests);
        let tests = tests.iter().filter_map(|id| record.tests.get(id.index())).map(number);
        let name = suite.map(|suite| suite.plan.name.clone()).unwrap_or_default();
        Ok(Status { name, tests: tests.collect() })
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

/// The last lines of what was reported, as HTML in a JSON string.
pub async fn update(State(app): State<App>) -> JsonResult {
    read(app, |run, index| {
        let failed = crate::runs::unreadable;
        let end = index.offset;
        let start = index.positions.at(end.saturating_sub(END));
        let mut lines = LineReader::between(run.journal()?, start, end).map_err(failed)?;
        let mut shown = std::collections::VecDeque::new();
        while let Some(line) = lines.next().map_err(failed)? {
            let event = parse_event(line.text);
            shown.extend(event.ok().and_then(|event| html(&event, &index.record)));
            if shown.len() > LINES {
                shown.pop_front();
            }
        }
        Ok(shown.into_iter().collect::<String>())
    })
    .await
}

fn html(event: &Event, record: &Record) -> Option<String> {
    let title = |text: String| format!("<br> <b>{}</b>", escaped(&text));
    let suite = |id: &rtf_model::SuiteId| {
        record.suites.get(id.index()).map(|suite| suite.plan.name.clone()).unwrap_or_default()
    };
    Some(match &event.kind {
        EventKind::SuiteStarted { suite: id } => {
            title(format!("Test suite {} started...", suite(id)))
        }
        EventKind::SuiteFinished { suite: id } => title(format!("Test suite {} ended", suite(id))),
        EventKind::TestStarted { test, .. } => {
            title(format!("Test case {} started...", record.full_name(*test)))
        }
        EventKind::TestFinished(finished) => {
            let word = if finished.verdict.is_green() { "passed!" } else { "failed!" };
            title(format!("Test case {} {word}", record.full_name(finished.test)))
        }
        EventKind::FixtureCollapsed { fixture, reason, .. } => {
            let name = record.fixture(*fixture).map_or("", |fixture| &fixture.plan.name);
            format!("<br> [ERROR] fixture {} collapsed: {}", escaped(name), escaped(reason))
        }
        EventKind::Message { message, .. } => {
            let word = match message.kind {
                MessageKind::Report | MessageKind::Check => "[INFO]",
                MessageKind::Failure => "[FAIL]",
                MessageKind::Error => "[ERROR]",
            };
            format!("<br> {word} {}", escaped(&message.text))
        }
        _ => return None,
    })
}

/// As text between tags; without characters that JSON would escape as well.
fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out += "&amp;",
            '<' => out += "&lt;",
            '>' => out += "&gt;",
            '"' => out += "&quot;",
            '\'' => out += "&#39;",
            '\\' => out += "&#92;",
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
    fn as_json_it_is_the_same_text_between_quotation_marks() {
        let hostile = "\"><script>alert('\\')</script>\u{0}\u{1b}[31m\n&amp; 🤖";
        let html = escaped(hostile);
        assert_eq!(serde_json::to_string(&html).unwrap(), format!("\"{html}\""));
        assert!(!html.contains("<script"));
    }
}
