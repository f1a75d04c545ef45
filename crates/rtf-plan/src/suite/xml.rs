//! Parses XML and turns the parser's errors into diagnostics.

use roxmltree::{Document, Error, ParsingOptions, TextPos};
use rtf_model::Diagnostic;

use super::prepass::{self, Scan};
use super::{SourceText, Span};

/// Runs the pre-pass and reports its findings; `None` if the file is refused.
pub(super) fn prepare<'a>(
    source: &'a SourceText,
    problems: &mut Vec<Diagnostic>,
) -> Option<Scan<'a>> {
    let scan = prepass::scan(source.text());
    if let Some(first) = scan.dashes.first() {
        problems.push(dashes_warning(source, *first, scan.dashes.len()));
    }
    if let Some(span) = scan.doctype {
        let problem = Diagnostic::error("doctype", "the file cannot have a DTD")
            .label(source.label(span, "refused for safety"))
            .hint("remove the `<!DOCTYPE …>`");
        problems.push(problem);
    }
    if let Some(span) = scan.too_many_attributes {
        let problem =
            Diagnostic::error("too-many-attributes", "too many attributes on one element");
        problems.push(problem.label(source.label(span, "")));
    }
    (scan.doctype.is_none() && scan.too_many_attributes.is_none()).then_some(scan)
}

/// Parses the text that [`prepare`] returned.
pub(super) fn parse<'a>(
    source: &SourceText,
    text: &'a str,
    problems: &mut Vec<Diagnostic>,
) -> Option<Document<'a>> {
    let options = ParsingOptions { allow_dtd: false, ..ParsingOptions::default() };
    match Document::parse_with_options(text, options) {
        Ok(document) => Some(document),
        Err(error) => {
            problems.push(malformed(source, text, &error));
            None
        }
    }
}

fn dashes_warning(source: &SourceText, first: Span, count: usize) -> Diagnostic {
    let problem = source
        .warning("comment-dashes", first, "`--` in a comment is not legal XML; accepted")
        .hint("remove the dashes: other programs refuse the file");
    match count {
        1 => problem,
        2 => problem.note("one more comment of this file contains it"),
        _ => problem.note(format!("{} more comments of this file contain it", count - 1)),
    }
}

fn malformed(source: &SourceText, text: &str, error: &Error) -> Diagnostic {
    let start = match error {
        Error::UnclosedRootNode | Error::NoRootNode | Error::UnexpectedEndOfStream => {
            text.trim_end().len()
        }
        _ => offset(text, error.pos()),
    };
    let length = text[start..].chars().next().map_or(0, char::len_utf8);
    let (message, hint) = match second_root(error, text, start) {
        Some(message) => (message, Some(ONE_ROOT)),
        None => (explanation(error, &text[..start]), hint(error, &text[..start])),
    };
    let problem = source.error("malformed-xml", Span::new(start..start + length), message);
    Diagnostic { hint: hint.map(str::to_owned), ..problem }
}

/// What to do about further elements or text after the first element.
const ONE_ROOT: &str = "an XML file has one element that contains all others: for several suites, \
                        write several files";

/// The message for what follows the first element, or precedes it.
fn second_root(error: &Error, text: &str, start: usize) -> Option<String> {
    let Error::UnknownToken(_) = error else { return None };
    let rest = &text[start..];
    let is_name = |c: char| c.is_alphanumeric() || matches!(c, '_' | '-' | ':' | '.');
    let name = rest.strip_prefix('<').map(|rest| rest.split(|c| !is_name(c)).next().unwrap_or(""));
    match name {
        Some("") => None,
        Some(name) => Some(format!("malformed XML: a second first element, `<{name}>`")),
        None => Some("malformed XML: text outside of the first element".into()),
    }
}

/// What to write instead. A `<` after a text looks like the start of an element.
fn hint(error: &Error, before: &str) -> Option<&'static str> {
    let (Error::InvalidChar(..) | Error::InvalidChar2(..)) = error else { return None };
    let (text, element) = before.split_at(before.rfind('<').unwrap_or_default());
    let text = text.trim_end();
    if !text.is_empty() && !text.ends_with('>') && !element.starts_with("</") {
        return Some("a `<` that begins no element is written `&lt;`");
    }
    match error {
        Error::InvalidChar(b'=', ..) | Error::InvalidChar2("a quote", ..) => {
            Some("an attribute has a value in quotes: `name=\"value\"`")
        }
        Error::InvalidChar2("a whitespace", ..) if before.ends_with(['"', '\'']) => {
            Some("a blank separates attributes; a quote in a value is written `&quot;` or `&apos;`")
        }
        _ => None,
    }
}

/// Describes the error without its position, which is in the label.
fn explanation(error: &Error, before: &str) -> String {
    match error {
        Error::InvalidName(_) if before.ends_with('<') => {
            "malformed XML: `<` in a text must be written `&lt;`".into()
        }
        Error::UnexpectedCloseTag(open, close, _) => {
            format!("malformed XML: expected `</{open}>`, found `</{close}>`")
        }
        Error::UnclosedRootNode => {
            "malformed XML: the file ends before its first element is closed".into()
        }
        Error::NoRootNode => "malformed XML: the file contains no element".into(),
        Error::UnexpectedEndOfStream => "malformed XML: the file ends too early".into(),
        Error::DuplicatedAttribute(name, _) => {
            format!("malformed XML: duplicate attribute `{name}`")
        }
        Error::InvalidAttributeValue(_) => {
            "malformed XML: `<` in a value must be written `&lt;`".into()
        }
        Error::MalformedEntityReference(_) => "malformed XML: `&` must be written `&amp;`".into(),
        Error::UnknownEntityReference(name, _) => {
            format!("malformed XML: unknown entity `&{name};`; a plain `&` is written `&amp;`")
        }
        other => {
            let text = other.to_string();
            let position = format!(" at {}", other.pos());
            format!("malformed XML: {}", text.replacen(&position, "", 1))
        }
    }
}

/// Returns the byte offset of the parser's row and column, which start at 1.
fn offset(text: &str, at: TextPos) -> usize {
    let mut start = 0;
    for line in text.split_inclusive('\n').take(at.row.saturating_sub(1) as usize) {
        start += line.len();
    }
    let column = at.col.saturating_sub(1) as usize;
    text[start..].char_indices().nth(column).map_or(text.len(), |(offset, _)| start + offset)
}
