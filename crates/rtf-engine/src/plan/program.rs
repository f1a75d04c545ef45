//! Programs that a suite names: `<command>` and `command="…"`.

use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;

use super::hosts;
use super::scope::Scope;
use super::unix::is_executable;
use crate::suite::{Source, Spanned};

/// A command line with its program found; no words when it has none, which
/// was reported.
pub(super) fn command(
    written: Spanned<Vec<String>>,
    scope: &Scope<'_>,
    source: &Source,
    problems: &mut Vec<Diagnostic>,
) -> Vec<String> {
    let mut words = written.value;
    let Some(first) = words.first_mut() else { return words };
    match find(first, scope).and_then(|file| hosts::text(&file)) {
        Ok(file) => *first = file,
        Err(problem) => problems.push(problem.label(source.label(written.span, ""))),
    }
    words
}

/// The name of whatever has a command and no name of its own: the program's,
/// without its folder.
pub(super) fn base_name(command: &[String]) -> &str {
    let program = command.first().map_or("process", String::as_str);
    Path::new(program).file_name().and_then(|name| name.to_str()).unwrap_or(program)
}

/// Finds the program of a command line: with a slash it is a path that starts
/// in the suite's folder, without one it is searched in `PATH`.
pub(super) fn find(name: &str, scope: &Scope<'_>) -> Result<PathBuf, Box<Diagnostic>> {
    if name.contains('/') {
        let files = std::iter::once(scope.folder).chain(scope.beside);
        let mut files = files.map(|folder| folder.join(name).components().collect::<PathBuf>());
        let first = files.next().unwrap_or_default();
        let file = if first.exists() { first } else { files.next().unwrap_or(first) };
        return if is_executable(&file) {
            Ok(file)
        } else if file.is_file() {
            let message = format!("the program `{name}` is not executable");
            let hint = format!("make it so with `chmod +x {name}`");
            Err(Diagnostic::error("no-such-program", message).hint(hint).into())
        } else {
            let message = format!("there is no program `{name}`");
            let note = format!("looked for {}", file.display());
            Err(Diagnostic::error("no-such-program", message).note(note).into())
        };
    }
    in_path(name, scope).ok_or_else(|| {
        let problem = Diagnostic::error("no-such-program", format!("there is no program `{name}`"))
            .note(searched(scope));
        if scope.folder.join(name).is_file() {
            problem.hint(format!("the one in the suite's folder is called `./{name}`")).into()
        } else {
            problem.into()
        }
    })
}

/// The first program of this name in `PATH`.
pub(super) fn in_path(name: &str, scope: &Scope<'_>) -> Option<PathBuf> {
    scope
        .folders("PATH")
        .into_iter()
        .map(|folder| folder.join(name))
        .find(|file| is_executable(file))
}

/// The folders of `PATH`, as a note.
pub(super) fn searched(scope: &Scope<'_>) -> String {
    let folders = scope.folders("PATH");
    if folders.is_empty() {
        return "`PATH` names no folder".to_owned();
    }
    let list: Vec<_> = folders.iter().map(|folder| format!("  {}", folder.display())).collect();
    format!("searched `PATH`:\n{}", list.join("\n"))
}
