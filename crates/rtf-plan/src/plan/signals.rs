//! The additional fixture of a suite with signals: it records them while tests run, and
//! evaluates the monitors.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::{
    FixtureId, MeasuredFixture, SignalConfig, SignalProgram, SignalSource, SignalTime,
    SignalsConfig,
};

use super::fixture::{RESTART_DELAY, RESTARTS};
use super::hosts::SIGNALS;
use super::monitors;
use super::names::UniqueNames;
use super::of_tests::OfTests;
use super::own_processes::SuiteFixtures;
use super::plugin_planner::PluginPlanner;
use super::use_site::UseSite;
use super::{FixtureBody, FixturePlan, defaults, envelopes, middleware, program};
use crate::suite::{
    DeclaredEnvelope, DeclaredMonitor, DeclaredSignal, DeclaredSource, DeclaredSourceKind,
    SourceText,
};

/// The name of the fixture and of its type.
const NAME: &str = "signals";
/// The interval at which the processes of a fixture are measured.
const MEASURE_EVERY: Duration = Duration::from_millis(100);

/// The declared signals and monitors of a suite.
pub(super) struct DeclaredSignals {
    /// The sources.
    pub sources: Vec<DeclaredSource>,
    /// The monitors of all tests.
    pub monitors: Vec<DeclaredMonitor>,
    /// The files of limits.
    pub envelopes: Vec<DeclaredEnvelope>,
    /// The monitors of single tests.
    pub of_tests: OfTests<DeclaredMonitor>,
    /// The names that the suite gives to its fixtures.
    pub fixtures: Vec<String>,
    /// Whether the suite has a simulated clock.
    pub has_clock: bool,
}

/// Plans the signals and monitors, and adds their fixture after all others.
pub(super) fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    declared: DeclaredSignals,
    fixtures: &mut Vec<FixturePlan>,
) {
    let all = || declared.sources.iter().flat_map(|source| &source.signals);
    let problems = &mut planner.context.problems;
    let before = problems.len();
    let names = all().map(|signal| Some(&signal.name));
    UniqueNames::reserve("signal", names, source, problems);
    let signals: Vec<_> = all().collect();
    let mut monitors =
        monitors::plan(&declared.monitors, &declared.of_tests, &signals, (source, problems));
    let dir = planner.scope().dir.to_path_buf();
    let envelopes = (dir.as_path(), declared.envelopes.as_slice());
    envelopes::plan(planner.context, source, (envelopes, &signals), &mut monitors);
    let Some(first) = all().next().map(|signal| signal.name.span) else { return };
    let (sources, args) = SourcePlanner { planner, source, fixtures, declared: &declared }.plan();
    if planner.context.problems.len() > before {
        return;
    }
    let config = SignalsConfig { sources, monitors, has_clock: declared.has_clock };
    let Ok(param) = serde_json::to_string(&config) else { return };
    let site = UseSite::Suite(Arc::clone(source), first);
    let Some(plugin) = planner.plan_built_in(&SIGNALS, source.name(), (param, args), &site) else {
        return;
    };
    let is_taken = |name: &String| fixtures.iter().any(|other| other.name == *name);
    let numbered = (2..).map(|number| format!("{NAME}#{number}"));
    let name = std::iter::once(NAME.to_owned()).chain(numbered).find(|name| !is_taken(name));
    fixtures.push(FixturePlan {
        id: FixtureId(0),
        name: name.unwrap_or_default(),
        provides: Vec::new(),
        depends: (0..fixtures.len()).collect(),
        body: FixtureBody::Plugin(plugin),
        env: Vec::new(),
        limits: defaults::FIXTURE,
        reset: None,
        restarts: RESTARTS,
        restart_delay: RESTART_DELAY,
        check_every: None,
    });
}

struct SourcePlanner<'p, 'a, 'c> {
    planner: &'p mut PluginPlanner<'a, 'c>,
    source: &'p SourceText,
    fixtures: &'p [FixturePlan],
    declared: &'p DeclaredSignals,
}

impl SourcePlanner<'_, '_, '_> {
    /// Returns the sources, and the programs as arguments of the plug-in, in which references
    /// are replaced when it starts.
    fn plan(mut self) -> (Vec<SignalSource>, Vec<String>) {
        let declared = self.declared;
        let mut args = Vec::new();
        let mut sources: Vec<_> =
            declared.sources.iter().filter_map(|one| self.one(one, &mut args)).collect();
        sources.extend(self.topics(&mut args));
        (sources, args)
    }

    /// One program reads the fields of all topics.
    fn topics(&mut self, args: &mut Vec<String>) -> Option<SignalSource> {
        let of_topics = self.declared.sources.iter().filter_map(|source| match &source.kind {
            DeclaredSourceKind::Ros(field) => Some((field, source.signals.first()?)),
            _ => None,
        });
        let (fields, signals): (Vec<_>, Vec<_>) = of_topics.unzip();
        let first = fields.first()?;
        match middleware::signals(&self.planner.scope()) {
            Ok(words) => {
                let all = words.into_iter().chain(fields.iter().map(|field| field.value.clone()));
                let before = args.len();
                args.extend(all);
                Some(SignalSource::Program(SignalProgram {
                    words: args.len() - before,
                    signals: signals.into_iter().map(config_of).collect(),
                    time: SignalTime::Clock,
                    wait: true,
                }))
            }
            Err(problem) => {
                let label = self.source.label(first.span, "");
                self.planner.context.problems.push(problem.label(label));
                None
            }
        }
    }

    fn one(&mut self, declared: &DeclaredSource, args: &mut Vec<String>) -> Option<SignalSource> {
        match &declared.kind {
            DeclaredSourceKind::Program { command, time, wait } => {
                let (scope, problems) = (self.planner.scope(), &mut self.planner.context.problems);
                let words = program::command(command.clone(), &scope, self.source, problems);
                let signals = declared.signals.iter().map(config_of).collect();
                let program =
                    SignalProgram { words: words.len(), signals, time: *time, wait: *wait };
                args.extend(words);
                Some(SignalSource::Program(program))
            }
            DeclaredSourceKind::Ros(_) => None,
            DeclaredSourceKind::Fixture { name, quantity, every } => {
                let fixtures =
                    SuiteFixtures { planned: self.fixtures, declared: &self.declared.fixtures };
                if let Some(problem) = fixtures.process_problem(name, "measured") {
                    let label = self.source.label(name.span, "");
                    self.planner.context.problems.push(problem.label(label));
                }
                let every = every.unwrap_or(MEASURE_EVERY).as_millis();
                Some(SignalSource::Fixture(MeasuredFixture {
                    signal: declared.signals.first().map(config_of)?,
                    fixture: name.value.clone(),
                    quantity: *quantity,
                    every_ms: u64::try_from(every).unwrap_or(u64::MAX).max(1),
                }))
            }
        }
    }
}

fn config_of(signal: &DeclaredSignal) -> SignalConfig {
    SignalConfig { name: signal.name.value.clone(), unit: signal.unit.value.clone() }
}
