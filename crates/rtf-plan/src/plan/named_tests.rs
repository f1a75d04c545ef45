//! The tests and cases that follow `::` on the command line.

use rtf_model::Diagnostic;
use rtf_model::protocol::CaseSelector;

use super::{CaseSelection, CaseSelectionOrigin, SuitePlan, TestPlan};
use crate::wording::suggest_or;

/// Removes all but the named tests of a suite, and selects the named cases of these.
/// Reports unknown names.
///
/// A name is that of a test, of a matrix (which names all its combinations), or of one of
/// these, a slash and the path of a case.
pub(super) fn retain(suite: &mut SuitePlan, names: &[String]) -> Vec<Diagnostic> {
    let named: Vec<_> = names.iter().map(|name| (name, find(suite, name))).collect();
    let problems = named.iter().filter(|(_, found)| found.is_none());
    let problems = problems.map(|(name, _)| unknown_test(suite, name)).collect();
    let named: Vec<_> = named.into_iter().filter_map(|(_, found)| found).collect();
    suite.tests.retain_mut(|test| {
        let cases: Vec<_> =
            named.iter().filter(|(name, _)| is_named(test, name)).map(|(_, case)| *case).collect();
        // A test that is also named without a case runs all its cases.
        if let Some(cases) = cases.iter().copied().collect::<Option<Vec<_>>>() {
            let selectors = cases.into_iter().map(|path| CaseSelector::Equals(path.to_owned()));
            let (selectors, origin) = (selectors.collect(), CaseSelectionOrigin::Named);
            test.select_cases(CaseSelection { selectors, origin });
        }
        !cases.is_empty()
    });
    problems
}

/// Splits a name into the name of a test or a matrix, and the path of a case. The names of
/// tests may contain slashes: the longest one applies.
fn find<'n>(suite: &SuitePlan, name: &'n str) -> Option<(&'n str, Option<&'n str>)> {
    let is_known = |name: &str| suite.tests.iter().any(|test| is_named(test, name));
    if is_known(name) {
        return Some((name, None));
    }
    name.rmatch_indices('/')
        .map(|(at, _)| (&name[..at], Some(&name[at + 1..])))
        .find(|(test, case)| case.is_some_and(|case| !case.is_empty()) && is_known(test))
}

fn is_named(test: &TestPlan, name: &str) -> bool {
    test.name == name || test.matrix() == Some(name)
}

fn unknown_test(suite: &SuitePlan, name: &str) -> Diagnostic {
    let message = format!("there is no test `{name}` in `{}`", suite.file);
    let problem = Diagnostic::error("unknown-test", message);
    let known = suite.tests.iter().map(|test| test.name.as_str());
    let matrices = suite.tests.iter().filter_map(TestPlan::matrix);
    suggest_or(problem, name, known.chain(matrices), |problem| {
        let file = shell_words::quote(&suite.file);
        problem.hint(format!("`rtf list {file}` shows its tests"))
    })
}
