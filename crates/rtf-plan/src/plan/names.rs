//! Unique names.

use std::collections::{HashMap, HashSet};

use rtf_model::Diagnostic;

use crate::suite::{SourceText, Span, Spanned};

/// The names of a suite's tests, fixtures or hooks, or of a run's suites.
#[derive(Debug, Default)]
pub(super) struct UniqueNames {
    taken: HashSet<String>,
    counters: HashMap<String, u32>,
}

impl UniqueNames {
    /// Reserves all names that a file declares, and reports duplicates.
    pub fn reserve<'a>(
        what: &str,
        names: impl Iterator<Item = Option<&'a Spanned<String>>>,
        source: &SourceText,
        problems: &mut Vec<Diagnostic>,
    ) -> Self {
        let mut spans: HashMap<&str, Span> = HashMap::new();
        for name in names.flatten() {
            match spans.get(name.value.as_str()) {
                None => {
                    spans.insert(&name.value, name.span);
                }
                Some(first) => {
                    let message = format!("two {what}s are named `{}`", name.value);
                    let problem = Diagnostic::error("duplicate-name", message)
                        .label(source.label(name.span, "the second one"))
                        .label(source.label(*first, "the first one"))
                        .hint("give one of them another `name`");
                    problems.push(problem);
                }
            }
        }
        let taken = spans.into_keys().map(str::to_owned).collect();
        Self { taken, counters: HashMap::new() }
    }

    /// Returns the first free name of `base`, `base#2`, `base#3`, …
    pub fn unique(&mut self, base: &str) -> String {
        if self.taken.insert(base.to_owned()) {
            return base.to_owned();
        }
        let counter = self.counters.entry(base.to_owned()).or_insert(1);
        loop {
            *counter += 1;
            let name = format!("{base}#{counter}");
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn generated_names_avoid_declared_ones() {
        let source = SourceText::new("a.xml", "");
        let declared = Spanned::new("A#2".to_owned(), Span::default());
        let mut problems = Vec::new();
        let mut names = UniqueNames::reserve(
            "test",
            [Some(&declared), None].into_iter(),
            &source,
            &mut problems,
        );
        assert_eq!(names.unique("A"), "A");
        assert_eq!(names.unique("A"), "A#3");
        assert_eq!(names.unique("A"), "A#4");
        assert_eq!(names.unique("B"), "B");
        assert!(problems.is_empty());
    }
}
