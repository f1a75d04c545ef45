//! The description of a run as a whole.

use std::collections::BTreeMap;

use rtf_model::{Record, Revision, Verdict};
use serde::Serialize;
use utoipa::ToSchema;
use utoipa::openapi::schema::{Object, ObjectBuilder, Type};

use super::model;
use crate::index::{Index, State};
use crate::problem::Problem;

/// A run as a whole.
#[derive(Clone, Debug, Default, Serialize, ToSchema)]
pub struct RunInfo {
    /// Its name.
    pub run: String,
    /// The time of day when it started, RFC 3339.
    pub started_at: String,
    /// The version of the runner.
    pub rtf: String,
    /// Its command line.
    pub command: Vec<String>,
    /// The directory in which the run was started.
    pub working_dir: String,
    /// How far it is.
    pub state: State,
    /// The signal or request that cut it short.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub interrupted: Option<String>,
    /// How the runner ended, when it died.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub died: Option<String>,
    /// Whether nothing speaks against the robot or the bench; left out while it runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub green: Option<bool>,
    /// The number of the next event.
    pub seq: u64,
    /// When the last event happened, in microseconds since the start.
    pub last_at: u64,
    /// How many suites it has.
    pub suites: usize,
    /// The names of its suites; only the first ones, when there are many.
    pub suite_names: Vec<String>,
    /// The Git revision of its working directory.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<model::Revision>)]
    pub revision: Option<Revision>,
    /// The profile that it was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The robots that it was for: `--set robot=NAME`, and `--robot NAME` in the
    /// environments of its suites.
    pub robots: Vec<String>,
    /// How long its journal is, as far as it was read.
    pub bytes: u64,
    /// How many tests are in which state.
    pub totals: Totals,
    /// Problems outside its tests.
    pub problems: Vec<String>,
    /// What of the journal could not be read.
    pub damages: Vec<DamageAt>,
}

/// A place of a journal that could not be read.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct DamageAt {
    /// The line, from 1.
    pub line: u64,
    /// What is wrong with it.
    pub problem: String,
}

/// How many tests are in which state.
#[derive(Clone, Debug, Default, Serialize, ToSchema)]
pub struct Totals {
    /// All.
    pub planned: u32,
    /// Those that wait.
    pub pending: u32,
    /// Those that run.
    pub running: u32,
    /// Those that have their last word.
    pub done: u32,
    /// These by their verdicts.
    #[schema(schema_with = by_verdict)]
    pub verdicts: BTreeMap<&'static str, u32>,
}

/// A number for each verdict.
pub(super) fn by_verdict() -> Object {
    let number = || ObjectBuilder::new().schema_type(Type::Integer).minimum(Some(0));
    let verdicts = Verdict::ALL.iter().map(|verdict| verdict.as_str());
    let all = verdicts.fold(ObjectBuilder::new(), |all, verdict| {
        all.property(verdict, number()).required(verdict)
    });
    all.build()
}

impl From<&rtf_model::TestTotals> for Totals {
    fn from(totals: &rtf_model::TestTotals) -> Self {
        Self {
            planned: totals.planned,
            pending: totals.pending,
            running: totals.running,
            done: totals.done(),
            verdicts: Verdict::ALL.map(|v| (v.as_str(), totals.of(v))).into_iter().collect(),
        }
    }
}

/// A page of the list of runs.
#[derive(Debug, Default, Serialize, ToSchema)]
pub struct RunList {
    /// The runs, the newest first.
    pub runs: Vec<RunInfo>,
    /// The `before` of the next page.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<String>,
    /// Number of runs that are still being read and may match;
    /// poll for them.
    #[serde(skip_serializing_if = "super::is_default")]
    #[schema(required = false)]
    pub unread: usize,
}

impl RunInfo {
    /// The description of a run.
    #[must_use]
    pub fn of(name: &str, index: &Index) -> Self {
        let record = &index.record;
        let state = index.state();
        let suites = record.suites.iter();
        let totals = if state.is_over() { record.final_totals() } else { record.totals() };
        let started = record.run.as_ref();
        let manifest = started.map(|run| &*run.manifest);
        Self {
            revision: manifest.and_then(|manifest| manifest.revision.clone()),
            profile: manifest.and_then(|manifest| manifest.profile.clone()),
            robots: robots(record),
            started_at: started.map(|run| run.started_at.clone()).unwrap_or_default(),
            rtf: started.map(|run| run.rtf.clone()).unwrap_or_default(),
            command: started.map(|run| run.command.clone()).unwrap_or_default(),
            working_dir: started.map(|run| run.working_dir.clone()).unwrap_or_default(),
            interrupted: record.interrupted().map(str::to_owned),
            died: record.runner_death().map(str::to_owned),
            green: state.is_over().then(|| record.is_green()),
            seq: index.next_seq(),
            last_at: record.last_at.0,
            bytes: index.offset,
            totals: Totals::from(&totals),
            problems: suites
                .clone()
                .flat_map(|suite| record.suite_problems(suite.plan.suite))
                .collect(),
            damages: record.damages.iter().map(DamageAt::from).collect(),
            suites: record.suites.len(),
            suite_names: suites.take(NAMES).map(|suite| suite.plan.name.clone()).collect(),
            run: name.to_owned(),
            state,
        }
    }

    fn empty(name: &str, state: State) -> Self {
        let totals = Totals::from(&rtf_model::TestTotals::default());
        Self { run: name.to_owned(), state, totals, ..Self::default() }
    }

    /// A run of which nothing was read yet.
    #[must_use]
    pub fn unread(name: &str) -> Self {
        Self::empty(name, State::Unread)
    }

    /// A run that cannot be read.
    #[must_use]
    pub fn unreadable(name: &str, problem: &Problem) -> Self {
        let problems = vec![problem.detail.clone()];
        Self { problems, ..Self::empty(name, State::Incomplete) }
    }
}

/// Maximum number of suite names.
const NAMES: usize = 100;

fn robots(record: &Record) -> Vec<String> {
    let manifest = record.run.as_ref().map(|run| &*run.manifest);
    let set = manifest.into_iter().flat_map(|manifest| &manifest.set);
    let set = set.filter_map(|setting| setting.strip_prefix("robot="));
    let named = record.suites.iter().filter_map(|suite| robot_of(&suite.plan.environment));
    let mut robots: Vec<_> = set.chain(named).map(str::to_owned).collect();
    robots.sort();
    robots.dedup();
    robots.truncate(NAMES);
    robots
}

/// The robot that is named in an environment string: `--robot NAME`.
fn robot_of(environment: &str) -> Option<&str> {
    let mut words = environment.split_whitespace();
    let after = words.by_ref().find_map(|word| match word.strip_prefix("--robot")? {
        "" => Some(None),
        rest => rest.strip_prefix('=').map(Some),
    })?;
    after.or_else(|| words.next())
}

impl From<&rtf_model::Damage> for DamageAt {
    fn from(damage: &rtf_model::Damage) -> Self {
        Self { line: damage.line, problem: damage.problem.clone() }
    }
}
