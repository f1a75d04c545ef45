//! Makes one stream of events of several runs: of the parts of one run, or of
//! any runs that have no test in common.
//!
//! The runs may have gone on at the same time, on different machines. Their
//! fixtures did, too, and one stream cannot say so of one fixture. So the
//! merged run reads as if one runner had done everything: one suite after the
//! other, and of each suite one part after the other, in the order in which the
//! runs are given. Within a part, times keep their distances.
//!
//! - [`plan`]: which suites, fixtures, hooks and tests there are, and their ids.
//! - [`suite`]: what happened in a suite, one part after the other.
//! - [`manifest`]: what was asked for, and whether a part is missing.
//!
//! `spec/events.md` says what the merged stream has of which run.

mod manifest;
mod place;
mod plan;
mod suite;

use std::path::{Component, Path};

use rtf_model::{
    Diagnostic, EVENTS_VERSION, Event, EventKind, LeakedProcess, Manifest, Micros, OrderChecker,
    OrderError, RunStarted, SuiteId,
};

use place::Ids;
use plan::MergedPlan;
use suite::MergedSuite;

/// One of the runs.
#[derive(Clone, Debug)]
pub struct MergeInput {
    /// What it is called, in words for people.
    pub name: String,
    /// Its events.
    pub events: Vec<Event>,
}

/// The values of the merged run itself.
#[derive(Clone, Debug)]
pub struct Header {
    /// Its name.
    pub run: String,
    /// The version of the program.
    pub rtf: String,
    /// The command line that merges.
    pub command: Vec<String>,
}

/// Why runs cannot be merged.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MergeProblem {
    /// A journal does not begin with `run-started`.
    #[error("the journal of `{run}` has no beginning")]
    NoBeginning {
        /// Whose.
        run: String,
    },
    /// A journal breaks the order of events.
    #[error("the journal of `{run}` is not in order")]
    Order {
        /// Whose.
        run: String,
        /// Where, and which rule.
        #[source]
        source: OrderError,
    },
    /// Two runs have one test.
    #[error("test `{test}` is in `{first}` and in `{second}`")]
    Twice {
        /// The test, with its suite.
        test: String,
        /// The run that has it first.
        first: String,
        /// The other one.
        second: String,
    },
    /// Some parts of a division are not among the runs.
    #[error("not all of {of} parts are there: {} missing", list(parts, *of))]
    Missing {
        /// Their numbers.
        parts: Vec<u32>,
        /// Of how many.
        of: u32,
    },
}

impl MergeProblem {
    /// What to do about it.
    #[must_use]
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NoBeginning { .. } | Self::Order { .. } => None,
            Self::Twice { .. } => Some("merge runs of different tests, as those of `--shard` are"),
            Self::Missing { .. } => Some("`--partial` merges without them"),
        }
    }
}

fn list(parts: &[u32], of: u32) -> String {
    let words: Vec<_> = parts.iter().map(|part| format!("{part}/{of}")).collect();
    let verb = if words.len() == 1 { "is" } else { "are" };
    format!("{} {verb}", words.join(", "))
}

/// Runs of which one can be made.
#[derive(Debug)]
pub struct Mergeable {
    parts: Vec<MergeInput>,
    plan: MergedPlan,
    manifest: Manifest,
}

/// Finds out whether one run can be made of these. With `partial`, parts of a
/// division may be missing.
///
/// # Errors
/// Every reason why not.
pub fn merge(parts: Vec<MergeInput>, partial: bool) -> Result<Mergeable, Vec<MergeProblem>> {
    let unreadable: Vec<_> = parts.iter().filter_map(|part| check(part).err()).collect();
    if !unreadable.is_empty() {
        return Err(unreadable);
    }
    let (plan, mut problems) = MergedPlan::join(&parts);
    let asked = manifest::join(&parts, plan.tests.len());
    if !partial {
        problems.extend(asked.missing);
    }
    match problems.is_empty() {
        true => Ok(Mergeable { parts, plan, manifest: asked.manifest }),
        false => Err(problems),
    }
}

impl Mergeable {
    /// The merged run.
    #[must_use]
    pub fn events(self, header: Header) -> Vec<Event> {
        let Self { parts, plan, manifest } = self;
        let mut runs = parts.iter().filter_map(started);
        let started_at = manifest::earliest(runs.clone().map(|run| run.started_at.as_str()));
        let working_dir = runs.next().map(|run| run.working_dir.clone()).unwrap_or_default();
        let mut merging = Merging::default();
        merging.push(EventKind::RunStarted(RunStarted {
            version: EVENTS_VERSION,
            run: header.run,
            rtf: header.rtf,
            started_at,
            command: header.command,
            working_dir,
            suites: count(plan.suites.len()),
            tests: count(plan.tests.len()),
            manifest: Box::new(manifest),
        }));
        plan.events().for_each(|kind| merging.push(kind));
        merging.all(&plan, parts);
        merging.events
    }
}

/// The path of an attachment in the merged run, relative to the run directories
/// of both; `None` if `path` is not in a run's attachments.
/// `part` is the run's place, from 0.
#[must_use]
pub fn attachment_path(part: usize, path: &str) -> Option<String> {
    let rest = Path::new(path).strip_prefix("attachments").ok()?;
    let plain = rest.components().all(|part| matches!(part, Component::Normal(_)));
    let rest = rest.to_str().filter(|rest| plain && !rest.is_empty())?;
    Some(format!("attachments/part-{}/{rest}", part + 1))
}

/// A run that was killed may end anywhere; what is there has to be in order.
fn check(part: &MergeInput) -> Result<(), MergeProblem> {
    if started(part).is_none() {
        return Err(MergeProblem::NoBeginning { run: part.name.clone() });
    }
    let mut order = OrderChecker::default();
    let checked = part.events.iter().try_for_each(|event| order.check(event));
    checked.map_err(|source| MergeProblem::Order { run: part.name.clone(), source })
}

fn started(part: &MergeInput) -> Option<&RunStarted> {
    match part.events.first().map(|event| &event.kind) {
        Some(EventKind::RunStarted(run)) => Some(run),
        _ => None,
    }
}

fn count(len: usize) -> u32 {
    u32::try_from(len).unwrap_or(u32::MAX)
}

/// The stream that is being made.
#[derive(Debug, Default)]
struct Merging {
    events: Vec<Event>,
    now: Micros,
}

impl Merging {
    fn push(&mut self, kind: EventKind) {
        self.events.push(Event { seq: self.events.len() as u64, at: self.now, kind });
    }

    fn all(&mut self, plan: &MergedPlan, parts: Vec<MergeInput>) {
        let mut taken = Taken::new(plan);
        for (number, part) in parts.into_iter().enumerate() {
            taken.take(part, &Ids { plan, part: number });
        }
        for diagnostic in taken.warnings {
            self.push(EventKind::Warning { diagnostic });
        }
        for suite in taken.suites {
            suite.write(self);
        }
        self.push(match taken.died.is_empty() {
            true => EventKind::RunFinished { interrupted: taken.interrupted },
            false => EventKind::RunnerDied { reason: taken.died.join("; "), leaked: taken.leaked },
        });
    }
}

/// What the runs had, suite by suite, and how they ended.
#[derive(Debug)]
struct Taken {
    suites: Vec<MergedSuite>,
    /// Those that belong to no suite.
    warnings: Vec<Diagnostic>,
    interrupted: Option<String>,
    died: Vec<String>,
    leaked: Vec<LeakedProcess>,
}

impl Taken {
    fn new(plan: &MergedPlan) -> Self {
        let suites = plan.suites.iter().map(|plan| MergedSuite::new(plan.suite)).collect();
        let (warnings, died, leaked) = (Vec::new(), Vec::new(), Vec::new());
        Self { suites, warnings, interrupted: None, died, leaked }
    }

    /// Hands a run's events to their suites.
    fn take(&mut self, part: MergeInput, ids: &Ids<'_>) {
        ids.suites().for_each(|suite| self.suites[suite.index()].begin_piece());
        let (mut current, mut ended) = (None::<SuiteId>, false);
        for Event { at, mut kind, .. } in part.events {
            current = ids.translate(&mut kind).or(current);
            match (kind, current) {
                (EventKind::RunFinished { interrupted }, _) => {
                    ended = true;
                    self.interrupted = self.interrupted.take().or(interrupted);
                }
                (EventKind::RunnerDied { reason, leaked }, _) => {
                    ended = true;
                    self.died.push(format!("{reason} in {}", part.name));
                    self.leaked.extend(leaked);
                }
                (kind, Some(suite)) => self.suites[suite.index()].add(at, kind),
                // The same files give the same warnings in each part.
                (EventKind::Warning { diagnostic }, None)
                    if !self.warnings.contains(&diagnostic) =>
                {
                    self.warnings.push(diagnostic);
                }
                _ => {}
            }
        }
        if !ended {
            self.died.push(format!("killed with its guard in {}", part.name));
        }
    }
}
