//! What single tests declare for a fixture that `rtf` adds: monitors and faults.

use rtf_model::Diagnostic;

use super::names::UniqueNames;
use crate::suite::{DeclaredFault, DeclaredMonitor, SourceText, Span, Spanned};

/// A monitor or a fault.
pub(super) trait OfTest {
    /// What it is, for messages.
    const WHAT: &'static str;
    /// The position of its tag.
    fn span(&self) -> Span;
    fn name(&self) -> &Spanned<String>;
    /// Whether this is the same declaration, of another combination of a matrix.
    fn is_same(&self, other: &Self) -> bool {
        self.span() == other.span()
    }
}

impl OfTest for DeclaredMonitor {
    const WHAT: &'static str = "monitor";
    fn span(&self) -> Span {
        self.span
    }
    fn name(&self) -> &Spanned<String> {
        &self.name
    }
    fn is_same(&self, other: &Self) -> bool {
        self.span == other.span && self.formula.value == other.formula.value
    }
}

impl OfTest for DeclaredFault {
    const WHAT: &'static str = "fault";
    fn span(&self) -> Span {
        self.span
    }
    fn name(&self) -> &Spanned<String> {
        &self.name
    }
}

/// The declarations of tests, each with the names of its tests. The combinations of a matrix
/// share those that are the same.
#[derive(Debug)]
pub(super) struct OfTests<T>(Vec<(T, Vec<String>)>);

impl<T> Default for OfTests<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl<T: OfTest> OfTests<T> {
    /// Adds the declarations of a test with this name.
    pub fn add(&mut self, test: &str, declared: Vec<T>) {
        for one in declared {
            match self.0.iter_mut().find(|(known, _)| known.is_same(&one)) {
                Some((_, tests)) => tests.push(test.to_owned()),
                None => self.0.push((one, vec![test.to_owned()])),
            }
        }
    }

    /// The declarations of the suite, then those of tests with the names of the tests. Reports
    /// names that are not unique in the suite, or among the declarations for one test.
    pub fn with_suite<'t>(
        &'t self,
        of_suite: &'t [T],
        source: &SourceText,
        problems: &mut Vec<Diagnostic>,
    ) -> impl Iterator<Item = (&'t T, Option<Vec<String>>)> + use<'t, T> {
        let suite_names: Vec<_> = of_suite.iter().map(|one| Some(one.name())).collect();
        UniqueNames::reserve(T::WHAT, suite_names.iter().copied(), source, problems);
        let mut tests: Vec<&[String]> = self.0.iter().map(|(_, tests)| tests.as_slice()).collect();
        tests.dedup();
        for tests in tests {
            let own = self.0.iter().filter(|(_, judged)| judged == tests);
            let own: Vec<_> = own.map(|(one, _)| Some(one.name())).collect();
            let mut found = Vec::new();
            let names = suite_names.iter().chain(&own).copied();
            UniqueNames::reserve(T::WHAT, names, source, &mut found);
            // Those of the suite alone were reported.
            found.retain(|problem| !problems.contains(problem));
            problems.append(&mut found);
        }
        let of_tests = self.0.iter().map(|(one, tests)| (one, Some(tests.clone())));
        of_suite.iter().map(|one| (one, None)).chain(of_tests)
    }
}
