//! The way from paths to an [`Outcome`].

use std::cmp::Reverse;
use std::collections::{BTreeSet, HashMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

use rtf_model::{Diagnostic, Severity};

use super::context::{Context, folder_of};
use super::inputs::{self, Found, Input};
use super::names::Names;
use super::suite::{Single, plan, plan_singles};
use super::{Plan, SuitePlan, Surroundings};
use crate::config::{self, Asked};
use crate::suite::{self, Source, Sources};

/// What the user asks for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Request {
    /// A suite, a plug-in, or a folder of either: the path tells.
    Any(PathBuf),
    /// A plug-in, by its path, or by its name as in a suite.
    Plugin(PathBuf),
    /// The plug-ins of a folder.
    Plugins(PathBuf),
    /// A suite file.
    Suite(PathBuf),
    /// The suites of a folder.
    Suites(PathBuf),
}

impl Request {
    /// The path, as the user gave it.
    fn path(&self) -> &Path {
        match self {
            Self::Any(path)
            | Self::Plugin(path)
            | Self::Plugins(path)
            | Self::Suite(path)
            | Self::Suites(path) => path,
        }
    }
}

/// By whose rules names are looked up and options apply.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Manner {
    /// Ours: a suite's names start in its folder, where its processes work.
    #[default]
    Own,
    /// robot-testing-framework 2.x's: a suite's names start in the current
    /// folder, where all processes work, and only then in the suite's; plug-ins
    /// run before suites; parameters, environment and repetitions are for the
    /// plug-ins that were named, not for those of folders. No `rtf.toml` holds.
    Predecessor,
}

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
    /// By whose rules.
    pub manner: Manner,
    /// Where the planner runs.
    pub surroundings: Surroundings,
    /// The profile and the parameters.
    pub asked: Asked,
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
            manner: Manner::default(),
            surroundings,
            asked: Asked::default(),
        }
    }
}

impl Options {
    /// Whether parameters, environment and repetitions are for plug-ins that
    /// are in no suite file, and lie in a folder that was given or were named.
    pub(super) fn are_for(&self, from_folder: bool) -> bool {
        self.manner == Manner::Own || !from_folder
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
    let requests: Vec<_> = paths.iter().cloned().map(Request::Any).collect();
    build_requests(&requests, options)
}

/// As [`build`], where the user says what a path is.
#[must_use]
pub fn build_requests(requests: &[Request], options: &Options) -> Outcome {
    let mut context = Context::new(options);
    let mut sources = Sources::default();
    let inputs = inputs::collect(requests, options, &mut context.problems);
    let mut suites = Vec::new();
    let mut singles = Vec::new();
    for input in inputs {
        match input {
            Input::Suite(found, wanted) => {
                let mut suite = one_suite(&mut context, &found, &mut sources);
                if let Some(suite) = suite.as_mut().filter(|_| !wanted.is_empty()) {
                    context.problems.extend(keep_only(suite, &wanted));
                }
                suites.extend(suite);
            }
            Input::Plugin { found, kind, from_folder } => {
                singles.push(Single { found, kind, from_folder });
            }
        }
    }
    gather(&mut context, singles, &mut suites);
    files(&mut context, requests, &mut sources);
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

/// Gathers the plug-ins that are in no suite file.
fn gather(context: &mut Context<'_>, singles: Vec<Single>, suites: &mut Vec<SuitePlan>) {
    let options = context.options;
    let is_used = |single: &Single| options.are_for(single.from_folder);
    if !singles.iter().any(is_used) {
        context.problems.extend(unused(options));
    }
    let groups = match options.manner {
        Manner::Own => vec![singles],
        Manner::Predecessor => {
            let (named, found) = singles.into_iter().partition(is_used);
            vec![named, found]
        }
    };
    let groups = groups.iter().filter(|group| !group.is_empty());
    let gathered: Vec<_> = groups.map(|group| plan_singles(context, group)).collect();
    let at = if options.manner == Manner::Own { suites.len() } else { 0 };
    suites.splice(at..at, gathered);
}

/// Takes in what is wrong with the `rtf.toml` files, also those that concern
/// only the run.
fn files(context: &mut Context<'_>, requests: &[Request], sources: &mut Sources) {
    let Options { surroundings, asked, .. } = context.options;
    for request in requests {
        let path = surroundings.absolute(request.path());
        context.files.above(&config::folder_of_input(&path));
    }
    context.problems.append(&mut context.files.problems);
    context.problems.extend(asked.check_profile(&context.files));
    sources.append(context.files.sources());
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
    let mut suite = suite::load(&source, &mut context.problems);
    if let Some(suite) = &mut suite {
        context.configure(&folder_of(&found.path), &source, suite);
    }
    let plan = suite.map(|suite| plan(context, found, &source, suite));
    keep(sources, &source, &context.problems[before..]);
    plan
}

/// Keeps the tests of these names; what is wrong with the names.
fn keep_only(suite: &mut SuitePlan, wanted: &[String]) -> Vec<Diagnostic> {
    let names: Vec<&str> = suite.tests.iter().map(|test| test.name.as_str()).collect();
    let unknown = wanted.iter().filter(|name| !names.contains(&name.as_str()));
    let problems = unknown.map(|name| {
        let message = format!("there is no test `{name}` in `{}`", suite.file);
        let problem = Diagnostic::error("unknown-test", message);
        match suite::nearest(name, names.iter().copied()) {
            Some(near) => problem.hint(format!("did you mean `{near}`?")),
            None => problem.hint(format!("`rtf list {}` shows its tests", suite.file)),
        }
    });
    let problems = problems.collect();
    suite.tests.retain(|test| wanted.contains(&test.name));
    problems
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

fn outcome(
    mut problems: Vec<Diagnostic>,
    mut suites: Vec<SuitePlan>,
    mut sources: Sources,
) -> Outcome {
    sort(&mut problems);
    let files: HashSet<&str> =
        problems.iter().flat_map(|p| &p.labels).map(|label| label.file.as_str()).collect();
    sources.retain(|file| files.contains(file));
    let broken = problems.iter().any(|problem| problem.severity == Severity::Error);
    let plan = (!broken).then(|| {
        let mut names = Names::default();
        for suite in &mut suites {
            suite.name = names.unique(&suite.name);
        }
        Plan::new(suites)
    });
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
