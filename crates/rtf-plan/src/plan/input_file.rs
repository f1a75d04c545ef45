//! The files of the user: suites, and plug-ins that are given directly.

use std::path::PathBuf;

use super::host_kind::HostKind;

#[derive(Debug)]
pub(super) struct InputFile {
    /// The absolute path.
    pub path: PathBuf,
    /// The path as the user would write it.
    pub name: String,
}

/// A plug-in that is given directly: by name, or as a file of a directory.
#[derive(Debug)]
pub(super) struct DirectPlugin {
    pub file: InputFile,
    pub kind: &'static HostKind,
    /// Whether it is a file of an input directory. If it contains no test, it is omitted.
    pub from_dir: bool,
}
