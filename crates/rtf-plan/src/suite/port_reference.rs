//! `${port:name}`: a reference to a port that is reserved for the suite.
//!
//! `rtf-engine` replaces it by a number when the suite starts.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use super::Span;
use crate::placeholder;

pub(super) const OPEN: &str = "${port:";

/// The ports of a suite: name and first use, by environment variable.
#[derive(Debug, Default)]
pub(super) struct Ports(BTreeMap<String, (String, Span)>);

impl Ports {
    /// Records a use of a port. Returns the name and the first use of the port that already has
    /// this variable.
    pub fn add(&mut self, variable: String, name: &str, span: Span) -> Option<&(String, Span)> {
        match self.0.entry(variable) {
            Entry::Occupied(known) => Some(known.into_mut()),
            Entry::Vacant(new) => {
                new.insert((name.to_owned(), span));
                None
            }
        }
    }

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
    placeholder::replace(text, OPEN, |name| Some(port(name).into()))
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
