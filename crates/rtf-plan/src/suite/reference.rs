//! Records the references in the values of a suite, `${port:name}` and `${fixture:name.value}`, and
//! reports invalid ones.

use std::ops::Range;

use rtf_model::{Diagnostic, SuitePort};

use super::reader::ElementReader;
use super::{
    FixtureReference, ReferenceUser, Span, Spanned, fixture_reference, port_reference, position_of,
};
use crate::placeholder::{Segment, segments};
use crate::wording::nearest;

struct ReferenceSyntax {
    /// The text that opens a reference: `${port:`.
    open: &'static str,
    /// The code of the diagnostic of an unclosed reference.
    code: &'static str,
}

const PORT: ReferenceSyntax = ReferenceSyntax { open: port_reference::OPEN, code: "invalid-port" };
const FIXTURE_VALUE: ReferenceSyntax =
    ReferenceSyntax { open: fixture_reference::OPEN, code: "invalid-fixture-value" };
const MAX_PORT_NAME_LENGTH: usize = 32;

/// Records the references of a value and reports invalid ones. Returns whether all are valid.
pub(super) fn check(reader: &mut ElementReader<'_>, what: &str, value: &Spanned<String>) -> bool {
    // Most values have no reference.
    if !value.value.contains('$') {
        return true;
    }
    let before = reader.problems.len();
    check_ports(reader, what, value);
    check_fixture_values(reader, what, value);
    reader.problems.len() == before
}

/// Records the ports of a value and reports invalid references.
fn check_ports(reader: &mut ElementReader<'_>, what: &str, value: &Spanned<String>) {
    warn_of_misspelling(reader, value);
    record_each(reader, PORT, (what, value), record_port);
}

fn record_port(reader: &mut ElementReader<'_>, name: &str, span: Span) {
    let known = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let is_valid = name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(known);
    if !is_valid || name.len() > MAX_PORT_NAME_LENGTH {
        let message = format!("`{name}` is not the name of a port");
        let expected = format!(
            "a name starts with a letter, followed by letters, digits, `-` and `_`: \
             at most {MAX_PORT_NAME_LENGTH} characters"
        );
        let problem = reader.error("invalid-port", span, message).note(expected);
        return reader.report(problem);
    }
    let variable = SuitePort::variable(name);
    let same = reader.ports.add(variable.clone(), name, span);
    if let Some((other, first)) = same.filter(|(other, _)| other != name) {
        let message = format!("the ports `{other}` and `{name}` would both be in `{variable}`");
        let other = reader.source.label(*first, "the other one");
        reader.report(reader.source.error("invalid-port", span, message).label(other));
    }
}

/// Warns about `${prot:sim}`, but not about `${PORT:-5000}`, which is shell syntax.
fn warn_of_misspelling(reader: &mut ElementReader<'_>, value: &Spanned<String>) {
    let text = &value.value;
    for (start, _) in text.match_indices("${") {
        let inside = &text[start + 2..];
        let Some((word, rest)) = inside.split_once(':') else { continue };
        let letters = word.chars().all(|c| c.is_ascii_alphabetic());
        let named = rest.starts_with(|c: char| c.is_ascii_alphabetic());
        let similar = nearest(word, std::iter::once("port")).is_some();
        if word != "port" && letters && named && similar {
            let span = position(reader, value, start..start + 3 + word.len());
            let problem = reader
                .source
                .warning("no-port", span, format!("`${{{word}:` means itself"))
                .hint(format!("did you mean `{}`?", port_reference::OPEN));
            reader.report(problem);
        }
    }
}

/// Records the references of a value and reports malformed ones.
fn check_fixture_values(reader: &mut ElementReader<'_>, what: &str, value: &Spanned<String>) {
    if !fixture_reference::mentions(&value.value) {
        return;
    }
    reader.fixture_references.any = true;
    record_each(reader, FIXTURE_VALUE, (what, value), record_fixture_value);
}

fn record_fixture_value(reader: &mut ElementReader<'_>, name: &str, span: Span) {
    let user = reader.user;
    let problem = match name.rsplit_once('.') {
        Some((fixture, value)) if user != ReferenceUser::Suite => {
            let (fixture, value) = (fixture.to_owned(), value.to_owned());
            let reference = FixtureReference { fixture, value, span, user };
            return reader.fixture_references.found.push(reference);
        }
        Some(_) => {
            let message = "a suite's own settings cannot use the value of a fixture: they also \
                           apply to its fixtures";
            Diagnostic::error("invalid-fixture-value", message)
                .hint("write it in the tests and hooks that need it")
        }
        None => {
            let message = format!("`{name}` names no value of a fixture");
            Diagnostic::error("invalid-fixture-value", message)
                .hint(format!("write `{}NAME.VALUE}}`", fixture_reference::OPEN))
        }
    };
    let label = reader.source.label(span, "");
    reader.report(problem.label(label));
}

/// Passes the name and the position of each reference to `record`, and reports an unclosed one.
fn record_each(
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

fn position(reader: &ElementReader<'_>, value: &Spanned<String>, part: Range<usize>) -> Span {
    position_of(reader.source, value, part)
}
