//! Files of a run: what tests attached, and the journal.
//!
//! What a test attached is not to be trusted: it is shown only as what cannot
//! run scripts, and nothing outside of `attachments/` is ever opened.

use std::fs::File;
use std::path::{Path, PathBuf};

use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::ROOT;
use super::asked::At;
use super::problems::Problems;
use crate::app::App;
use crate::problem::Problem;
use crate::stream_file;

/// The only folder of which files are served.
const FOLDER: &str = "attachments";

/// What a browser shows without running anything of it.
const SHOWN: [&str; 9] = [
    "image/png",
    "image/jpeg",
    "image/gif",
    "image/webp",
    "image/avif",
    "image/bmp",
    "text/plain",
    "text/csv",
    "application/json",
];

/// Nothing of a file may do anything, whatever it is.
const POLICY: HeaderValue = HeaderValue::from_static("sandbox; default-src 'none'");

/// The address of a file in the run's folder.
pub fn url(run: &str, path: &str) -> String {
    format!("{ROOT}/runs/{}/files/{}", encoded(run), encoded(path))
}

/// As it may stand in a path; a `/` stays one.
fn encoded(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for byte in text.bytes() {
        match byte {
            b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' | b'.' | b'~' | b'/' => {
                out.push(char::from(byte));
            }
            byte => out += &format!("%{byte:02X}"),
        }
    }
    out
}

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
    let (file, length) = app
        .with_run(run, {
            let path = path.clone();
            move |run| open(&run.folder, &path)
        })
        .await?;
    let mut response = match range(&headers, length) {
        Asked::All => stream_file::body(file, 0, length)?.into_response(),
        Asked::Part(start, end) => {
            let mut part = stream_file::body(file, start, end - start)?.into_response();
            *part.status_mut() = StatusCode::PARTIAL_CONTENT;
            let text = format!("bytes {start}-{}/{length}", end - 1);
            insert(part.headers_mut(), header::CONTENT_RANGE, &text);
            insert(part.headers_mut(), header::CONTENT_LENGTH, &(end - start).to_string());
            part
        }
        Asked::Nothing => {
            let mut none = StatusCode::RANGE_NOT_SATISFIABLE.into_response();
            insert(none.headers_mut(), header::CONTENT_RANGE, &format!("bytes */{length}"));
            return Ok(none);
        }
    };
    let whole = response.status() == StatusCode::OK;
    let headers = response.headers_mut();
    if whole {
        insert(headers, header::CONTENT_LENGTH, &length.to_string());
    }
    describe(headers, &path);
    Ok(response)
}

fn describe(headers: &mut HeaderMap, path: &str) {
    let kind = mime_guess::from_path(path).first_raw().unwrap_or_default();
    let name = Path::new(path).file_name().unwrap_or_default().to_string_lossy();
    let shown = SHOWN.contains(&kind);
    let text = if kind.starts_with("text/") { "; charset=utf-8" } else { "" };
    let kind = if shown { kind } else { "application/octet-stream" };
    insert(headers, header::CONTENT_TYPE, &format!("{kind}{}", if shown { text } else { "" }));
    let place = if shown { "inline" } else { "attachment" };
    let disposition = format!("{place}; filename*=UTF-8''{}", encoded(&name));
    insert(headers, header::CONTENT_DISPOSITION, &disposition);
    headers.insert(header::CONTENT_SECURITY_POLICY, POLICY);
    headers.insert(header::ACCEPT_RANGES, HeaderValue::from_static("bytes"));
}

fn insert(headers: &mut HeaderMap, name: header::HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        headers.insert(name, value);
    }
}

/// Opens a file below `attachments/`, and nothing else, whatever the path says.
fn open(folder: &Path, path: &str) -> Result<(File, u64), Problem> {
    let none = || Problem::not_found(format!("there is no file `{path}` in this run"));
    let inside = place(folder, path).ok_or_else(none)?;
    let file = File::open(&inside).map_err(|_| none())?;
    let metadata = file.metadata().map_err(|_| none())?;
    Ok((file, metadata.len()))
}

fn place(folder: &Path, path: &str) -> Option<PathBuf> {
    let parts: Vec<_> = path.split('/').collect();
    let odd = |part: &&str| part.is_empty() || *part == "." || *part == "..";
    let allowed = parts.first() == Some(&FOLDER) && parts.len() > 1 && !parts.iter().any(odd);
    if !allowed || path.contains(['\\', '\0']) {
        return None;
    }
    // Links may lead anywhere: what counts is where they end.
    let root = folder.join(FOLDER).canonicalize().ok()?;
    let file = folder.join(path).canonicalize().ok()?;
    (file.starts_with(&root) && file.is_file()).then_some(file)
}

/// What a `Range` asks for.
#[derive(Debug, PartialEq, Eq)]
enum Asked {
    All,
    Part(u64, u64),
    Nothing,
}

/// One range is understood; anything else is answered with the whole file.
fn range(headers: &HeaderMap, length: u64) -> Asked {
    let text = headers.get(header::RANGE).and_then(|value| value.to_str().ok());
    let Some(range) = text.and_then(|text| text.strip_prefix("bytes=")) else { return Asked::All };
    let Some((from, to)) = range.split_once('-') else { return Asked::All };
    let (from, to) = (from.trim().parse::<u64>(), to.trim().parse::<u64>());
    let (start, end) = match (from, to) {
        (Ok(from), Ok(to)) if from <= to => (from, to.saturating_add(1).min(length)),
        (Ok(from), Err(_)) if range.ends_with('-') => (from, length),
        (Err(_), Ok(last)) if range.starts_with('-') => (length.saturating_sub(last), length),
        _ => return Asked::All,
    };
    if start < end { Asked::Part(start, end) } else { Asked::Nothing }
}

/// The journal as far as it is written.
#[utoipa::path(get, path = "/runs/{run}/journal", tag = "files", params(("run" = String, Path)),
    responses((status = 200, content_type = "application/x-ndjson", body = String), Problems))]
pub async fn journal(State(app): State<App>, At(run): At<String>) -> Result<Response, Problem> {
    let opened = app.with_run(run, |run| {
        let length = run.read()?.offset();
        Ok((run.journal()?, length, run.name.clone()))
    });
    let (file, length, name) = opened.await?;
    let mut response = stream_file::body(file, 0, length)?.into_response();
    let headers = response.headers_mut();
    insert(headers, header::CONTENT_TYPE, "application/x-ndjson");
    insert(headers, header::CONTENT_LENGTH, &length.to_string());
    let disposition = format!("attachment; filename*=UTF-8''{}.jsonl", encoded(&name));
    insert(headers, header::CONTENT_DISPOSITION, &disposition);
    Ok(response)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_below_attachments_have_a_place() {
        let temp = tempfile::tempdir().unwrap();
        let folder = temp.path().join("run");
        std::fs::create_dir_all(folder.join("attachments/deep")).unwrap();
        for file in ["attachments/a b.png", "attachments/deep/b.txt", "events.jsonl", "../secret"] {
            std::fs::write(folder.join(file), "x").unwrap();
        }
        std::os::unix::fs::symlink("../../secret", folder.join("attachments/link")).unwrap();
        std::os::unix::fs::symlink("deep/b.txt", folder.join("attachments/inside")).unwrap();
        for good in ["attachments/a b.png", "attachments/deep/b.txt", "attachments/inside"] {
            assert!(place(&folder, good).is_some(), "{good}");
        }
        for bad in [
            "events.jsonl",
            "attachments",
            "attachments/",
            "attachments/deep",
            "attachments/../events.jsonl",
            "attachments/../../secret",
            "attachments/./a b.png",
            "attachments//a b.png",
            "attachments\\a b.png",
            "attachments/link",
            "/etc/passwd",
            "../secret",
            "attachments/a b.png\0",
        ] {
            assert_eq!(place(&folder, bad), None, "{bad}");
        }
    }

    #[test]
    fn one_range_is_understood() {
        let asked = |text: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::RANGE, HeaderValue::from_str(text).unwrap());
            range(&headers, 10)
        };
        assert_eq!(asked("bytes=0-3"), Asked::Part(0, 4));
        assert_eq!(asked("bytes=8-99"), Asked::Part(8, 10));
        assert_eq!(asked("bytes=4-"), Asked::Part(4, 10));
        assert_eq!(asked("bytes=-3"), Asked::Part(7, 10));
        assert_eq!(asked("bytes=10-"), Asked::Nothing);
        for odd in ["bytes=5-2", "bytes=0-1,4-5", "pages=1-2", "bytes=x-y", "bytes=-"] {
            assert_eq!(asked(odd), Asked::All, "{odd}");
        }
    }
}
