//! Files of a run: what tests attached, and the journal. No other file is ever opened.

use std::fs::File;
use std::path::Path;

use axum::extract::State;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::problems::Problems;
use super::query::At;
use crate::address::encoded;
use crate::app::App;
use crate::attached_file::{ServedType, is_attachment};
use crate::byte_range::{RangeRequest, range};
use crate::header::insert;
use crate::problem::Problem;
use crate::runs::Run;
use crate::stream_file;

/// A file that a test attached: `attachments/plot.png`.
#[utoipa::path(get, path = "/runs/{run}/files/{*path}", tag = "files",
    params(("run" = String, Path), ("path" = String, Path)),
    responses((status = 200, content_type = "*/*", body = Vec<u8>),
        (status = 206, content_type = "*/*", body = Vec<u8>),
        (status = 416), Problems))]
pub async fn file(
    State(app): State<App>,
    At((run, path)): At<(String, String)>,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let place = app.place_for_file()?;
    let opened = app.with_run(run, move |run| {
        let file = open(run, &path)?;
        let said = run.read()?.attached.of(&path).cloned();
        Ok((file, ServedType::of(&path, said.as_ref())))
    });
    let ((file, length), kind) = opened.await?;
    let (range, status) = match range(&headers, length) {
        RangeRequest::All => (0..length, StatusCode::OK),
        RangeRequest::Part(start, end) => (start..end, StatusCode::PARTIAL_CONTENT),
        RangeRequest::Nothing => {
            let mut none = StatusCode::RANGE_NOT_SATISFIABLE.into_response();
            insert(none.headers_mut(), header::CONTENT_RANGE, &format!("bytes */{length}"));
            return Ok(none);
        }
    };
    let body = stream_file::body(file, range.clone(), place)?;
    let mut response = (status, body).into_response();
    let headers = response.headers_mut();
    if status == StatusCode::PARTIAL_CONTENT {
        let text = format!("bytes {}-{}/{length}", range.start, range.end - 1);
        insert(headers, header::CONTENT_RANGE, &text);
    }
    insert(headers, header::CONTENT_LENGTH, &(range.end - range.start).to_string());
    kind.describe(headers);
    Ok(response)
}

/// Opens a file below `attachments/`, and no other file, for any path.
fn open(run: &Run, path: &str) -> Result<(File, u64), Problem> {
    let none = || Problem::not_found(format!("there is no file `{path}` in this run"));
    if !is_attachment(path) {
        return Err(none());
    }
    let file = run.open_file(Path::new(path)).map_err(|_| none())?;
    let metadata = file.metadata().map_err(|_| none())?;
    Ok((file, metadata.len()))
}

/// The journal as far as it is written.
#[utoipa::path(get, path = "/runs/{run}/journal", tag = "files", params(("run" = String, Path)),
    responses((status = 200, content_type = "application/x-ndjson", body = String), Problems))]
pub async fn journal(State(app): State<App>, At(run): At<String>) -> Result<Response, Problem> {
    let place = app.place_for_file()?;
    let opened = app.with_run(run, |run| {
        let length = run.read()?.offset;
        Ok((run.journal()?, length, run.name.clone()))
    });
    let (file, length, name) = opened.await?;
    let mut response = stream_file::body(file, 0..length, place)?.into_response();
    let headers = response.headers_mut();
    insert(headers, header::CONTENT_TYPE, "application/x-ndjson");
    insert(headers, header::CONTENT_LENGTH, &length.to_string());
    let disposition = format!("attachment; filename*=UTF-8''{}.jsonl", encoded(&name));
    insert(headers, header::CONTENT_DISPOSITION, &disposition);
    Ok(response)
}
