//! CppUnit.
//!
//! A library that is loaded into the program (`LD_PRELOAD`) adds a listener to each
//! `CppUnit::TestResult`, which reports through `RTF_SESSION` and skips tests that are not
//! selected. Programs that link CppUnit statically add the listener in their main function
//! (`rtf/cppunit.hpp`). Tests are not listed before a run: if the library has no effect, the
//! program would run them.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

use super::session_program::SessionReader;
use crate::framework::{
    Framework, Launch, ListError, ListedCase, ReportChannel, ReportReader, TestProgram,
};

const LIBRARY: &str = "librtf-cppunit.so";

const ADD_HEADER: &str = "add `rtf::report_cases(…)` of `rtf/cppunit.hpp` to its main function";

/// The adapter.
#[derive(Clone, Copy, Debug)]
pub struct CppUnit;

impl Framework for CppUnit {
    fn list(&self, _test: &TestProgram) -> Result<Option<Vec<ListedCase>>, ListError> {
        Ok(None)
    }

    fn channel(&self) -> ReportChannel {
        ReportChannel::None
    }

    fn command(&self, launch: &Launch<'_>) -> Result<Command, String> {
        let mut command = Command::new(&launch.test.file);
        command.args(&launch.test.args);
        if let Some(library) = library() {
            let library = preloadable(library, launch.scratch)?;
            command.env("LD_PRELOAD", joined(library.into(), "LD_PRELOAD"));
            // It demands to be the first library.
            let options = joined("verify_asan_link_order=0".into(), "ASAN_OPTIONS");
            command.env("ASAN_OPTIONS", options);
        }
        Ok(command)
    }

    fn reader(&self, _launch: &Launch<'_>) -> Box<dyn ReportReader> {
        let without_report = match library() {
            Some(_) => format!("it does not use CppUnit, or links it statically; {ADD_HEADER}"),
            None => format!("this rtf was built without `{LIBRARY}`; {ADD_HEADER}"),
        };
        Box::new(SessionReader { without_report })
    }
}

/// A list with the user's value of a variable, separated with colons.
fn joined(first: OsString, variable: &str) -> OsString {
    let mut list = first;
    if let Some(user) = std::env::var_os(variable).filter(|user| !user.is_empty()) {
        list.push(":");
        list.push(user);
    }
    list
}

/// A path of the library that `LD_PRELOAD` can contain, which separates paths with blanks and
/// colons.
fn preloadable(library: PathBuf, scratch: &Path) -> Result<PathBuf, String> {
    if !library.to_string_lossy().contains([' ', ':']) {
        return Ok(library);
    }
    let copy = scratch.join(LIBRARY);
    let copied = std::fs::copy(&library, &copy);
    copied.map_err(|error| format!("`{}` cannot be copied: {error}", library.display()))?;
    Ok(copy)
}

/// Finds the library: next to this program, or in the build directory of its source tree.
fn library() -> Option<PathBuf> {
    let program = std::env::current_exe().ok()?;
    let dir = program.parent()?;
    let build = dir.ancestors().map(|dir| dir.join("build"));
    let dirs = std::iter::once(dir.to_path_buf()).chain(build);
    dirs.map(|dir: PathBuf| dir.join(LIBRARY)).find(|library: &PathBuf| Path::is_file(library))
}
