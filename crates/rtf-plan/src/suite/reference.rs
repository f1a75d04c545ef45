//! References in the values of a suite: `${port:name}` and `${fixture:name.value}`.

use std::ops::Range;

use rtf_model::Diagnostic;

use super::reader::ElementReader;
use super::{Span, Spanned, fixture_reference, port_reference, position_of};
use crate::placeholder::{Segment, segments};

/// A kind of reference.
pub(super) struct ReferenceSyntax {
    /// The text that opens a reference: `${port:`.
    pub open: &'static str,
    /// The code of the diagnostic of an unclosed reference.
    pub code: &'static str,
}

/// Records the references of a value and reports invalid ones. Returns whether all are valid.
pub(super) fn check(reader: &mut ElementReader<'_>, what: &str, value: &Spanned<String>) -> bool {
    // Most values have no reference.
    if !value.value.contains('$') {
        return true;
    }
    let before = reader.problems.len();
    port_reference::check(reader, what, value);
    fixture_reference::check(reader, what, value);
    reader.problems.len() == before
}

/// Passes the name and the position of each reference to `record`, and reports an unclosed one.
pub(super) fn record_each(
    reader: &mut ElementReader<'_>,
    ReferenceSyntax { open, code }: ReferenceSyntax,
    (what, value): (&str, &Spanned<String>),
    record: impl Fn(&mut ElementReader<'_>, &str, Span),
) {
    for segment in segments(&value.value, open) {
        match segment {
            Segment::Text(_) => {}
            Segment::Unclosed(start) => {
                let span = position(reader, value, start..start + open.len());
                let message = format!("`{open}` in `{what}` is not closed");
                let problem = Diagnostic::error(code, message)
                    .label(reader.source.label(span, "a `}` is missing after it"))
                    .hint(format!("`${open}` stands for these characters"));
                reader.report(problem);
            }
            Segment::Placeholder(name, start) => {
                let span = position(reader, value, start..start + open.len() + name.len() + 1);
                record(reader, name, span);
            }
        }
    }
}

/// Replaces each reference by a number, to check the syntax of the rest.
pub(super) fn example(text: &str) -> String {
    let example = port_reference::expand(text, |_| "1".to_owned());
    fixture_reference::expand(&example, |_| Some("1".into()))
}

/// Checks whether a text contains a reference.
pub(super) fn is_in(text: &str) -> bool {
    port_reference::mentions(text) || fixture_reference::mentions(text)
}

/// Returns the position of a part of a value.
pub(super) fn position(
    reader: &ElementReader<'_>,
    value: &Spanned<String>,
    part: Range<usize>,
) -> Span {
    position_of(reader.source, value, part)
}
