//! Suite files → declarations: the predecessor's files, every element and attribute,
//! the schema, invalid files and random texts.

#![expect(clippy::unwrap_used, clippy::expect_used, reason = "that is where a test ends")]

mod any_text;
mod every_attribute;
mod predecessor;
mod problems;
mod schema;

use std::path::{Path, PathBuf};

use rtf_model::Diagnostic;
use rtf_plan::suite::{self, DeclaredSuite, SourceText};

fn data(dir: &str) -> Vec<PathBuf> {
    let dir = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(dir);
    let mut files: Vec<_> = dir.read_dir().unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    assert!(!files.is_empty());
    files
}

fn file(name: &str) -> (DeclaredSuite, Vec<Diagnostic>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data").join(name);
    let source = suite::read_source(&path, name).unwrap();
    let mut problems = Vec::new();
    let suite = suite::parse(&source, &mut problems).unwrap();
    (suite, problems)
}

fn problems(text: &str) -> Vec<Diagnostic> {
    let mut problems = Vec::new();
    let _ = suite::parse(&SourceText::new("s.xml", text), &mut problems);
    problems
}

/// Returns the code and position of each problem.
fn positions(text: &str) -> Vec<(String, u32, u32)> {
    let position = |problem: Diagnostic| {
        let label = problem.labels.first().expect("a position");
        (problem.code.clone(), label.line, label.column)
    };
    problems(text).into_iter().map(position).collect()
}

fn at(code: &str, line: u32, column: u32) -> (String, u32, u32) {
    (code.to_owned(), line, column)
}
