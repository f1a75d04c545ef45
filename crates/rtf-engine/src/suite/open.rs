//! From a path to the text of a suite file.

use std::fs::File;
use std::io::{ErrorKind, Read as _};
use std::path::Path;

use rtf_model::Diagnostic;

use super::{Source, Span, prepass};

/// The longest suite file that is read: about 600 000 tests.
pub const MAX_SUITE_BYTES: u64 = 64 * 1024 * 1024;

/// How much of a file is read to see whether it is a suite.
const BEGINNING: u64 = 64 * 1024;

/// Whether a file's first element is `<suite>`, whatever else is wrong with it.
#[must_use]
pub fn is_suite_file(path: &Path) -> bool {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(BEGINNING).read_to_end(&mut bytes));
    read.is_ok() && prepass::root_name(&String::from_utf8_lossy(&bytes)) == Some("suite")
}

/// Why a file cannot be read.
#[derive(Debug)]
pub struct Unreadable {
    /// What is wrong with it.
    pub problem: Diagnostic,
    /// Its text, when the problem points into it.
    pub source: Option<Source>,
}

impl Unreadable {
    fn new(problem: Diagnostic, source: Option<Source>) -> Box<Self> {
        Box::new(Self { problem, source })
    }
}

/// Reads a suite file. `name` is how the user named it.
///
/// # Errors
/// The file is not there, cannot be read, is too long, or is not UTF-8.
pub fn open(path: &Path, name: &str) -> Result<Source, Box<Unreadable>> {
    let bytes = read(path, name).map_err(|problem| Unreadable::new(*problem, None))?;
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(&bytes);
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        let problem = Diagnostic::error("encoding", format!("`{name}` is encoded in UTF-16"));
        return Err(Unreadable::new(problem.hint("save it as UTF-8"), None));
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => check_encoding(Source::new(name, text)),
        Err(error) => {
            let start = error.valid_up_to();
            let source = Source::new(name, String::from_utf8_lossy(bytes));
            let label = source.label(Span::new(start..start + 3), "this byte is not UTF-8");
            let problem =
                Diagnostic::error("encoding", format!("`{name}` is not encoded in UTF-8"))
                    .label(label)
                    .hint("save the file as UTF-8");
            Err(Unreadable::new(problem, Some(source)))
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
    // One byte more than allowed tells a file that is too long, also from a pipe.
    file.take(MAX_SUITE_BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > MAX_SUITE_BYTES {
        let limit = MAX_SUITE_BYTES / 1024 / 1024;
        let message = format!("`{name}` is longer than {limit} MiB");
        let problem = Diagnostic::error("file-too-long", message);
        return Err(problem.hint("split it into several suites").into());
    }
    Ok(bytes)
}

/// A file that says it has another encoding is refused, unless all of it is
/// ASCII, which means the same in all of them.
fn check_encoding(source: Source) -> Result<Source, Box<Unreadable>> {
    let label = match prepass::declared_encoding(source.text()) {
        Some((encoding, span))
            if !encoding.eq_ignore_ascii_case("utf-8")
                && !encoding.eq_ignore_ascii_case("utf8")
                && !source.text().is_ascii() =>
        {
            source.label(span, "only UTF-8 is read")
        }
        _ => return Ok(source),
    };
    let problem = Diagnostic::error("encoding", "the file says that it is not encoded in UTF-8")
        .label(label)
        .hint("save the file as UTF-8 and write `encoding=\"UTF-8\"`");
    Err(Unreadable::new(problem, Some(source)))
}
