//! What `run`, `check` and `list` have in common: from paths to a plan, with
//! every problem shown.

use std::io::Write;
use std::path::PathBuf;
use std::sync::Arc;

use rtf_engine::verify;
use rtf_model::{Diagnostic, Manifest, Severity};
use rtf_plan::plan::{self, InputPath, Options, Plan, RunnerEnvironment};
use rtf_plan::select::select;
use rtf_plan::suite::SourceMap;

use super::choosing;
use crate::cli::{InputArgs, ResultsArgs};
use crate::error::Failure;
use crate::exit;
use crate::render;

/// A plan, and what the user should look at nevertheless.
pub struct Planned {
    /// What will be done.
    pub plan: Arc<Plan>,
    /// What was asked for.
    pub manifest: Manifest,
    /// The folder to which the inputs are relative.
    pub folder: PathBuf,
    /// Warnings. A run's reporters show them; other verbs do it themselves.
    pub warnings: Vec<Diagnostic>,
    sources: SourceMap,
}

/// Plans; shows every problem on standard error when there is an error.
pub fn plan(args: &InputArgs, results: &ResultsArgs) -> Result<Planned, Failure> {
    let draft = draft(args, results, Verify::Plugins)?;
    let Draft { plan, of, mut manifest, folder, problems, sources } = draft;
    let Some(mut plan) = plan else { return Err(refused(&problems, &sources)?) };
    repeat(&mut plan, &manifest);
    manifest.selected_from = if of == plan.tests { 0 } else { of };
    let plan = Arc::new(plan);
    Ok(Planned { plan, manifest, folder, warnings: problems, sources })
}

/// What the command line comes to.
pub struct Draft {
    /// The chosen tests; `None` when there is an error among the problems.
    pub plan: Option<Plan>,
    /// Out of how many tests they were chosen.
    of: u32,
    manifest: Manifest,
    /// The folder to which the inputs are relative.
    pub folder: PathBuf,
    /// Everything that is wrong or worth a look.
    pub problems: Vec<Diagnostic>,
    sources: SourceMap,
}

/// Whether planning starts the hosts to check the plug-ins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verify {
    /// The hosts load each plug-in.
    Plugins,
    /// Nothing is started.
    Nothing,
}

/// Plans and shows nothing.
pub fn draft(args: &InputArgs, results: &ResultsArgs, verify: Verify) -> Result<Draft, Failure> {
    let asked = choosing::ask(args, results)?;
    let mut surroundings = RunnerEnvironment::from_current_process().map_err(Failure::own)?;
    if let Some(folder) = &asked.folder {
        surroundings.current_dir.clone_from(folder);
    }
    let folder = surroundings.current_dir.clone();
    let options = options(&asked.manifest, surroundings);
    let draft = plan::draft(&inputs(&asked.manifest), &options);
    let outcome = match verify {
        Verify::Plugins => verify::verify(draft, verify::DEFAULT_LIMIT),
        Verify::Nothing => draft.unchecked(),
    };
    let (mut problems, mut sources) = (outcome.diagnostics, outcome.sources);
    let selection = asked.selection(&mut problems, &mut sources);
    let broken = problems.iter().any(|problem| problem.severity == Severity::Error);
    let mut of = 0;
    let mut plan = outcome.plan.filter(|_| !broken);
    if let Some(whole) = plan.take() {
        let selected = select(whole, &selection);
        problems.extend(selected.warnings);
        if selected.plan.tests == 0 {
            let what = format!("no test is chosen, of {}", count(selected.total, "test"));
            let problem = Diagnostic::error("no-tests", what)
                .hint("`rtf list` without these options shows all of them");
            problems.insert(0, problem);
        } else {
            of = u32::try_from(selected.total).unwrap_or(u32::MAX);
            plan = Some(selected.plan);
        }
    }
    Ok(Draft { plan, of, manifest: asked.manifest, folder, problems, sources })
}

/// What the command line says of how often tests are run.
fn repeat(plan: &mut Plan, manifest: &Manifest) {
    let times = manifest.repeat.unwrap_or(1);
    for test in plan.suites.iter_mut().flat_map(|suite| &mut suite.tests) {
        test.repetitions = test.repetitions.saturating_mul(times);
        test.retries.count = manifest.retries.unwrap_or(test.retries.count);
    }
}

/// Plans what was asked for in another way, all of it. The run's manifest is
/// empty: it cannot be run again by its names.
pub fn plan_requests(requests: &[InputPath], options: &Options) -> Result<Planned, Failure> {
    let outcome = verify::verify(plan::draft(requests, options), verify::DEFAULT_LIMIT);
    let (warnings, sources) = (outcome.diagnostics, outcome.sources);
    let Some(plan) = outcome.plan else { return Err(refused(&warnings, &sources)?) };
    let folder = options.runner.current_dir.clone();
    let plan = Arc::new(plan);
    Ok(Planned { plan, manifest: Manifest::default(), folder, warnings, sources })
}

fn inputs(manifest: &Manifest) -> Vec<InputPath> {
    manifest.inputs.iter().map(|input| InputPath::Any(PathBuf::from(input))).collect()
}

fn options(manifest: &Manifest, surroundings: RunnerEnvironment) -> Options {
    let mut options = Options::new(surroundings);
    options.recursive = manifest.recursive;
    options.param = manifest.param.clone().unwrap_or_default();
    options.environment = manifest.environment.clone().unwrap_or_default();
    options.repetitions = manifest.repetition.unwrap_or(1);
    options.config_request.profile.clone_from(&manifest.profile);
    let set = manifest.set.iter().filter_map(|text| text.split_once('='));
    options.config_request.params =
        set.map(|(name, value)| (name.to_owned(), value.to_owned())).collect();
    options
}

/// Shows what is wrong.
pub fn refused(problems: &[Diagnostic], sources: &SourceMap) -> Result<Failure, Failure> {
    show(problems, sources)?;
    let told = writeln!(anstream::stderr(), "{}; nothing was started", sum(problems));
    Failure::unless_reader_left(told)?;
    Ok(Failure::told(exit::BAD_INPUT))
}

impl Planned {
    /// Shows the warnings on standard error.
    pub fn show_warnings(&self) -> Result<(), Failure> {
        show(&self.warnings, &self.sources)
    }
}

fn show(diagnostics: &[Diagnostic], sources: &SourceMap) -> Result<(), Failure> {
    // The stream takes the colours out where they are not wanted.
    let mut err = anstream::stderr().lock();
    Failure::unless_reader_left(render::write(&mut err, diagnostics, sources, true))
}

/// `2 errors and 1 warning`
fn sum(diagnostics: &[Diagnostic]) -> String {
    let of = |severity| diagnostics.iter().filter(|d| d.severity == severity).count();
    let errors = count(of(Severity::Error), "error");
    match of(Severity::Warning) {
        0 => errors,
        warnings => format!("{errors} and {}", count(warnings, "warning")),
    }
}

/// A number with its noun: `1 suite`, `2 suites`.
pub fn count(number: usize, one: &str) -> String {
    if number == 1 { format!("1 {one}") } else { format!("{number} {one}s") }
}
