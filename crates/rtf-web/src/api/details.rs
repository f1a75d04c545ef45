//! The messages, measurements and output of one attempt of a test, start of a fixture
//! or run of a hook. They are read from the journal, page by page.

use std::ops::ControlFlow;

use axum::extract::State;
use rtf_model::{CaseId, Event, EventKind, FixtureId, HookId, MessageKind, Source, TestId};
use rtf_report::journal::{EventHeader, parse_event};
use serde::Deserialize;
use utoipa::IntoParams;

use super::case_filter::CaseFilter;
use super::problems::Problems;
use super::query::{At, CasePageQuery, Number, PageQuery, QueryParams, values};
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
    source: Source,
    number: u32,
    kind: &'static str,
    page: PageQuery,
    /// Only this case and those that it contains.
    case: Option<CaseId>,
}

/// In place of a kind of event: the starts and ends of questions.
const QUESTION: &str = "question";
/// In place of a kind of event: the starts and ends of cases.
const CASE: &str = "case";

impl DetailQuery {
    /// A page of the events of a kind.
    fn page_of((source, number): (Source, u32), kind: &'static str, page: PageQuery) -> Self {
        Self { source, number, kind, page, case: None }
    }

    /// All events of a kind of an attempt of a test.
    fn all_of(test: u32, number: u32, kind: &'static str) -> Self {
        Self::page_of((Source::Test(TestId(test)), number), kind, PageQuery::default())
    }

    /// A page of the events of a kind of an attempt of a test, or of a case of it.
    fn of_test((test, number): (u32, u32), kind: &'static str, query: CasePageQuery) -> Self {
        Self { page: query.page(), ..Self::all_of(test, number, kind) }.in_case(query.case)
    }

    /// The questions of an attempt of a test.
    pub(super) fn questions_of(test: u32, number: u32) -> Self {
        Self::all_of(test, number, QUESTION)
    }

    /// The starts and ends of the cases of an attempt of a test.
    pub(super) fn cases_of(test: u32, number: u32) -> Self {
        Self::all_of(test, number, CASE)
    }

    /// The samples of an attempt of a test.
    pub(super) fn samples_of(test: u32, number: u32) -> Self {
        Self::all_of(test, number, "sampled")
    }

    /// Only what was reported in a case or in those that it contains.
    pub(super) fn in_case(self, case: Option<u32>) -> Self {
        Self { case: case.map(CaseId), ..self }
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
        let mut filter = self.case.map(CaseFilter::new);
        while let Some(line) = lines.next().map_err(unreadable)? {
            let Ok(header) = serde_json::from_slice::<EventHeader>(line.text) else { continue };
            if let Some(filter) = &mut filter
                && *header.kind == *"case-started"
                && header.detail_source() == Some(self.source)
                && let Ok(event) = parse_event(line.text)
            {
                filter.add(&event);
            }
            let is_before = self.page.after.is_some_and(|Number(after)| header.seq <= after);
            if !is_before
                && self.wants(&header)
                && let Ok(event) = parse_event(line.text)
                && filter.as_ref().is_none_or(|filter| filter.contains(&event))
                && visit(event, line.text.len()).is_break()
            {
                break;
            }
        }
        filter.map_or(Ok(()), |filter| filter.check())
    }

    fn wants(&self, header: &EventHeader) -> bool {
        let source = match self.kind {
            QUESTION => header.questioner(),
            CASE => header
                .detail_source()
                .filter(|_| matches!(&*header.kind, "case-started" | "case-finished")),
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
        // Which cases a case contains follows from the events since the start of the attempt.
        let after = self.page.after.filter(|_| self.case.is_none());
        let known = after.map_or(0, |Number(after)| index.positions.before(after));
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

/// Which messages of an attempt of a test.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct CaseKinds {
    /// Only those of this case and of the cases that it contains.
    #[param(maximum = 4_294_967_295_i64)]
    case: Option<u32>,
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

async fn messages(app: App, run: String, part: DetailQuery, kinds: Option<String>) -> JsonResult {
    let wanted = kinds.map(|list| values("kind", &list, &KINDS)).transpose()?;
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
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), CaseKinds),
    responses((status = 200, body = Messages), Problems))]
pub async fn test_messages(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(CaseKinds { case, kind, after, limit }): QueryParams<CaseKinds>,
) -> JsonResult {
    let page = CasePageQuery { case, after, limit };
    messages(app, run, DetailQuery::of_test((test, number), "message", page), kind).await
}

/// What a fixture reported after one of its starts.
#[utoipa::path(get, path = "/runs/{run}/fixtures/{fixture}/starts/{number}/messages",
    tag = "details",
    params(("run" = String, Path), ("fixture" = u32, Path), ("number" = u32, Path), Kinds),
    responses((status = 200, body = Messages), Problems))]
pub async fn fixture_messages(
    State(app): State<App>,
    At((run, fixture, number)): Path3,
    QueryParams(Kinds { kind, after, limit }): QueryParams<Kinds>,
) -> JsonResult {
    let source = Source::Fixture(FixtureId(fixture));
    let page = PageQuery { after, limit };
    messages(app, run, DetailQuery::page_of((source, number), "message", page), kind).await
}

/// What a run of a hook reported.
#[utoipa::path(get, path = "/runs/{run}/hooks/{hook}/runs/{number}/messages", tag = "details",
    params(("run" = String, Path), ("hook" = u32, Path), ("number" = u32, Path), Kinds),
    responses((status = 200, body = Messages), Problems))]
pub async fn hook_messages(
    State(app): State<App>,
    At((run, hook, number)): Path3,
    QueryParams(Kinds { kind, after, limit }): QueryParams<Kinds>,
) -> JsonResult {
    let source = Source::Hook(HookId(hook));
    let page = PageQuery { after, limit };
    messages(app, run, DetailQuery::page_of((source, number), "message", page), kind).await
}

/// What an attempt of a test measured.
#[utoipa::path(get, path = "/runs/{run}/tests/{test}/attempts/{number}/measurements",
    tag = "details",
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), CasePageQuery),
    responses((status = 200, body = Measurements), Problems))]
pub async fn measurements(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(page): QueryParams<CasePageQuery>,
) -> JsonResult {
    let part = DetailQuery::of_test((test, number), "measured", page);
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
    params(("run" = String, Path), ("test" = u32, Path), ("number" = u32, Path), CasePageQuery),
    responses((status = 200, body = Attachments), Problems))]
pub async fn attachments(
    State(app): State<App>,
    At((run, test, number)): Path3,
    QueryParams(page): QueryParams<CasePageQuery>,
) -> JsonResult {
    let part = DetailQuery::of_test((test, number), "attached", page);
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
    let source = Source::Test(TestId(test));
    let part = DetailQuery::page_of((source, number), "stack-dumped", page);
    app.with_run(run, move |run| {
        let (stacks, next) = part.read(run, |event| {
            let EventKind::StackDumped { text, .. } = event.kind else { return None };
            Some(Stack { seq: event.seq, at: event.at.0, text })
        })?;
        JsonText::of(&Stacks { stacks, next })
    })
    .await
}

async fn output(app: App, run: String, of: (Source, u32), page: PageQuery) -> JsonResult {
    let part = DetailQuery::page_of(of, "output", page);
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
