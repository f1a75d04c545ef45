//! Finds the programs of `<command>` and `command="…"`.

use std::io::Read as _;
use std::path::{Path, PathBuf};

use rtf_model::{Diagnostic, INTERPRETER_BYTES, Interpreter};

use super::search_scope::SearchScope;
use super::unix::is_executable;
use crate::suite::{SourceText, Spanned};

/// Resolves the program of a command line and reports it if it is missing.
/// Without words, which was reported before, returns no words.
pub(super) fn command(
    declared: Spanned<Vec<String>>,
    scope: &SearchScope<'_>,
    source: &SourceText,
    problems: &mut Vec<Diagnostic>,
) -> Vec<String> {
    let mut words = declared.value;
    let Some(first) = words.first_mut() else { return words };
    match find(first, scope).and_then(|file| utf8(&file)) {
        Ok(file) => *first = file,
        Err(problem) => problems.push(problem.label(source.label(declared.span, ""))),
    }
    words
}

/// Returns the default name of a fixture or hook with a command: its program's
/// name without the directory.
pub(super) fn base_name(command: &[String]) -> &str {
    let program = command.first().map_or("process", String::as_str);
    Path::new(program).file_name().and_then(|name| name.to_str()).unwrap_or(program)
}

/// Finds a program. A name with a slash is a path relative to the suite's
/// directory; any other name is searched in `PATH`.
pub(super) fn find(name: &str, scope: &SearchScope<'_>) -> Result<PathBuf, Box<Diagnostic>> {
    if name.contains('/') {
        let dirs = std::iter::once(scope.dir).chain(scope.fallback_dir);
        let mut files = dirs.map(|dir| dir.join(name).components().collect::<PathBuf>());
        let first = files.next().unwrap_or_default();
        let file = if first.exists() { first } else { files.next().unwrap_or(first) };
        return if is_executable(&file) {
            interpreter_problem(name, &file, scope).map_or(Ok(file), Err)
        } else if file.is_file() {
            let message = format!("the program `{name}` is not executable");
            let advice = chmod_advice(name, &file, scope);
            Err(Diagnostic::error("no-such-program", message).hint(advice).into())
        } else {
            let note = format!("looked for {}", file.display());
            Err(no_such_program(name).note(note).into())
        };
    }
    let found = in_path(name, scope).ok_or_else(|| {
        let problem = no_such_program(name).note(searched_path(scope));
        if scope.dir.join(name).is_file() {
            problem.hint(format!("use `./{name}` for the one in the suite's directory")).into()
        } else {
            Box::new(problem)
        }
    })?;
    interpreter_problem(name, &found, scope).map_or(Ok(found), Err)
}

/// How to make a file executable: with its name, if that is its path in the user's directory.
pub(super) fn chmod_advice(name: &str, file: &Path, scope: &SearchScope<'_>) -> String {
    let is_here = scope.runner.absolute(Path::new(name)) == file;
    let path = if is_here { name.into() } else { file.to_string_lossy() };
    format!("make it executable with `chmod +x {}`", shell_words::quote(&path))
}

/// Reports a program whose interpreter is missing, or that has line ends of Windows: the system
/// would say that the program does not exist.
pub(super) fn interpreter_problem(
    name: &str,
    file: &Path,
    scope: &SearchScope<'_>,
) -> Option<Box<Diagnostic>> {
    let interpreter = Interpreter::of(&head(file)?)?;
    let problem = |why: String| {
        let message = format!("the program `{name}` cannot be started: {why}");
        Diagnostic::error("no-interpreter", message).note(format!("the file is {}", file.display()))
    };
    if let Some(found) = interpreter.problem(|path| Path::new(path).exists()) {
        return Some(Box::new(problem(found.message).hint(found.hint)));
    }
    let searched = interpreter.searched.filter(|searched| in_path(searched, scope).is_none())?;
    let problem = problem(format!("there is no program `{searched}`, its interpreter"));
    Some(Box::new(problem.note(searched_path(scope))))
}

fn head(file: &Path) -> Option<Vec<u8>> {
    let mut head = Vec::new();
    let file = std::fs::File::open(file).ok()?;
    file.take(INTERPRETER_BYTES as u64).read_to_end(&mut head).ok()?;
    Some(head)
}

fn no_such_program(name: &str) -> Diagnostic {
    Diagnostic::error("no-such-program", format!("there is no program `{name}`"))
}

/// Finds the first program of this name in `PATH`.
pub(super) fn in_path(name: &str, scope: &SearchScope<'_>) -> Option<PathBuf> {
    scope.dirs("PATH").into_iter().map(|dir| dir.join(name)).find(|file| is_executable(file))
}

/// Returns a note with the directories of `PATH`.
pub(super) fn searched_path(scope: &SearchScope<'_>) -> String {
    match list(&scope.dirs("PATH")) {
        list if list.is_empty() => "`PATH` contains no directory".to_owned(),
        list => format!("searched `PATH`:\n{list}"),
    }
}

/// Formats directories as lines of a note.
pub(super) fn list(dirs: &[PathBuf]) -> String {
    let lines: Vec<_> = dirs.iter().map(|dir| format!("  {}", dir.display())).collect();
    lines.join("\n")
}

/// Converts a path for a command line or for the protocol, which are UTF-8.
pub(super) fn utf8(path: &Path) -> Result<String, Box<Diagnostic>> {
    path.to_str().map(str::to_owned).ok_or_else(|| {
        let message = format!("the path `{}` is not UTF-8", path.display());
        Diagnostic::error("path-encoding", message).into()
    })
}
