//! Why a program could not be started.

use std::io::{self, Read as _};
use std::path::Path;

use rtf_model::{INTERPRETER_BYTES, Interpreter};

/// Describes the error of a start: the missing interpreter of a file that exists, which the
/// system reports as if the file were missing; otherwise the error itself.
#[must_use]
pub fn describe(program: &str, error: &io::Error) -> String {
    let is_missing = error.kind() == io::ErrorKind::NotFound;
    match is_missing.then(|| interpreter_problem(Path::new(program))).flatten() {
        Some(problem) => problem,
        None => error.to_string(),
    }
}

fn interpreter_problem(program: &Path) -> Option<String> {
    let mut head = Vec::new();
    let file = std::fs::File::open(program).ok()?;
    file.take(INTERPRETER_BYTES as u64).read_to_end(&mut head).ok()?;
    let problem = Interpreter::of(&head)?.problem(|path| Path::new(path).exists())?;
    Some(format!("{} ({})", problem.message, problem.hint))
}
