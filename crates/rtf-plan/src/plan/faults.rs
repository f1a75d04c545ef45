//! The additional fixture of a suite with faults: it injects them while tests run.

use std::sync::Arc;

use rtf_model::{Diagnostic, FaultAction, FaultConfig, FaultTarget, FaultsConfig, Location};

use super::hosts::FAULTS;
use super::of_tests::OfTests;
use super::own_processes::SuiteFixtures;
use super::plugin_planner::PluginPlanner;
use super::use_site::UseSite;
use super::{FixturePlan, added_fixture};
use crate::suite::{DeclaredEffect, DeclaredFault, DeclaredTarget, SourceText};

/// The name of the fixture: tests find its value `socket`.
const NAME: &str = "faults";

pub(super) struct DeclaredFaults {
    /// The faults of all tests.
    pub of_suite: Vec<DeclaredFault>,
    /// The faults of single tests.
    pub of_tests: OfTests<DeclaredFault>,
    /// The names that the suite gives to its fixtures.
    pub fixtures: Vec<String>,
    pub has_clock: bool,
    /// Whether the suite has a private network.
    pub has_network: bool,
}

/// Plans the faults, and adds their fixture after all others.
pub(super) fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    declared: &DeclaredFaults,
    fixtures: &mut Vec<FixturePlan>,
) {
    let problems = &mut planner.context.problems;
    let before = problems.len();
    let all: Vec<_> = declared.of_tests.with_suite(&declared.of_suite, source, problems).collect();
    let Some((first, _)) = all.first() else { return };
    let known = SuiteFixtures { planned: fixtures, declared: &declared.fixtures };
    for target in all.iter().filter_map(|(fault, _)| fault.effect.target()) {
        let problem = known.process_problem(&target.fixture, "broken by a fault");
        problems.extend(problem.map(|it| it.label(source.label(target.fixture.span, ""))));
    }
    for effect in all.iter().map(|(fault, _)| &fault.effect) {
        let DeclaredEffect::Values { fixture, .. } = effect else { continue };
        let problem = known.plugin_problem(fixture, "a proxy");
        problems.extend(problem.map(|it| it.label(source.label(fixture.span, ""))));
    }
    let of_network = |it: &DeclaredFault| matches!(it.effect, DeclaredEffect::Network { .. });
    for (fault, _) in all.iter().filter(|(fault, _)| of_network(fault) && !declared.has_network) {
        let message = "a fault of the kind `network` needs a suite with a private network";
        let hint = "write `isolate=\"network\"` in `<suite>`";
        problems.push(source.error("no-private-network", fault.span, message).hint(hint));
    }
    if fixtures.iter().any(|other| other.name == NAME) {
        let message = format!("a suite with a `<fault>` cannot name a fixture `{NAME}`");
        let label = source.label(first.span, "`rtf` adds a fixture with this name");
        let hint = "give the fixture another `name`";
        problems.push(Diagnostic::error("reserved-name", message).label(label).hint(hint));
    }
    if problems.len() > before {
        return;
    }
    let site = UseSite::Suite(Arc::clone(source), first.span);
    let mut args = Vec::new();
    let faults =
        all.into_iter().map(|(fault, tests)| config(fault, tests, source, &mut args)).collect();
    let config = FaultsConfig { faults, has_clock: declared.has_clock };
    let Ok(param) = serde_json::to_string(&config) else { return };
    let Some(plugin) = planner.plan_built_in(&FAULTS, source.name(), (param, args), &site) else {
        return;
    };
    fixtures.push(added_fixture::plan(NAME.to_owned(), plugin, fixtures));
}

/// Directories are arguments of the plug-in, in which references are replaced when it starts.
fn config(
    fault: &DeclaredFault,
    tests: Option<Vec<String>>,
    source: &SourceText,
    args: &mut Vec<String>,
) -> FaultConfig {
    let target = |target: &DeclaredTarget| FaultTarget {
        fixture: target.fixture.value.clone(),
        process: target.process.clone(),
    };
    let action = match &fault.effect {
        DeclaredEffect::Kill(processes) => FaultAction::Kill(target(processes)),
        DeclaredEffect::Stop(processes) => FaultAction::Stop(target(processes)),
        DeclaredEffect::Slow { target: processes, percent } => {
            FaultAction::Slow { target: target(processes), percent: *percent }
        }
        DeclaredEffect::Memory(amount) => FaultAction::Memory(*amount),
        DeclaredEffect::Disk { dir, amount } => {
            args.push(dir.value.clone());
            FaultAction::Disk(*amount)
        }
        DeclaredEffect::Network { fault, port } => {
            args.extend(port.iter().map(|port| port.value.clone()));
            FaultAction::Network(*fault)
        }
        DeclaredEffect::Values { fixture, fault } => {
            FaultAction::Values { fixture: fixture.value.clone(), fault: fault.clone() }
        }
    };
    let DeclaredFault { span, name, at, duration, seed, .. } = fault;
    FaultConfig {
        name: name.value.clone(),
        action,
        at: *at,
        duration: *duration,
        seed: *seed,
        location: Location { file: source.name().to_owned(), line: source.line(*span) },
        tests,
    }
}
