//! The fixtures of a suite → [`FixturePlan`]s.

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::{Diagnostic, FixtureId};

use super::context::{PluginPlanner, Role};
use super::names::Names;
use super::plugin::base_name;
use super::scope::Scope;
use super::{
    FixtureBody, FixtureLimits, FixturePlan, Probe, ProbeKind, ProcessPlan, hosts, program,
};
use crate::suite::{self, Fixture, FixtureKind, Process, Question, Source, Span, Spanned, nearest};

/// `spec/suite.md` lists these.
const SETUP: Duration = Duration::from_secs(60);
const CHECK: Duration = Duration::from_secs(5);
const TEARDOWN: Duration = Duration::from_secs(30);
const RESTARTS: u32 = 3;
const READY_EVERY: Duration = Duration::from_millis(100);
const ALIVE_EVERY: Duration = Duration::from_secs(1);
const ANSWER: Duration = Duration::from_secs(1);
const STOP_SIGNAL: i32 = 15;
const STOP_GRACE: Duration = Duration::from_secs(5);

/// Plans all fixtures of a suite, in the order of set-up.
pub(super) fn plan_all(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<Source>,
    fixtures: Vec<Fixture>,
) -> Vec<FixturePlan> {
    let given = fixtures.iter().map(|fixture| fixture.name.as_ref());
    let mut made_up = Names::given("fixture", given, source, &mut planner.context.problems);
    let names: Vec<String> = fixtures
        .iter()
        .map(|fixture| match &fixture.name {
            Some(name) => name.value.clone(),
            None => made_up.unique(base_of(fixture)),
        })
        .collect();
    let mut plans = Vec::new();
    for (index, fixture) in fixtures.into_iter().enumerate() {
        for wanted in &fixture.depends {
            if let Some(problem) = dependency(wanted, &names, index) {
                let label = source.label(wanted.span, "");
                planner.context.problems.push(problem.label(label));
            }
        }
        plans.extend(plan(planner, source, fixture, names[index].clone()));
    }
    plans
}

/// The name of a fixture that has none of its own.
fn base_of(fixture: &Fixture) -> &str {
    match &fixture.body {
        FixtureKind::Plugin(plugin) => base_name(&plugin.name.value),
        FixtureKind::Process(process) => {
            let program = process.command.value.first().map_or("process", String::as_str);
            Path::new(program).file_name().and_then(|name| name.to_str()).unwrap_or(program)
        }
    }
}

/// What is wrong with an entry of `depends`: fixtures are set up in the order
/// of the file, so only an earlier one can be depended on.
fn dependency(wanted: &Spanned<String>, names: &[String], index: usize) -> Option<Diagnostic> {
    let name = &wanted.value;
    let problem = |message: String| Diagnostic::error("unknown-dependency", message);
    match names.iter().position(|known| known == name) {
        Some(at) if at < index => None,
        Some(at) if at == index => Some(problem(format!("the fixture `{name}` depends on itself"))),
        Some(_) => Some(
            problem(format!("the fixture `{name}` comes later"))
                .note("fixtures are set up in the order in which they are written")
                .hint(format!("write `{name}` before this one")),
        ),
        None => {
            let unknown = problem(format!("there is no fixture `{name}`"));
            let nearest = nearest(name, names[..index].iter().map(String::as_str));
            Some(match nearest {
                Some(known) => unknown.hint(format!("did you mean `{known}`?")),
                None => unknown,
            })
        }
    }
}

fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<Source>,
    fixture: Fixture,
    name: String,
) -> Option<FixturePlan> {
    let limits = FixtureLimits {
        setup: fixture.setup.unwrap_or(SETUP),
        check: fixture.check.unwrap_or(CHECK),
        teardown: fixture.teardown.unwrap_or(TEARDOWN),
    };
    let check_every = fixture.check_every;
    let body = match fixture.body {
        FixtureKind::Plugin(plugin) => {
            FixtureBody::Plugin(planner.plan(plugin, source, &fixture.env, Role::Fixture)?)
        }
        FixtureKind::Process(process) => {
            let suite_scope = planner.scope();
            let scope = suite_scope.with(&fixture.env);
            let mut planner =
                ProcessPlanner { source, scope, problems: &mut planner.context.problems };
            FixtureBody::Process(Box::new(planner.plan(*process, check_every)))
        }
    };
    Some(FixturePlan {
        id: FixtureId(0),
        name,
        depends: Vec::new(),
        body,
        env: fixture.env,
        limits,
        restarts: fixture.restarts.unwrap_or(RESTARTS),
        restart_delay: Duration::ZERO,
        check_every,
    })
}

struct ProcessPlanner<'a> {
    source: &'a Arc<Source>,
    scope: Scope<'a>,
    problems: &'a mut Vec<Diagnostic>,
}

impl ProcessPlanner<'_> {
    fn plan(&mut self, written: Process, check_every: Option<Duration>) -> ProcessPlan {
        let alive_every = check_every.unwrap_or(ALIVE_EVERY);
        let mut probes = |probes: Vec<suite::Probe>, every| {
            probes.into_iter().map(|probe| self.probe(probe, every)).collect()
        };
        let ready = probes(written.ready, READY_EVERY);
        let alive = probes(written.alive, alive_every);
        ProcessPlan {
            command: self.command(written.command.value, written.command.span),
            folder: self.scope.folder.to_path_buf(),
            ready,
            alive,
            stop_signal: written.stop_signal.unwrap_or(STOP_SIGNAL),
            stop_grace: written.stop_grace.unwrap_or(STOP_GRACE),
        }
    }

    fn probe(&mut self, written: suite::Probe, every: Duration) -> Probe {
        let kind = match written.question {
            Question::Tcp(address) => ProbeKind::Tcp(address),
            Question::Http(url) => ProbeKind::Http(url),
            Question::Log(pattern) => ProbeKind::Log(pattern),
            Question::Command(words) => ProbeKind::Command(self.command(words, written.span)),
            Question::File(path) => ProbeKind::File(self.scope.folder.join(path)),
        };
        Probe {
            kind,
            every: written.every.unwrap_or(every),
            timeout: written.timeout.unwrap_or(ANSWER),
        }
    }

    /// The command with its program found.
    fn command(&mut self, mut words: Vec<String>, span: Span) -> Vec<String> {
        let Some(first) = words.first_mut() else { return words };
        match program::find(first, &self.scope).and_then(|file| hosts::text(&file)) {
            Ok(file) => *first = file,
            Err(problem) => self.problems.push(problem.label(self.source.label(span, ""))),
        }
        words
    }
}
