//! Limits that tests learn from the history, before the run starts.

use std::path::Path;

use rtf_history::answers::learned::{LearnQuery, Learned, LearnedChange};
use rtf_history::{Location, RunSelection, Store, StoreError, SuiteFileBase, TestIdentity};
use rtf_model::{Diagnostic, LearnedLimits, Manifest};
use rtf_plan::plan::{LearnPlan, LearnedSides, Plan, SuitePlan, TestPlan};
use rtf_plan::suite::Span;
use rtf_report::format_count;

use super::default_branch;
use crate::revision;

/// Whether any test learns limits.
pub fn is_learning(plan: &Plan) -> bool {
    let learns = |suite: &SuitePlan| suite.tests.iter().any(|test| !test.learn.is_empty());
    plan.suites.iter().any(learns)
}

/// Sets the limits that the tests of a plan learn. Returns warnings about measurements that
/// are not judged: a history that cannot be read fails no test.
pub fn learn(
    plan: &mut Plan,
    database: &Location,
    manifest: &Manifest,
    working_dir: &Path,
) -> Vec<Diagnostic> {
    let queries = queries(plan, working_dir);
    let found = match ask(database, manifest, working_dir, &queries) {
        Ok(found) => found,
        Err(error) => {
            let message = format!("{error}: measurements with learned limits are not judged");
            let warning = Diagnostic::warning("not-judged", message);
            return vec![match error.hint() {
                Some(hint) => warning.hint(hint),
                None => warning,
            }];
        }
    };
    let mut found = found.into_iter();
    let mut warnings = Vec::new();
    for suite in &mut plan.suites {
        for test in &mut suite.tests {
            let name = format!("{}/{}", suite.name, test.name);
            for learn in &test.learn {
                let learned = found.next().unwrap_or_default();
                warnings.extend(warning(&suite.file, &name, learn, &learned));
                test.learned.push(limits(learn, learned));
            }
        }
    }
    warnings
}

/// A change of a measurement that is not accepted.
pub struct OpenChange {
    /// The suite file as the user named it.
    pub file: String,
    /// The position of `<learn`.
    pub span: Span,
    /// The suite and the test.
    pub test: String,
    pub measurement: String,
    pub change: LearnedChange,
}

/// The changes after which limits are no longer learned, in the order of the plan.
pub fn open_changes(
    plan: &Plan,
    database: &Location,
    manifest: &Manifest,
    working_dir: &Path,
) -> Result<Vec<OpenChange>, StoreError> {
    let found = ask(database, manifest, working_dir, &queries(plan, working_dir))?;
    let tests = plan.suites.iter().flat_map(|suite| {
        let learns = |test| learns_of(suite, test);
        suite.tests.iter().flat_map(learns)
    });
    let open = tests.zip(found).filter_map(|((suite, test, learn), learned)| {
        Some(OpenChange {
            file: suite.file.clone(),
            span: learn.span,
            test: format!("{}/{}", suite.name, test.name),
            measurement: learn.measurement.clone(),
            change: learned.changed?,
        })
    });
    Ok(open.collect())
}

fn learns_of<'p>(
    suite: &'p SuitePlan,
    test: &'p TestPlan,
) -> impl Iterator<Item = (&'p SuitePlan, &'p TestPlan, &'p LearnPlan)> {
    test.learn.iter().map(move |learn| (suite, test, learn))
}

fn queries(plan: &Plan, working_dir: &Path) -> Vec<LearnQuery> {
    let dir = revision::dir_in_repository(working_dir).unwrap_or_default();
    let base = SuiteFileBase::of_dir(working_dir, Path::new(&dir));
    let mut queries = Vec::new();
    for suite in &plan.suites {
        let robots: Vec<_> = suite.settings.requires.iter().map(|it| it.name.as_str()).collect();
        for test in &suite.tests {
            let identity = |name: &str| TestIdentity {
                suite_file: base.normalize(&suite.file),
                suite: suite.name.clone(),
                test: name.to_owned(),
                case: String::new(),
            };
            queries.extend(test.learn.iter().map(|learn| query(learn, test, &robots, &identity)));
        }
    }
    queries
}

fn query(
    learn: &LearnPlan,
    test: &TestPlan,
    robots: &[&str],
    identity: &dyn Fn(&str) -> TestIdentity,
) -> LearnQuery {
    LearnQuery {
        test: identity(&test.name),
        former: test.was.as_deref().map(identity),
        robot: robots.join(" "),
        measurement: learn.measurement.clone(),
        min_runs: usize::try_from(learn.min_runs).unwrap_or(usize::MAX),
        sigma: learn.sigma,
        since: learn.since,
    }
}

/// Asks for runs of the default branch with the same profile.
fn ask(
    database: &Location,
    manifest: &Manifest,
    working_dir: &Path,
    queries: &[LearnQuery],
) -> Result<Vec<Learned>, StoreError> {
    let store = Store::open_existing(database)?;
    let profile = Some(manifest.profile.clone().unwrap_or_default());
    // In a repository without such runs: none. Without a repository, all runs count.
    let in_repository = || revision::dir_in_repository(working_dir).map(|_| String::new());
    let branch = default_branch(&store, working_dir)?.or_else(in_repository);
    store.learn(&RunSelection { branch, profile, ..RunSelection::default() }, queries)
}

fn limits(learn: &LearnPlan, learned: Learned) -> LearnedLimits {
    let (low, high) = learned.limits.unzip();
    LearnedLimits {
        measurement: learn.measurement.clone(),
        unit: learned.unit,
        low: low.filter(|_| learn.limits != LearnedSides::High),
        high: high.filter(|_| learn.limits != LearnedSides::Low),
        runs: u32::try_from(learned.runs).unwrap_or(u32::MAX),
    }
}

fn warning(file: &str, test: &str, learn: &LearnPlan, learned: &Learned) -> Option<Diagnostic> {
    let measurement = &learn.measurement;
    if learned.limits.is_none() {
        let runs = format_count(learned.runs as u64, "green run");
        let message = format!(
            "`{measurement}` of `{test}` is not judged: its limits are learned from {} runs, and \
             the default branch has {runs}",
            learn.min_runs
        );
        return Some(Diagnostic::warning("not-judged", message));
    }
    let changed = learned.changed.as_ref()?;
    let message = format!(
        "`{measurement}` of `{test}` has changed in the run {}: its limits are learned from the \
         {} before it",
        changed.run,
        format_count(learned.runs as u64, "run")
    );
    let hint = format!("if the change is intended: `rtf history accept {file}`");
    Some(Diagnostic::warning("change-not-accepted", message).hint(hint))
}
