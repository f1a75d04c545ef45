//! The way from paths to an [`Outcome`].

use std::cmp::Reverse;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::{Diagnostic, FixtureId, HookId, Severity, SuiteId, TestId};

use super::context::Context;
use super::inputs::{self, Found, Input};
use super::names::Names;
use super::suite::{Single, plan, plan_singles};
use super::{Plan, SuitePlan, Surroundings};
use crate::suite::{self, Source, Sources};

/// What the user asks for beside the paths.
#[derive(Clone, Debug)]
pub struct Options {
    /// Whether folders inside of given folders are searched.
    pub recursive: bool,
    /// The parameter string of plug-ins that are given directly.
    pub param: String,
    /// The environment string of plug-ins that are given directly.
    pub environment: String,
    /// How often plug-ins that are given directly run; at least once.
    pub repetitions: u32,
    /// How long a host may be silent while it checks a plug-in; `None`: the
    /// plug-ins are not checked.
    pub verify: Option<Duration>,
    /// Where the planner runs.
    pub surroundings: Surroundings,
}

impl Options {
    /// No parameters, one repetition, plug-ins are checked.
    #[must_use]
    pub fn new(surroundings: Surroundings) -> Self {
        Self {
            recursive: false,
            param: String::new(),
            environment: String::new(),
            repetitions: 1,
            verify: Some(Duration::from_secs(30)),
            surroundings,
        }
    }
}

/// What came out of planning.
#[derive(Debug)]
pub struct Outcome {
    /// The plan; `None` when there is an error among the diagnostics.
    pub plan: Option<Plan>,
    /// Everything that is wrong or worth a look: errors first, then in the
    /// order of the files, from top to bottom, then what is about no file.
    pub diagnostics: Vec<Diagnostic>,
    /// The texts that the diagnostics point at.
    pub sources: Sources,
}

/// Plans a run of suites, plug-ins and folders, in any mix.
///
/// Suites run in the order of `paths`; plug-ins that are given directly are
/// gathered into one suite, `plug-ins`, after them. Blocks while the hosts
/// check the plug-ins.
#[must_use]
pub fn build(paths: &[PathBuf], options: &Options) -> Outcome {
    let mut context = Context::new(options);
    let mut sources = Sources::default();
    let surroundings = &options.surroundings;
    let inputs = inputs::collect(paths, options.recursive, surroundings, &mut context.problems);
    let mut suites = Vec::new();
    let mut singles = Vec::new();
    for input in inputs {
        match input {
            Input::Suite(found) => suites.extend(one_suite(&mut context, &found, &mut sources)),
            Input::Plugin { found, kind, from_folder } => {
                singles.push(Single { found, kind, from_folder });
            }
        }
    }
    if singles.is_empty() {
        context.problems.extend(unused(options));
    } else {
        suites.push(plan_singles(&mut context, &singles));
    }
    let left_out = verify(&mut context, &mut suites, &mut sources);
    // Those of files were reported; the gathered one may have lost all of its own.
    suites.retain(|suite| !suite.tests.is_empty());
    if context.problems.iter().all(|problem| problem.severity != Severity::Error)
        && suites.is_empty()
    {
        let problem = Diagnostic::error("no-tests", "there is no test to run");
        let notes = left_out.iter().map(|file| format!("{} holds no test", file.display()));
        context.problems.push(notes.fold(problem, Diagnostic::note));
    }
    outcome(context.problems, suites, sources)
}

fn one_suite(context: &mut Context<'_>, found: &Found, sources: &mut Sources) -> Option<SuitePlan> {
    let source = match suite::open(&found.path, &found.name) {
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
    let suite = suite::load(&source, &mut context.problems);
    let plan = suite.map(|suite| plan(context, found, &source, suite));
    keep(sources, &source, &context.problems[before..]);
    plan
}

/// A text is kept while something may point at it.
fn keep(sources: &mut Sources, source: &Arc<Source>, problems: &[Diagnostic]) {
    // The checks of plug-ins, which come later, hold on to their own places.
    let named = |problem: &Diagnostic| problem.labels.iter().any(|l| l.file == source.name());
    if problems.iter().any(named) || Arc::strong_count(source) > 1 {
        sources.add(Arc::clone(source));
    }
}

/// Options that nothing in this run makes use of.
fn unused(options: &Options) -> Vec<Diagnostic> {
    let given = [
        ("parameter string", !options.param.is_empty()),
        ("environment string", !options.environment.is_empty()),
        ("number of repetitions", options.repetitions > 1),
    ];
    let unused = given.into_iter().filter(|(_, given)| *given);
    unused
        .map(|(what, _)| {
            let message = format!("the {what} has no effect: no plug-in is given directly");
            Diagnostic::warning("without-effect", message)
                .note("tests of a suite have what their suite says")
        })
        .collect()
}

/// Asks the hosts; returns the files of folders that hold no test.
fn verify(
    context: &mut Context<'_>,
    suites: &mut [SuitePlan],
    sources: &mut Sources,
) -> BTreeSet<PathBuf> {
    let Some(limit) = context.options.verify else { return BTreeSet::new() };
    let verified = std::mem::take(&mut context.checks).run(limit);
    context.problems.extend(verified.problems);
    sources.append(verified.sources);
    // Only files of folders are ever left out, and those are in no suite file.
    for suite in suites.iter_mut().filter(|suite| suite.file.is_empty()) {
        suite.tests.retain(|test| !verified.left_out.contains(&test.plugin.file));
    }
    verified.left_out
}

fn outcome(mut problems: Vec<Diagnostic>, suites: Vec<SuitePlan>, mut sources: Sources) -> Outcome {
    sort(&mut problems);
    let files: HashSet<&str> =
        problems.iter().flat_map(|p| &p.labels).map(|label| label.file.as_str()).collect();
    sources.retain(|file| files.contains(file));
    let broken = problems.iter().any(|problem| problem.severity == Severity::Error);
    let plan = (!broken).then(|| number(suites));
    Outcome { plan, diagnostics: problems, sources }
}

/// Errors before warnings; then in the order in which the files came, and
/// within a file from top to bottom.
fn sort(problems: &mut [Diagnostic]) {
    let mut ranks: HashMap<String, usize> = HashMap::new();
    for (index, problem) in problems.iter().enumerate() {
        if let Some(label) = problem.labels.first() {
            ranks.entry(label.file.clone()).or_insert(index);
        }
    }
    // What is about no place in a file comes after all that is.
    let rank = |problem: &Diagnostic| match problem.labels.first() {
        Some(label) => (ranks[&label.file], label.start),
        None => (usize::MAX, 0),
    };
    problems.sort_by_key(|problem| (Reverse(problem.severity), rank(problem)));
}

/// Gives the ids, and each suite a name of its own.
fn number(mut suites: Vec<SuitePlan>) -> Plan {
    let mut names = Names::default();
    let (mut fixtures, mut hooks, mut tests) = (0, 0, 0);
    for (id, suite) in (0..).zip(&mut suites) {
        suite.id = SuiteId(id);
        suite.name = names.unique(&suite.name);
        for fixture in &mut suite.fixtures {
            fixture.id = FixtureId(fixtures);
            fixtures += 1;
        }
        for hook in &mut suite.hooks {
            hook.id = HookId(hooks);
            hooks += 1;
        }
        for test in &mut suite.tests {
            test.id = TestId(tests);
            tests += 1;
        }
    }
    Plan { suites, fixtures, hooks, tests }
}
