//! `--check FILE…`: verifies before a run that plug-ins can be loaded.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::unix;

/// The result for one file: a JSON object on a line of standard output.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CheckedFile {
    /// The file, as it was given.
    pub file: String,
    /// Whether it can be loaded.
    pub ok: bool,
    /// The loader's or interpreter's message, if it cannot.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// The line in the file, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// `test`, `fixture`; `None` if that is unknown before the file runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kinds: Option<Vec<String>>,
}

impl CheckedFile {
    /// A file that can be loaded.
    #[must_use]
    pub fn good(file: &Path, kinds: Option<Vec<String>>) -> Self {
        let file = file.to_string_lossy().into_owned();
        Self { file, ok: true, message: None, line: None, kinds }
    }

    /// A file that cannot be loaded.
    #[must_use]
    pub fn bad(file: &Path, message: String, line: Option<u32>) -> Self {
        let file = file.to_string_lossy().into_owned();
        Self { file, ok: false, message: Some(message), line, kinds: None }
    }
}

/// The files that follow `--check`, the first of the program's arguments (without the
/// program's name); `None` if the host serves a runner.
pub fn files_to_check(args: impl IntoIterator<Item = OsString>) -> Option<Vec<PathBuf>> {
    let mut args = args.into_iter();
    (args.next()? == "--check").then(|| args.map(PathBuf::from).collect())
}

/// Checks each file in order and prints its line immediately, so that a file that kills the
/// process is the one whose line is missing. Output of the plug-ins goes to standard error.
/// A host may report more about a file than [`CheckedFile`].
///
/// # Errors
/// The standard output cannot be written.
pub fn check<T: Serialize>(
    files: &[PathBuf],
    mut check_file: impl FnMut(&Path) -> T,
) -> std::io::Result<()> {
    let mut output = unix::divert_stdout()?;
    for file in files {
        let mut line = serde_json::to_vec(&check_file(file))?;
        line.push(b'\n');
        output.write_all(&line)?;
    }
    Ok(())
}
