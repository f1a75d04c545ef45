//! The messages, measurements and output of one attempt of a test, start of a fixture
//! or run of a hook. They are read from the journal, page by page.

use std::ops::ControlFlow;

use axum::extract::State;
use rtf_model::{Event, EventKind, FixtureId, HookId, MessageKind, Source, TestId};
use rtf_report::journal::{EventHeader, parse_event};
use serde::Deserialize;
use utoipa::IntoParams;

use super::problems::Problems;
use super::query::{At, Number, PageQuery, QueryParams, values};
use crate::address;
use crate::app::{App, JsonResult, JsonText};
use crate::index::LineReader;
use crate::problem::Problem;
use crate::runs::{Run, unreadable};
use crate::views::{
    Attached, Attachments, Measured, Measurements, Messages, OutputPage, Printed, Said, Stack,
    Stacks,
};

/// Maximum text per page in bytes, apart from its last entry.
const PAGE_BYTES: usize = 1 << 20;

pub(super) type Path3 = At<(String, u32, u32)>;

/// Which part of the journal, and which page of it.
pub(super) struct DetailQuery {
    pub(super) source: Source,
    pub(super) number: u32,
    pub(super) kind: &'static str,
    pub(super) page: PageQuery,
}

/// In place of a kind of event: the starts and ends of questions.
const QUESTION: &str = "question";

impl DetailQuery {
    /// The questions of an attempt of a test.
    pub(super) fn questions_of(source: Source, number: u32) -> Self {
        Self { source, number, kind: QUESTION, page: PageQuery { after: None, limit: None } }
    }

    /// The entries of the page, and the number after which the next one starts.
    fn read<T>(
        &self,
        run: &Run,
        mut pick: impl FnMut(Event) -> Option<T>,
    ) -> Result<(Vec<T>, Option<u64>), Problem> {
        let limit = self.page.limit()?;
        let (mut entries, mut bytes, mut last, mut next) = (Vec::new(), 0, 0, None);
        self.each(run, |event, length| {
            let seq = event.seq;
            let Some(entry) = pick(event) else { return ControlFlow::Continue(()) };
            if entries.len() >= limit || bytes >= PAGE_BYTES {
                next = Some(last);
                return ControlFlow::Break(());
            }
            entries.push(entry);
            bytes += length;
            last = seq;
            ControlFlow::Continue(())
        })?;
        Ok((entries, next))
    }

    /// Visits the entries of all pages from this one on, each with its length, until `visit`
    /// breaks.
    pub(super) fn each(
        &self,
        run: &Run,
        mut visit: impl FnMut(Event, usize) -> ControlFlow<()>,
    ) -> Result<(), Problem> {
        let mut lines = self.lines(run)?;
        while let Some(line) = lines.next().map_err(unreadable)? {
            let Ok(header) = serde_json::from_slice::<EventHeader>(line.text) else { continue };
            let is_before = self.page.after.is_some_and(|Number(after)| header.seq <= after);
            if !is_before
                && self.wants(&header)
                && let Ok(event) = parse_event(line.text)
                && visit(event, line.text.len()).is_break()
            {
                break;
            }
        }
        Ok(())
    }

    fn wants(&self, header: &EventHeader) -> bool {
        let source = match self.kind {
            QUESTION => header.questioner(),
            kind => header.detail_source().filter(|_| *header.kind == *kind),
        };
        source == Some(self.source)
    }

    fn lines(&self, run: &Run) -> Result<LineReader, Problem> {
        let index = run.read()?;
        let Some(place) = index.positions.of(self.source, self.number) else {
            let (what, id) = match self.source {
                Source::Test(id) => ("attempt", format!("test {id}")),
                Source::Fixture(id) => ("start", format!("fixture {id}")),
                Source::Hook(id) => ("run", format!("hook {id}")),
            };
            let number = self.number;
            return Err(Problem::not_found(format!("there is no {what} {number} of {id}")));
        };
        let known = self.page.after.map_or(0, |Number(after)| index.positions.before(after));
        let end = place.end.unwrap_or(index.offset);
        let start = place.start.max(known);
        drop(index);
        LineReader::between(run.journal()?, start, end).map_err(unreadable)
    }
}

/// Which messages.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct Kinds {
    /// Only these kinds, separated by commas: `report`, `check`, `failure`, `error`.
    #[param(pattern = "^(report|check|failure|error)(,(report|check|failure|error))*$")]
    kind: Option<String>,
    /// The `next` of the page before.
    #[param(value_type = Option<u64>, maximum = 9_007_199_254_740_991_i64)]
    after: Option<Number>,
    /// How many entries at most.
    #[param(minimum = 1, maximum = 1000, default = 100)]
    limit: Option<usize>,
}

/// The kinds of messages.
const KINDS: [(&str, MessageKind); 4] = [
    ("report", MessageKind::Report),
    ("check", MessageKind::Check),
    ("failure", MessageKind::Failure),
    ("error", MessageKind::Error),
];

async fn messages(
    app: App,
    run: String,
    (source, number): (Source, u32),
    kinds: Kinds,
) -> JsonResult {
    let page = PageQuery { after: kinds.after, limit: kinds.limit };
    let part = DetailQuery { source, number, kind: "message", page };
    let wanted = kinds.kind.map(|list| values("kind", &list, &KINDS)).transpose()?;
    app.with_run(run, move |run| {
        let (messages, next) = part.read(run, |event| {
            let EventKind::Message { message, .. } = event.kind else { return None };
            let is_wanted = wanted.as_ref().is_none_or(|list| list.contains(&message.kind));
            is_wanted.then_some(Said { seq: event.seq, at: event.at.0, message })
        })?;
        JsonText::of(&Messages { messages, next })
    })
    .await
}

/// What an attempt of a test reported.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/messages", tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), Kinds),
    responses((status = 200, body = Messages), Problems))]
pub async fn test_messages(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(kinds): QueryParams<Kinds>,
) -> JsonResult {
    messages(app, run, (Source::Test(TestId(test)), number), kinds).await
}

/// What a fixture reported after one of its starts.
#[utoipa::path(get, path = "/runs/{run}/fixtures/{fixture}/starts/{number}/messages",
    tag = "details",
    params(("run" = String, Path), ("fixture" = u32, Path), ("number" = u32, Path), Kinds),
    responses((status = 200, body = Messages), Problems))]
pub async fn fixture_messages(
    State(app): State<App>,
    At((run, fixture, number)): Path3,
    QueryParams(kinds): QueryParams<Kinds>,
) -> JsonResult {
    messages(app, run, (Source::Fixture(FixtureId(fixture)), number), kinds).await
}

/// What a run of a hook reported.
#[utoipa::path(get, path = "/runs/{run}/hooks/{hook}/runs/{number}/messages", tag = "details",
    params(("run" = String, Path), ("hook" = u32, Path), ("number" = u32, Path), Kinds),
    responses((status = 200, body = Messages), Problems))]
pub async fn hook_messages(
    State(app): State<App>,
    At((run, hook, number)): Path3,
    QueryParams(kinds): QueryParams<Kinds>,
) -> JsonResult {
    messages(app, run, (Source::Hook(HookId(hook)), number), kinds).await
}

/// What an attempt of a test measured.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/measurements",
    tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), PageQuery),
    responses((status = 200, body = Measurements), Problems))]
pub async fn measurements(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(page): QueryParams<PageQuery>,
) -> JsonResult {
    let part = DetailQuery { source: Source::Test(TestId(test)), number, kind: "measured", page };
    app.with_run(run, move |run| {
        let (measurements, next) = part.read(run, |event| {
            let EventKind::Measured { measurement, .. } = event.kind else { return None };
            Some(Measured::of(event.seq, event.at.0, measurement))
        })?;
        JsonText::of(&Measurements { measurements, next })
    })
    .await
}

/// What an attempt of a test attached.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/attachments",
    tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), PageQuery),
    responses((status = 200, body = Attachments), Problems))]
pub async fn attachments(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(page): QueryParams<PageQuery>,
) -> JsonResult {
    let part = DetailQuery { source: Source::Test(TestId(test)), number, kind: "attached", page };
    app.with_run(run, move |run| {
        let (attachments, next) = part.read(run, |event| {
            let EventKind::Attached { attachment, .. } = event.kind else { return None };
            let url = address::file(&run.name, &attachment.path);
            Some(Attached { seq: event.seq, at: event.at.0, attachment, url })
        })?;
        JsonText::of(&Attachments { attachments, next })
    })
    .await
}

/// The stack dumps of an attempt that was killed.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/stacks", tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), PageQuery),
    responses((status = 200, body = Stacks), Problems))]
pub async fn stacks(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(page): QueryParams<PageQuery>,
) -> JsonResult {
    let part =
        DetailQuery { source: Source::Test(TestId(test)), number, kind: "stack-dumped", page };
    app.with_run(run, move |run| {
        let (stacks, next) = part.read(run, |event| {
            let EventKind::StackDumped { text, .. } = event.kind else { return None };
            Some(Stack { seq: event.seq, at: event.at.0, text })
        })?;
        JsonText::of(&Stacks { stacks, next })
    })
    .await
}

async fn output(
    app: App,
    run: String,
    (source, number): (Source, u32),
    page: PageQuery,
) -> JsonResult {
    let part = DetailQuery { source, number, kind: "output", page };
    app.with_run(run, move |run| {
        let (output, next) = part.read(run, |event| {
            let EventKind::Output(output) = event.kind else { return None };
            Some(Printed::of(event.seq, event.at.0, output))
        })?;
        JsonText::of(&OutputPage { output, next })
    })
    .await
}

/// What an attempt of a test printed.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/output", tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), PageQuery),
    responses((status = 200, body = OutputPage), Problems))]
pub async fn test_output(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(page): QueryParams<PageQuery>,
) -> JsonResult {
    output(app, run, (Source::Test(TestId(test)), number), page).await
}

/// What a fixture printed after one of its starts.
#[utoipa::path(get, path = "/runs/{run}/fixtures/{fixture}/starts/{number}/output",
    tag = "details",
    params(("run" = String, Path), ("fixture" = u32, Path), ("number" = u32, Path), PageQuery),
    responses((status = 200, body = OutputPage), Problems))]
pub async fn fixture_output(
    State(app): State<App>,
    At((run, fixture, number)): Path3,
    QueryParams(page): QueryParams<PageQuery>,
) -> JsonResult {
    output(app, run, (Source::Fixture(FixtureId(fixture)), number), page).await
}

/// What a run of a hook printed.
#[utoipa::path(get, path = "/runs/{run}/hooks/{hook}/runs/{number}/output", tag = "details",
    params(("run" = String, Path), ("hook" = u32, Path), ("number" = u32, Path), PageQuery),
    responses((status = 200, body = OutputPage), Problems))]
pub async fn hook_output(
    State(app): State<App>,
    At((run, hook, number)): Path3,
    QueryParams(page): QueryParams<PageQuery>,
) -> JsonResult {
    output(app, run, (Source::Hook(HookId(hook)), number), page).await
}
