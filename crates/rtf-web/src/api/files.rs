//! Files of a run: what tests attached, and the journal.
//!
//! What a test attached is not to be trusted: it is shown only as what cannot
//! run scripts, and nothing outside of `attachments/` is ever opened.

use std::fs::File;
use std::path::Path;

use axum::extract::State;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};

use super::ROOT;
use super::problems::Problems;
use super::query::At;
use crate::app::App;
use crate::index::AttachmentInfo;
use crate::problem::Problem;
use crate::runs::Run;
use crate::stream_file;

/// The only directory whose files are served.
const FOLDER: &str = "attachments";

/// What a browser shows or plays without running anything of it, and the usual
/// extension of its files.
const SHOWN: [(&str, &str); 16] = [
    ("image/png", "png"),
    ("image/jpeg", "jpg"),
    ("image/gif", "gif"),
    ("image/webp", "webp"),
    ("image/avif", "avif"),
    ("image/bmp", "bmp"),
    ("text/plain", "txt"),
    ("text/csv", "csv"),
    ("application/json", "json"),
    ("video/mp4", "mp4"),
    ("video/webm", "webm"),
    ("video/ogg", "ogv"),
    ("audio/mpeg", "mp3"),
    ("audio/ogg", "ogg"),
    ("audio/wav", "wav"),
    ("audio/webm", "weba"),
];

/// A browser may run nothing that a file contains, of any type.
const POLICY: HeaderValue = HeaderValue::from_static("sandbox; default-src 'none'");

/// The address of a file in the run's directory.
pub fn url(run: &str, path: &str) -> String {
    format!("{ROOT}/runs/{}/files/{}", encoded(run), encoded(path))
}

/// As it may stand in a part of a path or a header: a `/` is encoded, too.
fn encoded_part(text: &str) -> String {
    encoded(text).replace('/', "%2F")
}

/// As it may stand in a path; a `/` stays one.
pub fn encoded(text: &str) -> String {
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
    let place = app.place_for_file()?;
    let opened = app.with_run(run, move |run| {
        let file = open(run, &path)?;
        let said = run.read()?.attached().of(&path).cloned();
        Ok((file, ServedType::of(&path, said.as_ref())))
    });
    let ((file, length), kind) = opened.await?;
    let mut response = match range(&headers, length) {
        RangeRequest::All => stream_file::body(file, 0..length, place)?.into_response(),
        RangeRequest::Part(start, end) => {
            let mut part = stream_file::body(file, start..end, place)?.into_response();
            *part.status_mut() = StatusCode::PARTIAL_CONTENT;
            let text = format!("bytes {start}-{}/{length}", end - 1);
            insert(part.headers_mut(), header::CONTENT_RANGE, &text);
            insert(part.headers_mut(), header::CONTENT_LENGTH, &(end - start).to_string());
            part
        }
        RangeRequest::Nothing => {
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
    kind.describe(headers);
    Ok(response)
}

/// What a file is to a browser.
#[derive(Debug, PartialEq, Eq)]
pub struct ServedType {
    name: String,
    media_type: String,
    shown: bool,
}

impl ServedType {
    /// The test's media type counts; without one, the ending of the name decides.
    pub fn of(path: &str, said: Option<&AttachmentInfo>) -> Self {
        let guessed = |name: &str| mime_guess::from_path(name).first_raw();
        let given = said.map(|said| essence(&said.media_type)).filter(|kind| !kind.is_empty());
        let named = || said.and_then(|said| guessed(&said.name)).map(str::to_owned);
        let media_type = given.or_else(named);
        let media_type = media_type.or_else(|| guessed(path).map(str::to_owned));
        let media_type = media_type.unwrap_or_default();
        let file = Path::new(path).file_name().unwrap_or_default().to_string_lossy();
        let name = said.map_or(&*file, |said| &said.name);
        let name = with_extension(name, path, &media_type);
        let shown = SHOWN.iter().any(|(kind, _)| *kind == media_type);
        Self { name, media_type, shown }
    }

    /// The media type under which a browser receives it.
    pub fn content_type(&self) -> String {
        let kind = if self.shown { &*self.media_type } else { "application/octet-stream" };
        let text = if kind.starts_with("text/") { "; charset=utf-8" } else { "" };
        format!("{kind}{text}")
    }

    fn describe(&self, headers: &mut HeaderMap) {
        insert(headers, header::CONTENT_TYPE, &self.content_type());
        let place = if self.shown { "inline" } else { "attachment" };
        let disposition = format!("{place}; filename*=UTF-8''{}", encoded_part(&self.name));
        insert(headers, header::CONTENT_DISPOSITION, &disposition);
        headers.insert(header::CONTENT_SECURITY_POLICY, POLICY);
        headers.insert(header::ACCEPT_RANGES, HeaderValue::from_static("bytes"));
    }
}

/// A media type without its parameters, under the name that browsers know.
fn essence(media_type: &str) -> String {
    let essence = media_type.split(';').next().unwrap_or_default().trim().to_ascii_lowercase();
    match &*essence {
        "image/jpg" => "image/jpeg".to_owned(),
        "audio/x-wav" | "audio/wave" => "audio/wav".to_owned(),
        "audio/mp3" => "audio/mpeg".to_owned(),
        _ => essence,
    }
}

/// The name with an extension: its own, that of the file, or that of the media type.
fn with_extension(name: &str, path: &str, media_type: &str) -> String {
    if Path::new(name).extension().is_some() {
        return name.to_owned();
    }
    let own = Path::new(path).extension().map(|own| own.to_string_lossy().into_owned());
    let usual = SHOWN.iter().find(|(kind, _)| *kind == media_type);
    let extension = own.or_else(|| usual.map(|(_, extension)| (*extension).to_owned()));
    extension.map_or_else(|| name.to_owned(), |extension| format!("{name}.{extension}"))
}

fn insert(headers: &mut HeaderMap, name: header::HeaderName, value: &str) {
    if let Ok(value) = HeaderValue::from_str(value) {
        headers.insert(name, value);
    }
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

/// Whether this is the path of an attachment in a run directory.
pub fn is_attachment(path: &str) -> bool {
    let parts: Vec<_> = path.split('/').collect();
    let odd = |part: &&str| part.is_empty() || *part == "." || *part == "..";
    let below = parts.first() == Some(&FOLDER) && parts.len() > 1 && !parts.iter().any(odd);
    below && !path.contains(['\\', '\0'])
}

/// What a `Range` asks for.
#[derive(Debug, PartialEq, Eq)]
enum RangeRequest {
    All,
    Part(u64, u64),
    Nothing,
}

/// One range is understood; anything else is answered with the whole file.
fn range(headers: &HeaderMap, length: u64) -> RangeRequest {
    let text = headers.get(header::RANGE).and_then(|value| value.to_str().ok());
    let Some(range) = text.and_then(|text| text.strip_prefix("bytes=")) else {
        return RangeRequest::All;
    };
    let Some((from, to)) = range.split_once('-') else { return RangeRequest::All };
    let (from, to) = (from.trim().parse::<u64>(), to.trim().parse::<u64>());
    let (start, end) = match (from, to) {
        (Ok(from), Ok(to)) if from <= to => (from, to.saturating_add(1).min(length)),
        (Ok(from), Err(_)) if range.ends_with('-') => (from, length),
        (Err(_), Ok(last)) if range.starts_with('-') => (length.saturating_sub(last), length),
        _ => return RangeRequest::All,
    };
    if start < end { RangeRequest::Part(start, end) } else { RangeRequest::Nothing }
}

/// The journal as far as it is written.
#[utoipa::path(get, path = "/runs/{run}/journal", tag = "files", params(("run" = String, Path)),
    responses((status = 200, content_type = "application/x-ndjson", body = String), Problems))]
pub async fn journal(State(app): State<App>, At(run): At<String>) -> Result<Response, Problem> {
    let place = app.place_for_file()?;
    let opened = app.with_run(run, |run| {
        let length = run.read()?.offset();
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_paths_below_attachments_are_those_of_attachments() {
        for good in ["attachments/a b.png", "attachments/deep/b.txt"] {
            assert!(is_attachment(good), "{good}");
        }
        for bad in [
            "events.jsonl",
            "attachments",
            "attachments/",
            "attachments/../events.jsonl",
            "attachments/./a b.png",
            "attachments//a b.png",
            "attachments\\a b.png",
            "/etc/passwd",
            "../secret",
            "attachments/a b.png\0",
        ] {
            assert!(!is_attachment(bad), "{bad}");
        }
    }

    #[test]
    fn the_media_type_of_the_test_counts_and_the_name_has_an_extension() {
        let kind = |path: &str, name: &str, media_type: &str| {
            let said = AttachmentInfo { name: name.into(), media_type: media_type.into() };
            let ServedType { name, media_type, shown } = ServedType::of(path, Some(&said));
            (name, media_type, shown)
        };
        for (path, name, said, wanted) in [
            ("attachments/1-video", "video", "video/mp4", ("video.mp4", "video/mp4", true)),
            (
                "attachments/1-log.bin",
                "log",
                "text/plain; charset=x",
                ("log.bin", "text/plain", true),
            ),
            ("attachments/1-forces", "forces.csv", "", ("forces.csv", "text/csv", true)),
            ("attachments/1-a.png", "a.png", "text/html", ("a.png", "text/html", false)),
            ("attachments/1-a", "a", "", ("a", "", false)),
        ] {
            let (shown_name, media_type, shown) = kind(path, name, said);
            assert_eq!((&*shown_name, &*media_type, shown), wanted, "{path}");
        }
        assert_eq!(ServedType::of("attachments/b.json", None).media_type, "application/json");
    }

    #[test]
    fn one_range_is_understood() {
        let asked = |text: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(header::RANGE, HeaderValue::from_str(text).unwrap());
            range(&headers, 10)
        };
        assert_eq!(asked("bytes=0-3"), RangeRequest::Part(0, 4));
        assert_eq!(asked("bytes=8-99"), RangeRequest::Part(8, 10));
        assert_eq!(asked("bytes=4-"), RangeRequest::Part(4, 10));
        assert_eq!(asked("bytes=-3"), RangeRequest::Part(7, 10));
        assert_eq!(asked("bytes=10-"), RangeRequest::Nothing);
        for odd in ["bytes=5-2", "bytes=0-1,4-5", "pages=1-2", "bytes=x-y", "bytes=-"] {
            assert_eq!(asked(odd), RangeRequest::All, "{odd}");
        }
    }
}
