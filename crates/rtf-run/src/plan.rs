//! Request → plan, with every problem reported.

use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;

use rtf_engine::verify;
use rtf_history::Location;
use rtf_model::protocol::CaseSelector;
use rtf_model::{Diagnostic, Manifest, Severity};
use rtf_plan::plan::{self, Plan, PlanDraft, PlanOutcome};
use rtf_plan::select::{self, Selected, Selection, Shard, ShardBy, select};
use rtf_plan::suite::{SourceMap, SourceText};

use crate::campaign::episodes;
use crate::debug::DebugRequest;
use crate::diagnostics::{self, count};
use crate::error::Failure;
use crate::history::{self, PastTests};
use crate::request::TestsRequest;

/// A plan without errors.
pub struct Planned {
    pub plan: Arc<Plan>,
    /// The number of tests before the selection; 0 if all were selected.
    pub selected_from: u32,
    /// A hash of the assignment of tests to shards, if it depends on past durations.
    pub shard_assignment: Option<u64>,
    /// The reporters of a run print them, other verbs print them themselves.
    pub warnings: Vec<Diagnostic>,
    sources: SourceMap,
}

impl Planned {
    /// Sets the limits that tests learn from the history.
    pub fn learn(&mut self, database: &Location, request: &TestsRequest) {
        let (manifest, dir) = (&request.manifest, &request.options.runner.current_dir);
        let plan = Arc::make_mut(&mut self.plan);
        self.warnings.extend(history::learn(plan, database, manifest, dir));
    }

    pub fn print_warnings(&self) -> Result<(), Failure> {
        diagnostics::print(&self.warnings, &self.sources)
    }
}

/// Plans; prints all problems if one of them is an error.
pub fn plan(request: &TestsRequest) -> Result<Planned, Failure> {
    plan_debugged(request, None)
}

/// As [`plan()`], and prepares the only test for a debugger.
pub fn plan_debugged(
    request: &TestsRequest,
    debug: Option<&DebugRequest>,
) -> Result<Planned, Failure> {
    let Draft { plan, total, shard_assignment, problems, sources } =
        draft(request, |draft| match request.is_checked && draft.is_complete() {
            true => draft.unchecked(),
            false => verify::verify(draft, verify::DEFAULT_LIMIT),
        });
    let Some(mut plan) = plan else { return Err(diagnostics::refuse(&problems, &sources)) };
    set_repetition(&mut plan, &request.manifest);
    episodes::add(&mut plan, request)?;
    debug.map(|debug| debug.prepare(&mut plan)).transpose()?;
    let selected_from = if plan.tests as usize == total { 0 } else { total };
    Ok(Planned {
        plan: Arc::new(plan),
        selected_from: u32::try_from(selected_from).unwrap_or(u32::MAX),
        shard_assignment,
        warnings: problems,
        sources,
    })
}

/// The numbers of the shards that contain tests, ascending.
pub fn occupied_shards(
    plan: &Plan,
    (mut shard, past): (Shard, Option<Arc<PastTests>>),
) -> Vec<u32> {
    if let Some(past) = past {
        shard.by = ShardBy::Duration(past.of_plan(plan));
    }
    let parts: BTreeSet<u32> = shard.parts(&plan.suites).into_iter().map(|part| part + 1).collect();
    parts.into_iter().collect()
}

/// A plan with its problems.
pub struct Draft {
    /// The selected tests; `None` if one of the problems is an error.
    pub plan: Option<Plan>,
    /// The number of tests before the selection.
    total: usize,
    shard_assignment: Option<u64>,
    pub problems: Vec<Diagnostic>,
    sources: SourceMap,
}

/// Plans and prints nothing. `check` starts hosts to check the plug-ins, or does not.
pub fn draft(request: &TestsRequest, check: impl FnOnce(PlanDraft) -> PlanOutcome) -> Draft {
    let outcome = check(plan::draft(&request.inputs, &request.options));
    let (mut problems, mut sources) = (outcome.diagnostics, outcome.sources);
    problems.extend(request.warnings.iter().cloned());
    let mut selection = selection(request, &mut problems, &mut sources);
    let has_error = problems.iter().any(|problem| problem.severity == Severity::Error);
    let Some(all) = outcome.plan.filter(|_| !has_error) else {
        return Draft { plan: None, total: 0, shard_assignment: None, problems, sources };
    };
    add_past_results(request, &all, &mut selection);
    let selected = select(all, &selection);
    problems.extend(selected.problems);
    let has_error = problems.iter().any(|problem| problem.severity == Severity::Error);
    let plan = Some(selected.plan).filter(|plan| plan.tests > 0 && !has_error);
    if plan.is_none() && !has_error {
        let message = format!("no test selected out of {}", count(selected.total, "test"));
        let hint = "`rtf list` without these options lists all tests";
        problems.insert(0, Diagnostic::error("no-tests", message).hint(hint));
    }
    let Selected { total, shard_assignment, .. } = selected;
    Draft { plan, total, shard_assignment, problems, sources }
}

/// Adds the past results of the tests of a plan, for their order and for shards.
fn add_past_results(request: &TestsRequest, plan: &Plan, selection: &mut Selection) {
    selection.order = request.order.as_ref().map(|(order, past)| (*order, past.of_plan(plan)));
    if let Some((_, Some(past))) = &request.shard
        && let Some(shard) = &mut selection.shard
    {
        shard.by = ShardBy::Duration(past.of_plan(plan));
    }
}

/// Parses the filters; adds every mistake to the problems.
fn selection(
    request: &TestsRequest,
    problems: &mut Vec<Diagnostic>,
    sources: &mut SourceMap,
) -> Selection {
    let manifest = &request.manifest;
    let mut filters = Vec::new();
    for (number, text) in (1..).zip(&manifest.filters) {
        let name = match manifest.filters.len() {
            1 => "--filter".to_owned(),
            _ => format!("--filter ({number})"),
        };
        let source = SourceText::new(name, text);
        match select::parse(&source) {
            Ok(filter) => filters.push(filter),
            Err(problem) => problems.push(*problem),
        }
        sources.add(Arc::new(source));
    }
    let only = manifest.only.as_ref().map(|only| {
        let mut only: HashMap<_, _> =
            only.iter().cloned().map(|names| (names, Vec::new())).collect();
        for (suite, test, cases) in &manifest.only_cases {
            if let Some(selectors) = only.get_mut(&(suite.clone(), test.clone())) {
                selectors.extend(cases.iter().cloned().map(CaseSelector::Equals));
            }
        }
        only
    });
    let shard = request.shard.as_ref().map(|(shard, _)| shard.clone());
    Selection { filters, only, shuffle: manifest.shuffle, shard, order: None }
}

fn set_repetition(plan: &mut Plan, manifest: &Manifest) {
    let times = manifest.repeat.unwrap_or(1);
    for test in plan.suites.iter_mut().flat_map(|suite| &mut suite.tests) {
        test.settings.repetitions = test.settings.repetitions.saturating_mul(times);
        test.settings.retries.count = manifest.retries.unwrap_or(test.settings.retries.count);
    }
}
