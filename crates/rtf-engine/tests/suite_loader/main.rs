//! Suite files → what was written: the predecessor's files, every element and
//! attribute, the schema, and whatever else may come.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "that is where a test ends")]

mod any_text;
mod arrives;
mod predecessor;
mod problems;
mod schema;

use std::path::{Path, PathBuf};

use rtf_engine::suite::{self, Source, Suite};
use rtf_model::Diagnostic;

fn data(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(folder);
    let mut files: Vec<_> = folder.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

fn file(name: &str) -> (Suite, Vec<Diagnostic>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    let source = suite::open(&path, name).unwrap();
    let mut problems = Vec::new();
    let suite = suite::load(&source, &mut problems).unwrap();
    (suite, problems)
}

fn problems(text: &str) -> Vec<Diagnostic> {
    let mut problems = Vec::new();
    let _ = suite::load(&Source::new("s.xml", text), &mut problems);
    problems
}

/// Code and place of each problem.
fn places(text: &str) -> Vec<(String, u32, u32)> {
    let place = |problem: Diagnostic| {
        let label = problem.labels.first().expect("a place");
        (problem.code.clone(), label.line, label.column)
    };
    problems(text).into_iter().map(place).collect()
}

fn at(code: &str, line: u32, column: u32) -> (String, u32, u32) {
    (code.to_owned(), line, column)
}
