//! Checks references to values of fixtures, and the names of their variables.

use std::collections::BTreeMap;

use rtf_model::{Diagnostic, FixtureProvided};

use super::dependencies::SetupStep;
use crate::suite::{DeclaredFixture, FixtureReference, ReferenceUser, SourceText, Span};
use crate::wording::{suggest, suggest_or};

/// The fixtures of a suite, in the order of the file.
pub(super) struct DeclaredValues<'a> {
    pub fixtures: &'a [DeclaredFixture],
    pub names: &'a [String],
    /// The order of their set-up.
    pub steps: &'a [SetupStep],
}

impl DeclaredValues<'_> {
    /// Reports references that no declared value satisfies.
    pub fn check(
        &self,
        references: &[FixtureReference],
        source: &SourceText,
        problems: &mut Vec<Diagnostic>,
    ) {
        for reference in references {
            if let Some(problem) = self.problem(reference) {
                problems.push(problem.label(source.label(reference.span, "")));
            }
        }
        self.check_variables(source, problems);
    }

    fn problem(&self, reference: &FixtureReference) -> Option<Diagnostic> {
        let FixtureReference { fixture: name, value, user, .. } = reference;
        let Some(index) = self.names.iter().position(|known| known == name) else {
            let message = format!("there is no fixture `{name}`");
            let problem = Diagnostic::error("unknown-fixture-value", message);
            return Some(suggest(problem, name, self.names.iter().map(String::as_str)));
        };
        let provides = &self.fixtures[index].provides;
        if !provides.iter().any(|provide| provide.name.value == *value) {
            let message = format!("the fixture `{name}` declares no value `{value}`");
            let problem = Diagnostic::error("unknown-fixture-value", message);
            let known = provides.iter().map(|provide| provide.name.value.as_str());
            return Some(suggest_or(problem, value, known, |problem| {
                problem.hint(format!("declare it with `<provide name=\"{value}\" …/>`"))
            }));
        }
        let ReferenceUser::Fixture(from) = *user else { return None };
        if from == index {
            let message = format!("the fixture `{name}` cannot use its own value");
            return Some(Diagnostic::error("unknown-fixture-value", message));
        }
        if self.depends_on(from, index) {
            return None;
        }
        let message = format!("the fixture `{}` does not depend on `{name}`", self.names[from]);
        let problem = Diagnostic::error("unknown-fixture-value", message);
        Some(problem.hint(format!("add `{name}` to its `depends`")))
    }

    /// Whether a fixture depends on another one, directly or indirectly.
    fn depends_on(&self, from: usize, on: usize) -> bool {
        let step = |fixture| self.steps.iter().position(|step| step.fixture == fixture);
        let (Some(from), Some(on)) = (step(from), step(on)) else { return true };
        let mut open = self.steps[from].depends.clone();
        // Each step depends on earlier ones only.
        while let Some(step) = open.pop() {
            if step == on {
                return true;
            }
            open.extend(&self.steps[step].depends);
        }
        false
    }

    /// Reports values that would be in the same environment variable.
    fn check_variables(&self, source: &SourceText, problems: &mut Vec<Diagnostic>) {
        let mut variables: BTreeMap<String, (String, Span)> = BTreeMap::new();
        for (fixture, name) in self.fixtures.iter().zip(self.names) {
            for provide in &fixture.provides {
                let (value, span) = (&provide.name.value, provide.name.span);
                let variable = FixtureProvided::variable(name, value);
                let shown = format!("{name}.{value}");
                if let Some((other, first)) = variables.get(&variable) {
                    let message = format!("`{other}` and `{shown}` would both be in `{variable}`");
                    let problem = source
                        .error("repeated-value", span, message)
                        .label(source.label(*first, "the other one"));
                    problems.push(problem);
                    continue;
                }
                variables.insert(variable, (shown, span));
            }
        }
    }
}
