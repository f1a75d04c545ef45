//! What a process printed, as its log file holds it.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::PathBuf;

use axum::extract::State;
use axum::http::header;
use axum::response::{IntoResponse, Response};
use rtf_model::{FixtureId, HookId, Record, TestId};
use rtf_report::logs;
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

use super::problems::Problems;
use super::query::{At, Number, QueryParams};
use crate::app::{App, JsonText};
use crate::problem::Problem;
use crate::stream_file;

/// Default size of a part in bytes.
const PART: u64 = 64 * 1024;
/// How much it may hold.
const LARGEST_PART: u64 = 1 << 20;

/// Whose log.
#[derive(Clone, Copy, Debug, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Of an attempt of a test.
    Tests,
    /// Of a start of a fixture.
    Fixtures,
    /// Of a run of a hook.
    Hooks,
}

/// Which part of it.
#[derive(Debug, Deserialize, IntoParams)]
#[into_params(parameter_in = Query)]
pub struct LogQuery {
    /// The offset of its first byte. With this or `limit`, the answer is JSON.
    #[param(value_type = Option<u64>, maximum = 9_007_199_254_740_991_i64)]
    offset: Option<Number>,
    /// How many bytes at most.
    #[param(minimum = 4, maximum = 1_048_576, default = 65536)]
    limit: Option<u64>,
}

/// A part of a log.
#[derive(Debug, Serialize, ToSchema)]
pub struct LogPart {
    /// The text.
    text: String,
    /// The offset of its first byte.
    offset: u64,
    /// The offset of the part that follows.
    next: u64,
    /// How long the whole log is.
    size: u64,
}

fn path(record: &Record, kind: Kind, id: u32, number: u32) -> Option<PathBuf> {
    let place = usize::try_from(number.checked_sub(1)?).ok()?;
    let index = usize::try_from(id).ok()?;
    Some(match kind {
        Kind::Tests => {
            let attempt = record.tests.get(index)?.attempts.get(place)?;
            logs::attempt_log(record, TestId(id), (attempt.repetition, attempt.attempt))
        }
        Kind::Fixtures => {
            record.fixtures.get(index)?.lives.get(place)?;
            logs::fixture_start_log(record, FixtureId(id), number)
        }
        Kind::Hooks => {
            record.hooks.get(index)?.runs.get(place)?;
            logs::hook_run_log(record, HookId(id), place + 1)
        }
    })
}

/// A log; with `offset` or `limit` a part of it, as JSON.
#[utoipa::path(get, path = "/runs/{run}/logs/{kind}/{id}/{number}", tag = "files",
    params(("run" = String, Path), ("kind" = inline(Kind), Path), ("id" = u32, Path),
        ("number" = u32, Path, description = "the attempt, start or run, from 1"), LogQuery),
    responses((status = 200, content(
        (LogPart = "application/json"), (String = "text/plain"))), Problems))]
pub async fn log(
    State(app): State<App>,
    At((run, kind, id, number)): At<(String, Kind, u32, u32)>,
    QueryParams(which): QueryParams<LogQuery>,
) -> Result<Response, Problem> {
    let place = app.place_for_file();
    app.with_run(run, move |run| {
        let place = place?;
        let path = path(&run.read()?.record, kind, id, number);
        let none = || Problem::not_found("there is no such log: nothing was printed");
        let file = path.and_then(|path| run.open_file(&path).ok()).ok_or_else(none)?;
        let size = file.metadata().map_err(|_| none())?.len();
        if which.offset.is_none() && which.limit.is_none() {
            let kind = [(header::CONTENT_TYPE, "text/plain; charset=utf-8")];
            return Ok((kind, stream_file::body(file, 0..size, place)?).into_response());
        }
        let part = part(file, size, &which)?;
        Ok(JsonText::of(&part)?.into_response())
    })
    .await
}

fn part(mut file: File, size: u64, which: &LogQuery) -> Result<LogPart, Problem> {
    let limit = which.limit.unwrap_or(PART);
    if !(4..=LARGEST_PART).contains(&limit) {
        let expected = format!("expected a number from 4 to {LARGEST_PART}");
        return Err(Problem::bad_request(format!("`limit` is {limit}, {expected}")));
    }
    let offset = which.offset.map_or(0, |Number(offset)| offset).min(size);
    let failed = |error| Problem::unreadable(std::path::Path::new("log"), &error);
    file.seek(SeekFrom::Start(offset)).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(limit).read_to_end(&mut bytes).map_err(failed)?;
    let whole = whole(&bytes);
    let text = String::from_utf8_lossy(&bytes[..whole]).into_owned();
    Ok(LogPart { text, offset, next: offset + whole as u64, size })
}

/// How many bytes there are without a character that is cut at the end.
fn whole(bytes: &[u8]) -> usize {
    let end = bytes.len();
    for back in 1..=end.min(3) {
        let byte = bytes[end - back];
        let length = match byte {
            0xC0..=0xDF => 2,
            0xE0..=0xEF => 3,
            0xF0..=0xF7 => 4,
            0x80..=0xBF => continue,
            _ => 1,
        };
        return if length > back { end - back } else { end };
    }
    end
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_character_is_split() {
        let text = "añ€🤖".as_bytes();
        let ends: Vec<_> = (0..=text.len()).map(|end| whole(&text[..end])).collect();
        assert_eq!(ends, [0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10]);
        assert_eq!(whole(&[b'a', 0xFF]), 2, "what is no character at all is not waited for");
    }
}
