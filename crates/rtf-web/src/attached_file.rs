//! What a browser may do with a file that a test attached, which is not to be trusted: it shows only what cannot run
//! scripts.

use std::path::Path;

use axum::http::{HeaderMap, HeaderValue, header};

use crate::address::encoded_part;
use crate::header::insert;
use crate::index::AttachmentInfo;

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

    /// Adds the headers under which a browser receives it.
    pub fn describe(&self, headers: &mut HeaderMap) {
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

/// Whether this is the path of an attachment in a run directory.
pub fn is_attachment(path: &str) -> bool {
    let parts: Vec<_> = path.split('/').collect();
    let odd = |part: &&str| part.is_empty() || *part == "." || *part == "..";
    let below = parts.first() == Some(&FOLDER) && parts.len() > 1 && !parts.iter().any(odd);
    below && !path.contains(['\\', '\0'])
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
}
