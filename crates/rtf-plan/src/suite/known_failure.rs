//! `expect`, `issue` and `until` of a `<test>`: its known failure.

use jiff::civil::Date;
use roxmltree::Node;
use rtf_model::{Diagnostic, Verdict};

use super::reader::ElementReader;
use super::{DeclaredKnownFailure, Spanned};
use crate::wording::{quoted, suggest};

/// The verdicts that a known failure can cover.
const COVERED_VERDICTS: [Verdict; 5] =
    [Verdict::Failed, Verdict::Error, Verdict::Crashed, Verdict::TimedOut, Verdict::Collapsed];

/// Parses a verdict that a known failure can cover.
///
/// # Errors
/// The word is not such a verdict. The diagnostic has no label yet.
pub(crate) fn parse_verdict(word: &str) -> Result<Verdict, Box<Diagnostic>> {
    if let Some(found) = COVERED_VERDICTS.into_iter().find(|known| known.as_str() == word) {
        return Ok(found);
    }
    let known = COVERED_VERDICTS.map(Verdict::as_str);
    let message = format!("`{word}` is not a verdict that can be expected");
    let problem = Diagnostic::error("invalid-value", message)
        .note(format!("the verdicts are {}", quoted(known, ", ")));
    if word == Verdict::Passed.as_str() {
        return Err(problem.hint("without a mark, a test is expected to pass").into());
    }
    Err(suggest(problem, word, known.into_iter()).into())
}

pub(crate) fn parse_day(text: &str) -> Option<Date> {
    // jiff also accepts other forms, such as `20270131`.
    text.parse::<Date>().ok().filter(|day| day.to_string() == text)
}

/// Reads the attributes of a `<test>`.
pub(super) fn read(
    reader: &mut ElementReader<'_>,
    node: Node<'_, '_>,
) -> Option<DeclaredKnownFailure> {
    let names = ["expect", "issue", "until"];
    if !node.attributes().any(|attribute| names.contains(&attribute.name())) {
        return None;
    }
    let issue = reader.word(node, "issue").map(|issue| issue.value);
    let until = reader.word(node, "until").and_then(|text| day(reader, &text));
    let Some(expect) = reader.attribute(node, "expect") else {
        for name in ["issue", "until"] {
            let Some(attribute) = reader.attribute(node, name) else { continue };
            let message = format!("`{name}` has no effect without `expect`");
            let problem = reader
                .error("without-effect", attribute.span, message)
                .hint("add `expect=\"failed\"`");
            reader.report(problem);
        }
        return None;
    };
    let words = reader.words(node, "expect");
    if words.is_empty() {
        reader.wrong("expect", &expect, "is empty", None);
    }
    let mut verdicts = Vec::new();
    for word in words {
        match parse_verdict(&word.value) {
            Ok(verdict) if verdicts.contains(&verdict) => {}
            Ok(verdict) => verdicts.push(verdict),
            Err(problem) => {
                let label = reader.source.label(word.span, "");
                reader.report(problem.label(label));
            }
        }
    }
    Some(DeclaredKnownFailure { verdicts, issue, reason: None, until })
}

fn day(reader: &mut ElementReader<'_>, text: &Spanned<String>) -> Option<Spanned<Date>> {
    let day = parse_day(&text.value);
    if day.is_none() {
        reader.wrong("until", text, "is not a date", Some("write it like `2027-01-31`"));
    }
    Some(Spanned::new(day?, text.span))
}
