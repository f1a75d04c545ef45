//! `--check FILE…`: compiles a plug-in without running it.

use std::path::Path;

use mlua::Lua;
use rtf_host::CheckedFile;

use crate::source;

/// Compiles a file.
pub(crate) fn check(file: &Path) -> CheckedFile {
    match source::compile(&Lua::new(), file, &file.to_string_lossy()) {
        Ok(_) => {
            let text = std::fs::read(file).unwrap_or_default();
            CheckedFile::good(file, kinds(&String::from_utf8_lossy(&text)))
        }
        Err(error) => {
            let line = error.location.map(|location| location.line).filter(|&line| line > 0);
            CheckedFile::bad(file, error.message, line)
        }
    }
}

/// The kinds of plug-in in a file: from lines that begin with one of the two tables.
/// A file without such a line may still fill the tables when it runs.
fn kinds(text: &str) -> Option<Vec<String>> {
    let defines = |table: &str| {
        text.lines().any(|line| {
            let line = line.strip_prefix("function ").unwrap_or(line);
            let rest = line.strip_prefix(table).map(str::trim_start);
            rest.is_some_and(|rest| rest.starts_with('.') || rest.starts_with('='))
        })
    };
    let kinds: Vec<_> = [("TestCase", "test"), ("FixtureManager", "fixture")]
        .into_iter()
        .filter(|(table, _)| defines(table))
        .map(|(_, kind)| kind.to_owned())
        .collect();
    (!kinds.is_empty()).then_some(kinds)
}
