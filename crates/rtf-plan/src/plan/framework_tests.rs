//! The tests of other frameworks in a suite: their attributes, and the checks before the run
//! that list their cases.

use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_model::Diagnostic;

use super::checks::{CheckId, PluginChecks, PluginUse};
use super::framework_kind::{CaseLimits, Forks};
use super::frameworks::{self, FRAMEWORKS};
use super::host_kind::HostKind;
use super::search_scope::SearchScope;
use super::use_site::{PluginRole, UseSite};
use super::{
    CaseListing, CaseSelection, CasesInPrograms, ListedCase, Options, SuitePlan, TestPlan,
    case_patterns,
};
use crate::suite::{DeclaredLimits, DeclaredTest, ForkPoint, SourceText, Spanned, TestIsolation};
use crate::wording::quoted;

/// The hint for a limit of cases that has no effect.
const TEST_LIMIT: &str = "`timeout` limits the whole test";

#[derive(Debug)]
pub(super) struct FrameworkTest {
    kind: &'static HostKind,
    /// The position of its file in the suite.
    site: UseSite,
    /// The variables of the test, without those of a matrix.
    env: Vec<(String, String)>,
    patterns: Option<Spanned<String>>,
    separate: bool,
    fork_at_main: bool,
    /// Its check; `None` before [`FrameworkTests::add_checks`].
    check: Option<CheckId>,
}

impl FrameworkTest {
    /// Returns the test; `None` for the test of a plug-in.
    pub fn new(declared: &DeclaredTest, source: &Arc<SourceText>) -> Option<Self> {
        let kind = frameworks::by_name(&declared.plugin.plugin_type.as_ref()?.value)?;
        let cases = declared.cases.as_deref();
        let isolation = cases.and_then(|cases| cases.isolation.as_ref());
        let fork = cases.and_then(|cases| cases.fork.as_ref());
        // Its combinations share a check: the variables of the matrix come first.
        let parameters = declared.combination.as_ref().map_or(0, |it| it.parameters.len());
        Some(Self {
            kind,
            site: UseSite::Suite(Arc::clone(source), declared.plugin.name.span),
            env: declared.env.iter().skip(parameters).cloned().collect(),
            patterns: cases.and_then(|cases| cases.patterns.clone()),
            separate: isolation.is_some_and(|it| it.value == TestIsolation::Case),
            fork_at_main: fork.is_some_and(|it| it.value == ForkPoint::Main),
            check: None,
        })
    }

    /// Returns the name of a test without `name`: that of its file or directory, without the
    /// extension of its type.
    pub fn default_name(&self, file: &str, suite_dir: &Path) -> String {
        let path: PathBuf = suite_dir.join(file).components().collect();
        let extension = path.extension().and_then(|extension| extension.to_str());
        let is_known = extension.is_some_and(|it| self.kind.extensions.contains(&it));
        let name = if is_known { path.file_stem() } else { path.file_name() };
        name.map_or_else(|| file.to_owned(), |name| name.to_string_lossy().into_owned())
    }

    /// Returns the plan of its cases, before they are listed.
    pub fn plan(&self, limits: DeclaredLimits) -> CasesInPrograms {
        CasesInPrograms {
            case_timeout: limits.case,
            separate: self.separate,
            fork_at_main: self.fork_at_main,
            listed: None,
        }
    }
}

impl FrameworkTest {
    /// Selects cases of the test by its patterns, and of these by the names that the user
    /// gave.
    fn select(&self, test: &mut TestPlan, listed: Option<&[ListedCase]>) -> Vec<Diagnostic> {
        let named = test.cases.take();
        let name = test.matrix().unwrap_or(&test.name).to_owned();
        if let Some(patterns) = &self.patterns {
            let label = |problem: Diagnostic| self.label(problem, patterns);
            let Some(listed) = listed else {
                let message = format!("the cases of the test `{name}` are known only when it runs");
                return vec![label(Diagnostic::error("no-cases", message))];
            };
            match case_patterns::select(&patterns.value, &name, listed) {
                Ok(selected) => test.select_cases(CaseSelection::of_names(selected)),
                Err(problems) => return problems.into_iter().map(label).collect(),
            }
        }
        let Some(named) = named else { return Vec::new() };
        let Some(listed) = listed else {
            test.cases = Some(named);
            return Vec::new();
        };
        let narrowed = test.narrow_cases(*named);
        let unknown = narrowed.unknown.iter();
        let mut problems: Vec<_> =
            unknown.map(|path| case_patterns::unknown_case(path, &name, listed)).collect();
        problems.extend(narrowed.excluded.iter().map(|path| {
            let message = format!("`cases` of the test `{name}` excludes the case `{path}`");
            let problem = Diagnostic::error("conflicting-cases", message);
            match &self.patterns {
                Some(patterns) => self.label(problem, patterns),
                None => problem,
            }
        }));
        problems
    }

    fn label(&self, problem: Diagnostic, patterns: &Spanned<String>) -> Diagnostic {
        match &self.site {
            UseSite::Suite(source, _) => problem.label(source.label(patterns.span, "")),
            UseSite::CommandLine => problem,
        }
    }
}

/// Reports the attributes about cases that the type of a test does not have.
pub(super) fn check_attributes(
    declared: &DeclaredTest,
    framework: Option<&FrameworkTest>,
    source: &SourceText,
) -> Vec<Diagnostic> {
    let Some(cases) = &declared.cases else { return Vec::new() };
    let isolation = cases.isolation.as_ref();
    let separate = isolation.filter(|it| it.value == TestIsolation::Case).map(|it| it.span);
    let shared = isolation.filter(|it| it.value == TestIsolation::Shared).map(|it| it.span);
    let patterns = cases.patterns.as_ref().map(|patterns| patterns.span);
    let fork = cases.fork.as_ref().map(|fork| fork.span);
    let mut problems = Vec::new();
    let mut report = |span, message: String, hint: &str| {
        let problem = Diagnostic::error("not-of-this-type", message).hint(hint);
        problems.push(problem.label(source.label(span, "")));
    };
    let Some(FrameworkTest { kind, .. }) = framework else {
        let attributes = [
            (patterns, "cases", "`rtf run SUITE::TEST/CASE` selects a case of a plug-in"),
            (cases.case_timeout, "case-timeout", TEST_LIMIT),
            (separate, "isolation=\"case\"", "each test already has a separate process"),
            (fork, "fork", "`rtf run --fork` chooses how processes of plug-ins start"),
        ];
        for (span, name, hint) in attributes {
            let Some(span) = span else { continue };
            report(span, format!("`{name}` is only for tests of other frameworks"), hint);
        }
        let types = quoted(FRAMEWORKS.iter().map(|kind| kind.name), ", ");
        let note = format!("their types are {types}");
        return problems.into_iter().map(|problem| problem.note(note.clone())).collect();
    };
    let name = kind.name;
    if let Some(span) = shared {
        let message = format!("a test of type `{name}` cannot share a process");
        report(span, message, "all cases of the test run in one process without `isolation`");
    }
    if kind.framework.is_some_and(|framework| !framework.lists_cases) {
        for (span, attribute) in [(patterns, "cases"), (separate, "isolation=\"case\"")] {
            let Some(span) = span else { continue };
            let message = format!(
                "`{attribute}` needs a list of cases, which a test of type `{name}` does not have"
            );
            report(span, message, "if the program can select tests, use `param`");
        }
    }
    let limits = kind.framework.map_or(CaseLimits::All, |framework| framework.limits);
    if let (Some(span), CaseLimits::None) = (cases.case_timeout, limits) {
        let message = format!("`case-timeout` cannot limit the cases of a test of type `{name}`");
        report(span, message, TEST_LIMIT);
    }
    let forks = kind.framework.map_or(Forks::Never, |framework| framework.forks);
    if let (Some(span), Some((message, hint))) = (fork, fork_problem(forks, separate.is_some())) {
        report(span, message.to_owned(), &hint);
    }
    if let (Some(span), CaseLimits::AnnouncedSubtests) = (cases.case_timeout, limits) {
        let message = format!("`case-timeout` limits only announced subtests of type `{name}`");
        let warning = Diagnostic::warning("without-effect", message).hint(TEST_LIMIT);
        problems.push(warning.label(source.label(span, "")));
    }
    problems
}

/// Why a test cannot have `fork`: the problem and a hint.
fn fork_problem(forks: Forks, is_separate: bool) -> Option<(&'static str, String)> {
    let can_fork = |kind: &&HostKind| kind.framework.is_some_and(|it| it.forks != Forks::Never);
    match forks {
        Forks::Always => None,
        Forks::IfSeparate if is_separate => None,
        Forks::IfSeparate => {
            let hint = "without it, one process runs all cases, and nothing is forked";
            Some(("`fork` needs `isolation=\"case\"`", hint.to_owned()))
        }
        Forks::Never => {
            let types = quoted(FRAMEWORKS.iter().filter(can_fork).map(|kind| kind.name), ", ");
            Some(("`fork` is for programs that can be forked", format!("their types are {types}")))
        }
    }
}

/// The tests of other frameworks in a suite, by the name of the test.
#[derive(Debug, Default)]
pub(super) struct FrameworkTests {
    pub tests: HashMap<String, FrameworkTest>,
}

impl FrameworkTests {
    /// Adds the checks of all tests of the suite. A test that is not selected is not
    /// checked: its framework may have to compile it.
    pub fn add_checks(&mut self, suite: &SuitePlan, options: &Options, checks: &mut PluginChecks) {
        if self.tests.is_empty() {
            return;
        }
        for test in &suite.tests {
            let Some(found) = self.tests.get_mut(&test.name) else { continue };
            let Some(framework) = found.kind.framework else { continue };
            let selects = found.patterns.is_some() || found.separate || test.cases.is_some();
            let is_needed = selects || framework.lists_before_run;
            if options.case_listing == CaseListing::IfNeeded && !is_needed {
                continue;
            }
            let scope = SearchScope {
                runner: &options.runner,
                dir: &suite.folder,
                fallback_dir: None,
                suite_env: &suite.env,
                own_env: &found.env,
            };
            found.check = Some(checks.add(PluginUse {
                host: &test.plugin.host,
                scope: &scope,
                file: &test.plugin.file,
                role: PluginRole::Test,
                site: &found.site,
                optional: false,
                arguments: if framework.lists_cases { &test.plugin.args } else { &[] },
                framework: Some((found.kind.name, framework)),
            }));
        }
    }

    /// Adds the listed cases to the tests of the suite, and selects those that `cases` and
    /// the command line select. Reports unknown ones.
    pub fn add_cases(
        &self,
        suite: &mut SuitePlan,
        found: &HashMap<CheckId, Option<Arc<[ListedCase]>>>,
    ) -> Vec<Diagnostic> {
        let mut problems: Vec<Diagnostic> = Vec::new();
        for test in &mut suite.tests {
            let Some(framework) = self.tests.get(&test.name) else { continue };
            let Some(listed) = framework.check.and_then(|check| found.get(&check)) else {
                continue;
            };
            if let Some(cases) = &mut test.cases_in_programs {
                cases.listed = listed.clone();
            }
            for problem in framework.select(test, listed.as_deref()) {
                // The combinations of a matrix have the same ones.
                if !problems.contains(&problem) {
                    problems.push(problem);
                }
            }
        }
        problems
    }
}
