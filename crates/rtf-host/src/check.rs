//! `--check FILE…`: what can be said of plug-ins before a run.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;

use crate::unix;

/// What a host found out about a file. One JSON object on a line of the
/// standard output.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct CheckedFile {
    /// The file, as it was given.
    pub file: String,
    /// Whether it could be loaded.
    pub ok: bool,
    /// Why not, with the loader's or interpreter's own words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// Where in the file, from 1.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// `test`, `fixture`; `None` when that cannot be told without running it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kinds: Option<Vec<String>>,
}

impl CheckedFile {
    /// A file that could be loaded.
    #[must_use]
    pub fn good(file: &Path, kinds: Option<Vec<String>>) -> Self {
        let file = file.to_string_lossy().into_owned();
        Self { file, ok: true, message: None, line: None, kinds }
    }

    /// A file that could not.
    #[must_use]
    pub fn bad(file: &Path, message: String, line: Option<u32>) -> Self {
        let file = file.to_string_lossy().into_owned();
        Self { file, ok: false, message: Some(message), line, kinds: None }
    }
}

/// The files that follow `--check`, the first of the program's arguments (its
/// own name not among them); `None` when the host is to serve a runner.
pub fn files_to_check(args: impl IntoIterator<Item = OsString>) -> Option<Vec<PathBuf>> {
    let mut args = args.into_iter();
    (args.next()? == "--check").then(|| args.map(PathBuf::from).collect())
}

/// Looks at each file and prints what was found, in order, each line at once:
/// a file that kills the process is the one whose line is missing. What the
/// plug-ins themselves print goes to the standard error.
///
/// # Errors
/// The standard output cannot be written.
pub fn check(files: &[PathBuf], mut look: impl FnMut(&Path) -> CheckedFile) -> std::io::Result<()> {
    let mut output = unix::divert_stdout()?;
    for file in files {
        let mut line = serde_json::to_vec(&look(file))?;
        line.push(b'\n');
        output.write_all(&line)?;
    }
    Ok(())
}
