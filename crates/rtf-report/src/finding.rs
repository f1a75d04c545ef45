//! The problems of a run, each with the best location in the sources:
//! code hosts annotate changes with them.

mod location;
mod test;

use rtf_model::{HookRunRecord, Record, Severity, SuiteRecord};

pub(crate) use location::{RepositoryLocation, Roots};
pub(crate) use test::{is_problem, of_test};

use crate::escape;
use crate::explain::{self, Extent, Tone};
use crate::words;

/// How much of a test is explained; code hosts cut long texts.
const EXTENT: Extent = Extent { items: 10, stack_lines: 30 };

/// The severity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rank {
    /// The robot may not be in a safe state.
    Unsafe,
    /// The bench is wrong, or the run is incomplete.
    Bench,
    /// The robot is wrong.
    Robot,
    /// Probably a mistake.
    Warning,
}

/// One problem of a run.
#[derive(Clone, Debug)]
pub(crate) struct Finding {
    pub rank: Rank,
    /// A stable word for its kind: `failed`, `fixture`, `hook`.
    pub kind: String,
    /// The subject, stable from run to run: `arm/EncoderTest`.
    pub about: String,
    /// One line.
    pub title: String,
    /// Everything that explains it, on one or more lines.
    pub text: String,
    /// Where to show it.
    pub place: Option<RepositoryLocation>,
}

/// All findings: first the run, then hooks, fixtures and tests, so that a code
/// host that shows only some of them shows the cause, not its consequences.
pub(crate) fn all(record: &Record, roots: &Roots<'_>) -> Vec<Finding> {
    let mut findings: Vec<Finding> = of_run(record, roots).into_iter().collect();
    findings.extend(record.suites.iter().flat_map(|suite| of_hooks(record, suite, roots)));
    findings.extend(record.suites.iter().flat_map(|suite| of_fixtures(record, suite, roots)));
    findings.extend(record.tests.iter().flat_map(|test| of_test(record, test, roots)));
    findings.extend(record.warnings.iter().map(|warning| of_warning(warning, roots)));
    findings
}

/// The problem of the run as a whole.
pub(crate) fn run_problem(record: &Record) -> Option<String> {
    if let Some(damage) = words::damage(record) {
        Some(damage)
    } else if let Some(reason) = record.interrupted() {
        Some(format!("the run was interrupted: {reason}"))
    } else if let Some(reason) = record.runner_death() {
        Some(format!("the runner died: {reason}"))
    } else if !record.is_complete() {
        Some("the runner did not reach the end of this run".to_owned())
    } else if record.tests.is_empty() {
        Some("the run has no tests".to_owned())
    } else {
        None
    }
}

fn of_run(record: &Record, roots: &Roots<'_>) -> Option<Finding> {
    let problem = run_problem(record)?;
    let place = record.suites.first().and_then(|suite| roots.suite(suite));
    Some(Finding {
        rank: Rank::Bench,
        kind: "run".to_owned(),
        about: "run".to_owned(),
        title: escape::line(&problem).into_owned(),
        text: escape::block(&problem).into_owned(),
        place,
    })
}

fn of_hooks(record: &Record, suite: &SuiteRecord, roots: &Roots<'_>) -> Vec<Finding> {
    let hooks = suite.hooks.iter().filter_map(|id| record.hooks.get(id.index()));
    let failed = hooks.flat_map(|hook| {
        let bad = hook.runs.iter().filter(|run| run.problem().is_some());
        bad.map(move |run| (hook, run))
    });
    failed
        .map(|(hook, run)| {
            let about = record.full_hook_name(hook.plan.hook);
            Finding {
                rank: Rank::Unsafe,
                kind: "hook".to_owned(),
                title: format!("hook {} failed", escape::line(&about)),
                text: hook_text(run),
                place: roots.suite(suite),
                about,
            }
        })
        .collect()
}

fn hook_text(run: &HookRunRecord) -> String {
    let lines = explain::lines(|sink| {
        sink(Tone::Bad, "the robot may not be in a safe state");
        explain::hook(run, EXTENT, sink);
        explain::block(Tone::Dim, &run.reason, "reason: ", sink);
    });
    lines.join("\n")
}

fn of_fixtures(record: &Record, suite: &SuiteRecord, roots: &Roots<'_>) -> Vec<Finding> {
    let fixtures = suite.fixtures.iter().filter_map(|id| record.fixture(*id));
    fixtures
        .filter_map(|fixture| {
            let problems = fixture.problems(suite.plan.tolerates_collapse);
            problems.first()?;
            let about = format!("{}/{}", suite.plan.name, fixture.plan.name);
            let messages = fixture.messages.iter().take(EXTENT.items);
            let lines = explain::lines(|sink| {
                problems.iter().for_each(|problem| sink(Tone::Bad, &escape::block(problem)));
                messages.for_each(|message| explain::message(message, sink));
                explain::left(&fixture.leaked, sink);
                explain::printed(fixture.log_tail.iter().map(String::as_str), sink);
            });
            Some(Finding {
                rank: Rank::Bench,
                kind: "fixture".to_owned(),
                title: format!("fixture {}", escape::line(&about)),
                text: lines.join("\n"),
                place: roots.suite(suite),
                about,
            })
        })
        .collect()
}

fn of_warning(warning: &rtf_model::Diagnostic, roots: &Roots<'_>) -> Finding {
    let mut lines = vec![escape::block(&warning.message).into_owned()];
    lines.extend(warning.notes.iter().map(|note| format!("note: {}", escape::block(note))));
    lines.extend(warning.hint.iter().map(|hint| format!("hint: {}", escape::block(hint))));
    let place = warning.labels.first().and_then(|label| {
        Some(RepositoryLocation {
            line: label.line,
            column: label.column,
            ..roots.place(&label.file, label.line)?
        })
    });
    Finding {
        rank: match warning.severity {
            Severity::Error => Rank::Bench,
            Severity::Warning => Rank::Warning,
        },
        kind: warning.code.clone(),
        about: warning.message.clone(),
        title: escape::line(&warning.message).into_owned(),
        text: lines.join("\n"),
        place,
    }
}
