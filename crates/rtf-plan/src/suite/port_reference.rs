//! `${port:name}`: a reference to a port that is reserved for the suite.
//!
//! `rtf-engine` replaces it by a number when the suite starts.

use std::collections::BTreeMap;

use rtf_model::{Diagnostic, SuitePort};

use super::reader::ElementReader;
use super::reference::{ReferenceSyntax, position, record_each};
use super::{Span, Spanned};
use crate::placeholder::{Segment, segments};
use crate::wording::nearest;

const OPEN: &str = "${port:";
const SYNTAX: ReferenceSyntax = ReferenceSyntax { open: OPEN, code: "invalid-port" };
const MAX_NAME_LENGTH: usize = 32;

/// The ports of a suite: name and first use, by environment variable.
#[derive(Debug, Default)]
pub(super) struct Ports(BTreeMap<String, (String, Span)>);

impl Ports {
    /// Returns the names, sorted.
    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<_> = self.0.values().map(|(name, _)| name.clone()).collect();
        names.sort();
        names
    }
}

/// Checks whether a text refers to a port, or escapes such a reference.
#[must_use]
pub fn mentions(text: &str) -> bool {
    text.contains(OPEN)
}

/// Replaces each port by the result of `port`, which gets its name.
pub fn expand(text: &str, port: impl Fn(&str) -> String) -> String {
    if !mentions(text) {
        return text.to_owned();
    }
    let mut expanded = String::with_capacity(text.len());
    for segment in segments(text, OPEN) {
        match segment {
            Segment::Text(text) => expanded += text,
            Segment::Placeholder(name, _) => expanded += &port(name),
            Segment::Unclosed(start) => expanded += &text[start..],
        }
    }
    expanded
}

/// Records the ports of a value and reports invalid references.
pub(super) fn check(reader: &mut ElementReader<'_>, what: &str, value: &Spanned<String>) {
    warn_of_misspelling(reader, value);
    record_each(reader, SYNTAX, (what, value), record);
}

fn record(reader: &mut ElementReader<'_>, name: &str, span: Span) {
    let known = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
    let is_valid = name.starts_with(|c: char| c.is_ascii_alphabetic()) && name.chars().all(known);
    if !is_valid || name.len() > MAX_NAME_LENGTH {
        let message = format!("`{name}` is not the name of a port");
        let expected = format!(
            "a name starts with a letter, followed by letters, digits, `-` and `_`: \
             at most {MAX_NAME_LENGTH} characters"
        );
        let label = reader.source.label(span, "");
        let problem = Diagnostic::error("invalid-port", message).label(label).note(expected);
        return reader.report(problem);
    }
    let variable = SuitePort::variable(name);
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
            let problem = Diagnostic::warning("no-port", format!("`${{{word}:` means itself"))
                .label(reader.source.label(span, ""))
                .hint(format!("did you mean `{OPEN}`?"));
            reader.report(problem);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::expand;

    fn filled(text: &str) -> String {
        expand(text, |name| format!("<{name}>"))
    }

    #[test]
    fn all_ports_are_replaced() {
        assert_eq!(filled("--at ${port:a}:${port:b}"), "--at <a>:<b>");
        assert_eq!(filled("${port:sim}"), "<sim>");
        assert_eq!(filled("none"), "none");
    }

    #[test]
    fn other_dollar_signs_are_literal_text() {
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
