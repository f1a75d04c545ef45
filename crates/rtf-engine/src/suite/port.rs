//! `${port:name}`: where a suite says that it needs a port of its own.
//!
//! Which number it is, is known when the suite starts; see [`crate::isolate`].

use std::collections::BTreeMap;
use std::ops::Range;

use rtf_model::{Diagnostic, OwnPort};

use super::shape::nearest;
use super::value::Reader;
use super::{Span, Spanned};

const OPEN: &str = "${port:";
/// The longest name.
const LONGEST: usize = 32;

/// The ports that a suite names, by the variables that they are found in.
#[derive(Debug, Default)]
pub(super) struct Ports(BTreeMap<String, (String, Span)>);

impl Ports {
    /// Their names, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<_> = self.0.values().map(|(name, _)| name.clone()).collect();
        names.sort();
        names
    }
}

/// A part of a text.
#[derive(Debug, PartialEq, Eq)]
enum Piece<'a> {
    /// What stands for itself.
    Text(&'a str),
    /// The name of a port, and where its `${` begins.
    Port(&'a str, usize),
    /// A `${port:` without its `}`, and where it begins.
    Open(usize),
}

fn pieces(text: &str) -> Vec<Piece<'_>> {
    let mut pieces = Vec::new();
    let mut done = 0;
    while let Some(found) = text[done..].find(OPEN) {
        let start = done + found;
        let inside = start + OPEN.len();
        // `$${port:` stands for `${port:`: the first `$` is dropped.
        if text[done..start].ends_with('$') {
            pieces.push(Piece::Text(&text[done..start - 1]));
            pieces.push(Piece::Text(OPEN));
            done = inside;
            continue;
        }
        pieces.push(Piece::Text(&text[done..start]));
        let Some(length) = text[inside..].find('}') else {
            pieces.push(Piece::Open(start));
            return pieces;
        };
        pieces.push(Piece::Port(&text[inside..inside + length], start));
        done = inside + length + 1;
    }
    pieces.push(Piece::Text(&text[done..]));
    pieces
}

/// Whether a text names a port, or escapes one.
pub(crate) fn mentions(text: &str) -> bool {
    text.contains(OPEN)
}

/// The text with its ports replaced by what `port` says of their names.
pub(crate) fn expand(text: &str, port: impl Fn(&str) -> String) -> String {
    if !mentions(text) {
        return text.to_owned();
    }
    let mut expanded = String::with_capacity(text.len());
    for piece in pieces(text) {
        match piece {
            Piece::Text(text) => expanded += text,
            Piece::Port(name, _) => expanded += &port(name),
            Piece::Open(start) => expanded += &text[start..],
        }
    }
    expanded
}

/// Notes the ports of a value and reports those that are none; whether all are right.
pub(super) fn check(reader: &mut Reader<'_>, what: &str, value: &Spanned<String>) -> bool {
    slips(reader, value);
    let before = reader.problems.len();
    for piece in pieces(&value.value) {
        match piece {
            Piece::Text(_) => {}
            Piece::Open(start) => {
                let span = place(reader, value, start..start + OPEN.len());
                let message = format!("`{OPEN}` in `{what}` is not closed");
                let problem = Diagnostic::error("invalid-port", message)
                    .label(reader.source.label(span, "a `}` is missing after it"))
                    .hint(format!("`${OPEN}` stands for these characters"));
                reader.report(problem);
            }
            Piece::Port(name, start) => {
                let span = place(reader, value, start..start + OPEN.len() + name.len() + 1);
                note(reader, name, span);
            }
        }
    }
    reader.problems.len() == before
}

fn note(reader: &mut Reader<'_>, name: &str, span: Span) {
    let known = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let right = name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(known);
    if !right || name.len() > LONGEST {
        let message = format!("`{name}` is not the name of a port");
        let expected = format!(
            "a name begins with a letter and goes on with letters, digits, `-` and `_`, \
             {LONGEST} at the most"
        );
        let label = reader.source.label(span, "");
        let problem = Diagnostic::error("invalid-port", message).label(label).note(expected);
        return reader.report(problem);
    }
    let variable = OwnPort::variable(name);
    if let Some((other, first)) = reader.ports.0.get(&variable) {
        if other != name {
            let message = format!("the ports `{other}` and `{name}` would both be in `{variable}`");
            let problem = Diagnostic::error("invalid-port", message)
                .label(reader.source.label(span, ""))
                .label(reader.source.label(*first, "the other one"));
            reader.report(problem);
        }
        return;
    }
    reader.ports.0.insert(variable, (name.to_owned(), span));
}

/// `${prot:sim}` was meant to be a port; `${PORT:-5000}` is for a shell.
fn slips(reader: &mut Reader<'_>, value: &Spanned<String>) {
    let text = &value.value;
    for (start, _) in text.match_indices("${") {
        let inside = &text[start + 2..];
        let Some((word, rest)) = inside.split_once(':') else { continue };
        let letters = word.chars().all(|c| c.is_ascii_alphabetic());
        let named = rest.starts_with(|c: char| c.is_ascii_alphabetic());
        let meant = nearest(word, std::iter::once("port")).is_some();
        if word != "port" && letters && named && meant {
            let span = place(reader, value, start..start + 3 + word.len());
            let problem = Diagnostic::warning("no-port", format!("`${{{word}:` means itself"))
                .label(reader.source.label(span, ""))
                .hint(format!("did you mean `{OPEN}`?"));
            reader.report(problem);
        }
    }
}

/// The place of a part of a value: the whole value where entities or line
/// breaks moved it.
fn place(reader: &Reader<'_>, value: &Spanned<String>, part: Range<usize>) -> Span {
    let written = reader.source.text().get(value.span.range()).unwrap_or_default();
    let lead = written.len() - written.trim_start().len();
    if written == value.value {
        value.span.part(part)
    } else if written.trim() == value.value {
        value.span.part(part.start + lead..part.end + lead)
    } else {
        value.span
    }
}

#[cfg(test)]
mod tests {
    use super::expand;

    fn filled(text: &str) -> String {
        expand(text, |name| format!("<{name}>"))
    }

    #[test]
    fn ports_are_replaced_wherever_they_stand() {
        assert_eq!(filled("--at ${port:a}:${port:b}"), "--at <a>:<b>");
        assert_eq!(filled("${port:sim}"), "<sim>");
        assert_eq!(filled("none"), "none");
    }

    #[test]
    fn whatever_else_begins_with_a_dollar_means_itself() {
        for text in ["$HOME ${HOME} ${PORT:-5} $$ ${port} %s $", "${port:open", "é${"] {
            assert_eq!(filled(text), text);
        }
    }

    #[test]
    fn a_second_dollar_escapes() {
        assert_eq!(filled("$${port:a}"), "${port:a}");
        assert_eq!(filled("é$${port:a}${port:b}"), "é${port:a}<b>");
    }
}
