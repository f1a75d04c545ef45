//! Reads the text of a suite file or of an `rtf.toml`.

use std::ffi::OsStr;
use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::{SourceText, Span, prepass};

/// The maximum size of a suite file: about 600 000 tests.
pub const MAX_SUITE_BYTES: u64 = 64 * 1024 * 1024;

/// The size of the prefix in which [`begins_with`] searches the first element.
const PREFIX_BYTES: u64 = 64 * 1024;

const REPLAY_EXTENSION: &str = "replay.xml";

/// The names of a suite's first element: the present one, and that of 1.x.
pub(super) const SUITE_ROOTS: [&str; 2] = ["suite", "suit"];

/// Checks whether a file's first element is that of a suite, even if the file is malformed.
#[must_use]
pub fn is_suite_file(path: &Path) -> bool {
    begins_with(path, &SUITE_ROOTS)
}

/// Returns the path of the suite that replays recordings of a suite: `arm.replay.xml` for
/// `arm.xml`. The file need not exist.
#[must_use]
pub fn replay_suite(suite: &Path) -> PathBuf {
    suite.with_extension(REPLAY_EXTENSION)
}

/// Whether this is the name of a suite that replays recordings of another one. It needs a
/// recording, so that it is not one of the suites of its directory.
#[must_use]
pub fn is_replay_suite(path: &Path) -> bool {
    let name = path.file_name().and_then(OsStr::to_str).unwrap_or_default();
    name.strip_suffix(REPLAY_EXTENSION).is_some_and(|stem| stem.ends_with('.'))
}

/// Checks whether a file's first element is `<campaign>`, even if the file is malformed.
#[must_use]
pub fn is_campaign_file(path: &Path) -> bool {
    begins_with(path, &["campaign"])
}

fn begins_with(path: &Path, elements: &[&str]) -> bool {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(PREFIX_BYTES).read_to_end(&mut bytes));
    let text = String::from_utf8_lossy(&bytes);
    let root = read.ok().and_then(|_| prepass::root_name(&text));
    root.is_some_and(|root| elements.contains(&root))
}

#[derive(Debug)]
pub struct UnreadableFile {
    pub problem: Diagnostic,
    /// The file's text, if the error points into it.
    pub source: Option<SourceText>,
}

impl UnreadableFile {
    fn new(problem: Diagnostic, source: Option<SourceText>) -> Box<Self> {
        Box::new(Self { problem, source })
    }
}

/// Reads a file. Messages call it `name`.
///
/// # Errors
/// The file does not exist, cannot be read, is too long, or is not UTF-8.
pub fn read_source(path: &Path, name: &str) -> Result<SourceText, Box<UnreadableFile>> {
    let bytes = read(path, name).map_err(|problem| UnreadableFile::new(*problem, None))?;
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        let problem = Diagnostic::error("encoding", format!("`{name}` is encoded in UTF-16"));
        return Err(UnreadableFile::new(problem.hint("save it as UTF-8"), None));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => check_encoding(SourceText::new(name, text)),
        Err(error) => {
            let start = error.valid_up_to();
            let source = SourceText::new(name, String::from_utf8_lossy(bytes));
            let label = source.label(Span::new(start..start + 3), "this byte is not UTF-8");
            let problem =
                Diagnostic::error("encoding", format!("`{name}` is not encoded in UTF-8"))
                    .label(label)
                    .hint("save the file as UTF-8");
            Err(UnreadableFile::new(problem, Some(source)))
        }
    }
}

fn read(path: &Path, name: &str) -> Result<Vec<u8>, Box<Diagnostic>> {
    let unreadable = |error: std::io::Error| {
        Box::new(if error.kind() == ErrorKind::NotFound {
            Diagnostic::error("no-such-file", format!("there is no file `{name}`"))
        } else {
            Diagnostic::error("unreadable-file", format!("cannot read `{name}`: {error}"))
        })
    };
    let file = File::open(path).map_err(unreadable)?;
    let mut bytes = Vec::new();
    // Reading one more byte than allowed also detects a pipe that is too long.
    file.take(MAX_SUITE_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_SUITE_BYTES {
        let limit = MAX_SUITE_BYTES / 1024 / 1024;
        let message = format!("`{name}` is longer than {limit} MiB");
        let problem = Diagnostic::error("file-too-long", message);
        return Err(problem.hint("split it into several suites").into());
    }
    Ok(bytes)
}

/// Refuses a file that declares another encoding, unless it is ASCII only.
fn check_encoding(source: SourceText) -> Result<SourceText, Box<UnreadableFile>> {
    let label = match prepass::declared_encoding(source.text()) {
        Some((encoding, span))
            if !encoding.eq_ignore_ascii_case("utf-8")
                && !encoding.eq_ignore_ascii_case("utf8")
                && !source.text().is_ascii() =>
        {
            source.label(span, "only UTF-8 is supported")
        }
        _ => return Ok(source),
    };
    let problem = Diagnostic::error("encoding", "the file declares an encoding other than UTF-8")
        .label(label)
        .hint("save the file as UTF-8 and write `encoding=\"UTF-8\"`");
    Err(UnreadableFile::new(problem, Some(source)))
}
