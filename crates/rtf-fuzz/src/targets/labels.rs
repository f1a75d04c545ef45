//! The positions of problems lie in the text.

use rtf_model::{Diagnostic, Label, Severity};
use rtf_plan::suite::SourceText;

/// The name of the text in messages.
pub const NAME: &str = "input";

/// What reads a text and reports problems. Returns whether it accepts the text.
pub type Read = fn(&SourceText, &mut Vec<Diagnostic>) -> bool;

/// Checks the problems of a text: their positions, that a rejected text has an error, and that a
/// line break before the text moves all positions by a line.
pub fn check(data: &[u8], read: Read) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // As the reader of files does.
    let text = text.trim_start_matches('\u{feff}');
    let problems = problems(text, read);
    if text.starts_with("<?xml") {
        // Only at the start of the text.
        return;
    }
    let moved = self::problems(&format!("\n{text}"), read).into_iter().map(up);
    let moved: Vec<_> = moved.map(without_end).collect();
    let problems: Vec<_> = problems.into_iter().map(without_end).collect();
    assert_eq!(moved, problems, "after a line break");
}

fn problems(text: &str, read: Read) -> Vec<Diagnostic> {
    let source = SourceText::new(NAME, text);
    let mut problems = Vec::new();
    let is_accepted = read(&source, &mut problems);
    let has_error = problems.iter().any(|problem| problem.severity == Severity::Error);
    assert!(is_accepted || has_error, "rejected without a reason");
    for problem in &problems {
        assert!(!problem.message.is_empty() && !problem.code.is_empty());
        problem.labels.iter().for_each(|label| check_label(text, label));
    }
    problems
}

/// Checks a position without the code that made it.
pub fn check_label(text: &str, label: &Label) {
    let range =
        usize::try_from(label.start).expect("small")..usize::try_from(label.end).expect("small");
    assert!(text.get(range.clone()).is_some(), "{label:?} is outside of the text");
    let before = &text[..range.start];
    let line = before.matches('\n').count() + 1;
    let column = before.rsplit('\n').next().map_or(0, |line| line.chars().count()) + 1;
    assert_eq!((label.line as usize, label.column as usize), (line, column), "{label:?}");
    assert_eq!(label.file, NAME);
}

/// A problem one line and one byte before. One about the whole text stays at its start.
fn up(mut problem: Diagnostic) -> Diagnostic {
    for label in &mut problem.labels {
        if label.start == 0 {
            continue;
        }
        label.line -= 1;
        label.start -= 1;
        label.end -= 1;
    }
    problem
}

/// A problem about the whole text ends where the text does, which a line break changes.
fn without_end(mut problem: Diagnostic) -> Diagnostic {
    for label in problem.labels.iter_mut().filter(|label| label.start == 0) {
        label.end = 0;
    }
    problem
}
