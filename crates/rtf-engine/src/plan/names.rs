//! Unique names.

use std::collections::{HashMap, HashSet};

use rtf_model::Diagnostic;

use crate::suite::{Source, Span, Spanned};

/// The names of one suite's tests, of its fixtures, or of a run's suites.
#[derive(Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>,
    counters: HashMap<String, u32>,
}

impl Names {
    /// Takes all names that a file gives itself, before any is made up, and
    /// reports those that it gives twice.
    pub fn given<'a>(
        what: &str,
        names: impl Iterator<Item = Option<&'a Spanned<String>>>,
        source: &Source,
        problems: &mut Vec<Diagnostic>,
    ) -> Self {
        let mut places: HashMap<&str, Span> = HashMap::new();
        for name in names.flatten() {
            match places.get(name.value.as_str()) {
                None => {
                    places.insert(&name.value, name.span);
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
        let taken = places.into_keys().map(str::to_owned).collect();
        Self { taken, counters: HashMap::new() }
    }

    /// Makes up a name: `base`, `base#2`, `base#3`, whichever is free.
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
    fn made_up_names_avoid_given_ones() {
        let source = Source::new("a.xml", "");
        let given = Spanned::new("A#2".to_owned(), Span::default());
        let mut problems = Vec::new();
        let mut names =
            Names::given("test", [Some(&given), None].into_iter(), &source, &mut problems);
        assert_eq!(names.unique("A"), "A");
        assert_eq!(names.unique("A"), "A#3");
        assert_eq!(names.unique("A"), "A#4");
        assert_eq!(names.unique("B"), "B");
        assert!(problems.is_empty());
    }
}
