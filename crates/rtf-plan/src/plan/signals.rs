//! The additional fixture of a suite with signals: it records them while tests run, and
//! evaluates the monitors.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::{
    Diagnostic, MeasuredFixture, SignalConfig, SignalProgram, SignalRecording, SignalSource,
    SignalTime, SignalsConfig, TestSignal,
};

use super::hosts::SIGNALS;
use super::monitors;
use super::names::UniqueNames;
use super::of_tests::OfTests;
use super::own_processes::SuiteFixtures;
use super::plugin_planner::PluginPlanner;
use super::use_site::UseSite;
use super::{FixturePlan, HookBody, ResetPlan, added_fixture, envelopes, middleware, program};
use crate::suite::{
    DeclaredEnvelope, DeclaredMonitor, DeclaredSignal, DeclaredSource, DeclaredSourceKind,
    SignalMiddleware, SourceText, Spanned, episode_reference,
};

/// The name of the fixture and of its type.
const NAME: &str = "signals";
/// The limit of its reset between two episodes.
const RESET_TIMEOUT: Duration = Duration::from_secs(10);
/// The interval at which the processes of a fixture are measured.
const MEASURE_EVERY: Duration = Duration::from_millis(100);

/// The declared signals and monitors of a suite.
pub(super) struct DeclaredSignals {
    pub sources: Vec<DeclaredSource>,
    /// The monitors of all tests.
    pub monitors: Vec<DeclaredMonitor>,
    /// The files of limits.
    pub envelopes: Vec<DeclaredEnvelope>,
    /// The monitors of single tests.
    pub of_tests: OfTests<DeclaredMonitor>,
    /// The names that the suite gives to its fixtures.
    pub fixtures: Vec<String>,
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
    let reset = reset(planner, &param, &args);
    let site = UseSite::Suite(Arc::clone(source), first);
    let Some(plugin) = planner.plan_built_in(&SIGNALS, source.name(), (param, args), &site) else {
        return;
    };
    let name = added_fixture::free_name(NAME, fixtures);
    let fixture = added_fixture::plan(name, plugin, fixtures);
    fixtures.push(FixturePlan { reset, ..fixture });
}

/// Between two episodes of a campaign, nothing has to be done, unless the fixture or its programs
/// depend on the parameters of the episode: then it is restarted.
fn reset(planner: &PluginPlanner<'_, '_>, param: &str, args: &[String]) -> Option<ResetPlan> {
    let scope = planner.scope();
    let env = scope.suite_env.iter().map(|(_, value)| value.as_str());
    let mut texts = args.iter().map(String::as_str).chain([param]).chain(env);
    if texts.any(episode_reference::mentions) {
        return None;
    }
    let nothing = program::find("true", &scope).and_then(|file| program::utf8(&file)).ok()?;
    let body = HookBody::Command(vec![nothing]);
    Some(ResetPlan { body, timeout: RESET_TIMEOUT, restart_every: None })
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
        for (_, middleware) in SignalMiddleware::ALL {
            sources.extend(self.topics(middleware, &mut args));
        }
        sources.extend(self.recordings(&mut args));
        (sources, args)
    }

    /// One program reads the values of all topics, or ports, of a middleware.
    fn topics(&mut self, wanted: SignalMiddleware, args: &mut Vec<String>) -> Option<SignalSource> {
        let of_topics = self.declared.sources.iter().filter_map(|source| match &source.kind {
            DeclaredSourceKind::Topic { middleware, field } if *middleware == wanted => {
                Some((field, source.signals.first()?))
            }
            _ => None,
        });
        let (fields, signals): (Vec<_>, Vec<_>) = of_topics.unzip();
        let program = middleware::signals(wanted, &self.planner.scope());
        let mut words = self.found(program, fields.first()?)?;
        // ROS 1 has a parameter for it.
        if self.declared.has_clock && wanted != SignalMiddleware::Ros {
            words.push("--clock".to_owned());
        }
        words.extend(fields.iter().map(|field| field.value.clone()));
        let source = SignalSource::Program(SignalProgram {
            words: words.len(),
            signals: signals.into_iter().map(config_of).collect(),
            time: SignalTime::Clock,
            wait: true,
            other_clock: self.clock_of_topics(wanted),
        });
        args.append(&mut words);
        Some(source)
    }

    /// What helps if the messages of a middleware have times of another clock.
    fn clock_of_topics(&self, middleware: SignalMiddleware) -> String {
        match (self.declared.has_clock, middleware) {
            (false, _) => {
                let name = SignalMiddleware::ALL.iter().find(|(_, one)| *one == middleware);
                let name = name.map_or("", |(name, _)| name);
                format!("`clock=\"{name}\"` in `<suite>` is for simulated times")
            }
            (true, SignalMiddleware::Yarp) => "the sender has to use the simulated time".into(),
            (true, SignalMiddleware::Ros | SignalMiddleware::Ros2) => {
                "its node has to use the simulated time (`use_sim_time`)".into()
            }
        }
    }

    /// One program for each file.
    fn recordings(&mut self, args: &mut Vec<String>) -> Vec<SignalSource> {
        let recorded = self.declared.sources.iter().filter_map(|source| match &source.kind {
            DeclaredSourceKind::Recording { file, field } => {
                Some((file, field, source.signals.first()?))
            }
            _ => None,
        });
        let recorded: Vec<_> = recorded.collect();
        let mut files: Vec<&Spanned<String>> = Vec::new();
        for (file, ..) in &recorded {
            if !files.iter().any(|known| known.value == file.value) {
                files.push(file);
            }
        }
        let mut sources = Vec::new();
        for file in files {
            self.report_missing(file);
            let program = middleware::recorded_signals(&self.planner.scope());
            let Some(mut words) = self.found(program, file) else { continue };
            words.push(file.value.clone());
            let of_file = recorded.iter().filter(|(other, ..)| other.value == file.value);
            let (fields, signals) =
                of_file.map(|(_, field, signal)| (field.value.clone(), config_of(signal))).unzip();
            let fields: Vec<String> = fields;
            words.extend(fields);
            sources.push(SignalSource::Recording(SignalRecording { words: words.len(), signals }));
            args.append(&mut words);
        }
        sources
    }

    /// Reports a file that does not exist. References are replaced when the suite runs.
    fn report_missing(&mut self, file: &Spanned<String>) {
        let path = self.planner.scope().dir.join(&file.value);
        if file.value.contains("${") || path.exists() {
            return;
        }
        let message = format!("there is no recording `{}`", file.value);
        let problem = Diagnostic::error("no-such-file", message)
            .note(format!("looked for {}", path.display()))
            .label(self.source.label(file.span, ""));
        self.planner.context.problems.push(problem);
    }

    /// A program, or reports at this place that it is missing.
    fn found(
        &mut self,
        program: Result<Vec<String>, Box<Diagnostic>>,
        place: &Spanned<String>,
    ) -> Option<Vec<String>> {
        let report = |problem: Box<Diagnostic>| {
            let label = self.source.label(place.span, "");
            self.planner.context.problems.push(problem.label(label));
        };
        program.map_err(report).ok()
    }

    fn one(&mut self, declared: &DeclaredSource, args: &mut Vec<String>) -> Option<SignalSource> {
        match &declared.kind {
            DeclaredSourceKind::Program { command, time, wait } => {
                let (scope, problems) = (self.planner.scope(), &mut self.planner.context.problems);
                let words = program::command(command.clone(), &scope, self.source, problems);
                let signals = declared.signals.iter().map(config_of).collect();
                let program = SignalProgram {
                    words: words.len(),
                    signals,
                    time: *time,
                    wait: *wait,
                    other_clock: "`time=\"own\"` in the suite is for another clock".to_owned(),
                };
                args.extend(words);
                Some(SignalSource::Program(program))
            }
            // Several of them share a program.
            DeclaredSourceKind::Topic { .. } | DeclaredSourceKind::Recording { .. } => None,
            DeclaredSourceKind::Test(quantity) => {
                let signal = declared.signals.first().map(config_of)?;
                Some(SignalSource::Test(TestSignal { signal, quantity: *quantity }))
            }
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
