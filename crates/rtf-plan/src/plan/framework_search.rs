//! Finds the programs, files and directories of tests of other frameworks.

use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::framework_kind::TestSubject;
use super::program::{chmod_advice, list, searched_path};
use super::search_scope::SearchScope;
use crate::wording::nearest;

/// Finds the path of this exact name. A program without a directory is also searched in
/// `PATH`.
pub(super) fn find(name: &str, subject: TestSubject, scope: &SearchScope<'_>) -> Option<PathBuf> {
    let mut dirs = scope.user_dirs();
    if is_in_path(name, subject) {
        dirs.extend(scope.dirs("PATH"));
    }
    let mut paths = dirs.iter().map(|dir| dir.join(name));
    paths.find(|path| subject.accepts(path)).map(|path| path.components().collect())
}

fn is_in_path(name: &str, subject: TestSubject) -> bool {
    subject == TestSubject::Program && Path::new(name).components().count() == 1
}

/// Reports a missing test with the searched directories. `suggest` adds a similar name,
/// which requires reading these directories.
pub(super) fn not_found(
    name: &str,
    (kind, subject): (&str, TestSubject),
    scope: &SearchScope<'_>,
    suggest: bool,
) -> Diagnostic {
    let dirs = scope.user_dirs();
    let noun = subject.noun();
    if let Some(other) = dirs.iter().map(|dir| dir.join(name)).find(|path| path.exists()) {
        return wrong_kind(name, subject, &other.components().collect::<PathBuf>(), scope);
    }
    let message = format!("there is no {noun} `{name}` for a test of type `{kind}`");
    let problem = Diagnostic::error("no-such-plugin", message);
    let is_absolute = Path::new(name).is_absolute();
    let problem = match is_absolute {
        true => problem,
        false => problem.note(format!("looked for `{name}` in\n{}", list(&dirs))),
    };
    let problem = match is_in_path(name, subject) {
        true => problem.note(searched_path(scope)),
        false => problem,
    };
    match suggest.then(|| similar(name, subject, &dirs)).flatten() {
        Some(near) => problem.hint(format!("did you mean `{near}`?")),
        None if is_absolute => problem,
        None => problem.hint("`RTF_PLUGIN_PATH` adds directories to the search"),
    }
}

/// Reports a path of the wrong kind, such as a directory instead of a program.
fn wrong_kind(
    name: &str,
    subject: TestSubject,
    found: &Path,
    scope: &SearchScope<'_>,
) -> Diagnostic {
    let problem = |message| Diagnostic::error("no-such-plugin", message);
    if subject == TestSubject::Program && found.is_file() {
        return problem(format!("the program `{name}` is not executable"))
            .note(format!("the file is {}", found.display()))
            .hint(chmod_advice(name, found, scope));
    }
    let other = if found.is_dir() { "directory" } else { "file" };
    problem(format!("`{name}` is a {other}, not a {}", subject.noun()))
        .note(format!("found {}", found.display()))
}

/// Returns a similar name in the same directory.
fn similar(name: &str, subject: TestSubject, dirs: &[PathBuf]) -> Option<String> {
    let path = Path::new(name);
    let known: Vec<String> = dirs
        .iter()
        .filter_map(|dir| dir.join(path).parent()?.read_dir().ok())
        .flatten()
        .filter_map(Result::ok)
        .filter(|entry| subject.accepts(&entry.path()))
        .filter_map(|entry| entry.file_name().into_string().ok())
        .collect();
    let near = nearest(path.file_name()?.to_str()?, known.iter().map(String::as_str))?;
    Some(path.with_file_name(near).to_str()?.to_owned())
}
