//! Plans a run from its input paths.

use std::cmp::Reverse;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

use rtf_model::{Diagnostic, Severity};

use super::checks::{CheckAnswer, CheckGroup, PluginChecks};
use super::context::{PlanContext, parent_dir};
use super::framework_tests::FrameworkTests;
use super::input_file::{DirectPlugin, InputFile};
use super::inputs::{self, ResolvedInput};
use super::matrix::MatrixExpander;
use super::named_tests;
use super::names::UniqueNames;
use super::suite::{SuiteDraft, plan_direct_plugins, plan_suite};
use super::{Compatibility, InputPath, Options, Plan, SuitePlan};
use crate::config;
use crate::suite::{self, SourceMap, SourceText};

#[derive(Debug)]
pub struct PlanOutcome {
    /// The plan; `None` if there is an error among the diagnostics.
    pub plan: Option<Plan>,
    /// All errors, then all warnings. Each in the order of the files, from top to
    /// bottom, and then those without a position.
    pub diagnostics: Vec<Diagnostic>,
    pub sources: SourceMap,
}

/// A plan whose plug-ins have not been checked yet.
#[derive(Debug)]
pub struct PlanDraft {
    suites: Vec<SuiteDraft>,
    problems: Vec<Diagnostic>,
    sources: SourceMap,
    checks: PluginChecks,
}

impl PlanDraft {
    #[must_use]
    pub fn check_groups(&self) -> &[CheckGroup] {
        self.checks.groups()
    }

    /// Whether the plan is the same without the hosts' answers: those about other frameworks list
    /// their cases, the others only problems.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.check_groups().iter().all(|group| !group.lists_cases())
    }

    /// Completes the plan with the hosts' answers: one list for each of
    /// [`PlanDraft::check_groups`], with one answer for each of its files.
    #[must_use]
    pub fn finish(mut self, answers: Vec<Vec<CheckAnswer>>) -> PlanOutcome {
        let findings = self.checks.diagnose(answers);
        self.problems.extend(findings.problems);
        self.sources.append(findings.sources);
        for SuiteDraft { plan, frameworks } in &mut self.suites {
            self.problems.extend(frameworks.add_cases(plan, &findings.cases));
        }
        let mut suites: Vec<SuitePlan> = self.suites.into_iter().map(|suite| suite.plan).collect();
        // Only files of input directories can be omitted, and those belong to no suite file.
        for suite in suites.iter_mut().filter(|suite| suite.file.is_empty()) {
            suite.tests.retain(|test| !findings.omitted.contains(&test.plugin.file));
        }
        // A suite file without tests was reported; the suite of plug-ins may have become empty.
        suites.retain(|suite| !suite.tests.is_empty());
        if self.problems.iter().all(|problem| problem.severity != Severity::Error)
            && suites.is_empty()
        {
            let problem = Diagnostic::error("no-tests", "there is no test to run");
            let notes =
                findings.omitted.iter().map(|file| format!("{} contains no test", file.display()));
            self.problems.push(notes.fold(problem, Diagnostic::note));
        }
        outcome(self.problems, suites, self.sources)
    }

    /// Completes the plan without checking the plug-ins.
    #[must_use]
    pub fn unchecked(self) -> PlanOutcome {
        self.finish(Vec::new())
    }
}

/// Plans a run of suites, plug-ins and directories, in any mix. Starts no process.
///
/// Suites run in the order of `inputs`, followed by a suite named `plug-ins` that
/// contains the plug-ins that are given directly.
#[must_use]
pub fn draft(inputs: &[InputPath], options: &Options) -> PlanDraft {
    let mut context = PlanContext::new(options);
    let mut sources = SourceMap::default();
    let mut suites = Vec::new();
    let mut direct_plugins = Vec::new();
    for input in inputs::resolve(inputs, options, &mut context.problems) {
        match input {
            ResolvedInput::Suite { file, only } => {
                let mut suite = suite_from_file(&mut context, &file, &mut sources);
                if let Some(suite) = &mut suite {
                    if !only.is_empty() {
                        context.problems.extend(named_tests::retain(&mut suite.plan, &only));
                    }
                    let SuiteDraft { plan, frameworks } = suite;
                    frameworks.add_checks(plan, options, &mut context.checks);
                }
                suites.extend(suite);
            }
            ResolvedInput::Plugin(plugin) => direct_plugins.push(plugin),
        }
    }
    add_direct_plugins(&mut context, direct_plugins, &mut suites);
    report_config_problems(&mut context, inputs, &mut sources);
    PlanDraft { suites, problems: context.problems, sources, checks: context.checks }
}

/// Adds suites with the plug-ins that are given directly.
fn add_direct_plugins(
    context: &mut PlanContext<'_>,
    plugins: Vec<DirectPlugin>,
    suites: &mut Vec<SuiteDraft>,
) {
    let options = context.options;
    let has_options = |plugin: &DirectPlugin| options.apply_to_plugin(plugin.from_dir);
    if !plugins.iter().any(has_options) {
        context.problems.extend(warn_of_unused(options));
    }
    let (groups, index) = match options.compatibility {
        Compatibility::Native => (vec![plugins], suites.len()),
        Compatibility::Predecessor => {
            let (named, found) = plugins.into_iter().partition(has_options);
            (vec![named, found], 0)
        }
    };
    let groups = groups.iter().filter(|group| !group.is_empty());
    let planned: Vec<_> = groups
        .map(|group| {
            let mut plan = plan_direct_plugins(context, group);
            context.quarantine(&options.runner.current_dir, &mut plan);
            SuiteDraft { plan, frameworks: FrameworkTests::default() }
        })
        .collect();
    suites.splice(index..index, planned);
}

/// Reports the problems of all `rtf.toml` files, also of those without a suite.
fn report_config_problems(
    context: &mut PlanContext<'_>,
    inputs: &[InputPath],
    sources: &mut SourceMap,
) {
    let Options { runner, config_request, .. } = context.options;
    for input in inputs {
        let path = runner.absolute(input.path());
        context.files.find_nearest(&config::input_dir(&path));
    }
    context.problems.append(&mut context.files.problems);
    context.problems.append(&mut context.quarantines.warnings(context.options.today));
    context.problems.extend(config_request.check_profile(&context.files));
    sources.append(context.files.sources());
}

fn suite_from_file(
    context: &mut PlanContext<'_>,
    file: &InputFile,
    sources: &mut SourceMap,
) -> Option<SuiteDraft> {
    let source = match suite::read_source(&file.path, &file.name) {
        Ok(source) => Arc::new(source),
        Err(unreadable) => {
            context.problems.push(unreadable.problem);
            if let Some(source) = unreadable.source {
                sources.add(Arc::new(source));
            }
            return None;
        }
    };
    let before = context.problems.len();
    let mut suite = suite::parse(&source, &mut context.problems);
    if let Some(suite) = &mut suite {
        let dir = parent_dir(&file.path);
        let tests = std::mem::take(&mut suite.tests);
        suite.tests =
            MatrixExpander::new(&dir, &source, &mut context.problems, sources).expand(tests);
        context.configure(&dir, &source, suite);
    }
    let mut draft = suite.map(|suite| plan_suite(context, file, &source, suite));
    context.sources.drain(..).for_each(|source| sources.add(source));
    if let Some(draft) = &mut draft {
        context.quarantine(&parent_dir(&file.path), &mut draft.plan);
    }
    add_if_used(sources, &source, &context.problems[before..]);
    draft
}

/// Adds a text if a diagnostic refers to it, or if a plug-in check may still do so.
fn add_if_used(sources: &mut SourceMap, source: &Arc<SourceText>, problems: &[Diagnostic]) {
    let refers = |problem: &Diagnostic| problem.labels.iter().any(|l| l.file == source.name());
    if problems.iter().any(refers) || Arc::strong_count(source) > 1 {
        sources.add(Arc::clone(source));
    }
}

/// Warns about options that apply to nothing in this run.
fn warn_of_unused(options: &Options) -> Vec<Diagnostic> {
    let set = [
        ("parameter string", !options.param.is_empty()),
        ("environment string", !options.environment.is_empty()),
        ("number of repetitions", options.repetitions > 1),
    ];
    let unused = set.into_iter().filter(|(_, is_set)| *is_set);
    unused
        .map(|(what, _)| {
            let message = format!("the {what} has no effect: no plug-in is given directly");
            Diagnostic::warning("without-effect", message)
                .note("a suite file defines these values for its tests")
        })
        .collect()
}

fn outcome(
    mut problems: Vec<Diagnostic>,
    mut suites: Vec<SuitePlan>,
    mut sources: SourceMap,
) -> PlanOutcome {
    sort(&mut problems);
    let files: HashSet<&str> =
        problems.iter().flat_map(|p| &p.labels).map(|label| label.file.as_str()).collect();
    sources.retain(|file| files.contains(file));
    let has_errors = problems.iter().any(|problem| problem.severity == Severity::Error);
    let plan = (!has_errors).then(|| {
        let mut names = UniqueNames::default();
        for suite in &mut suites {
            suite.name = names.unique(&suite.name);
        }
        Plan::new(suites)
    });
    PlanOutcome { plan, diagnostics: problems, sources }
}

/// Sorts by severity, then by file in the order of the inputs, then by position.
fn sort(problems: &mut [Diagnostic]) {
    let mut ranks: HashMap<String, usize> = HashMap::new();
    for (index, problem) in problems.iter().enumerate() {
        if let Some(label) = problem.labels.first() {
            ranks.entry(label.file.clone()).or_insert(index);
        }
    }
    let rank = |problem: &Diagnostic| match problem.labels.first() {
        Some(label) => (ranks[&label.file], label.start),
        None => (usize::MAX, 0),
    };
    problems.sort_by_key(|problem| (Reverse(problem.severity), rank(problem)));
}
