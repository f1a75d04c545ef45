//! The fixtures of a suite → [`FixturePlan`]s.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::{Diagnostic, FixtureId};

use super::context::{PluginPlanner, Role};
use super::names::Names;
use super::plugin::base_name;
use super::scope::Scope;
use super::{
    AttachedPlan, FixtureBody, FixtureLimits, FixturePlan, Probe, ProbeKind, ProcessPlan,
    RemotePlan, defaults, depends, middleware, program,
};
use crate::suite::{self, Attached, Fixture, FixtureKind, Process, Question, Source, Spanned};

/// `spec/suite.md` lists these.
pub(super) const RESTARTS: u32 = 3;
pub(super) const RESTART_DELAY: Duration = Duration::from_millis(100);
const READY_EVERY: Duration = Duration::from_millis(100);
const ALIVE_EVERY: Duration = Duration::from_secs(1);
const ANSWER: Duration = Duration::from_secs(1);
/// The user's `ssh`, with options: a command line.
const SSH_VARIABLE: &str = "RTF_SSH";
const STOP_SIGNAL: i32 = 15;
const STOP_GRACE: Duration = Duration::from_secs(5);

/// Plans all fixtures of a suite, each after those that it depends on.
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
    let turns = depends::order(&fixtures, &names, source, &mut planner.context.problems);
    let mut fixtures: Vec<_> = fixtures.into_iter().zip(names).map(Some).collect();
    let mut plans = Vec::with_capacity(turns.len());
    for turn in turns {
        let Some((fixture, name)) = fixtures[turn.fixture].take() else { continue };
        let planned = plan(planner, source, fixture, name);
        plans.extend(planned.map(|planned| FixturePlan { depends: turn.depends, ..planned }));
    }
    plans
}

/// The name of a fixture that has none of its own.
fn base_of(fixture: &Fixture) -> &str {
    match &fixture.body {
        FixtureKind::Plugin(plugin) => base_name(&plugin.name.value),
        FixtureKind::Process(process) => program::base_name(&process.command.value),
        FixtureKind::Attached(_) => "attached",
    }
}

fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<Source>,
    fixture: Fixture,
    name: String,
) -> Option<FixturePlan> {
    let limits = FixtureLimits {
        setup: fixture.setup.unwrap_or(defaults::FIXTURE.setup),
        check: fixture.check.unwrap_or(defaults::FIXTURE.check),
        notice: fixture.notice.unwrap_or(defaults::FIXTURE.notice),
        teardown: fixture.teardown.unwrap_or(defaults::FIXTURE.teardown),
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
            FixtureBody::Process(Arc::new(planner.plan(*process, check_every)))
        }
        FixtureKind::Attached(attached) => {
            let suite_scope = planner.scope();
            let scope = suite_scope.with(&fixture.env);
            let mut planner =
                ProcessPlanner { source, scope, problems: &mut planner.context.problems };
            FixtureBody::Attached(Arc::new(planner.plan_attached(attached, check_every)))
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
        restart_delay: fixture.restart_delay.unwrap_or(RESTART_DELAY),
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
        let remote = written.host.map(|host| RemotePlan { ssh: self.ssh(&host), host: host.value });
        let command = match remote {
            Some(_) => written.command.value,
            None => self.command(written.command),
        };
        ProcessPlan {
            command,
            ready,
            alive,
            stop_signal: written.stop_signal.unwrap_or(STOP_SIGNAL),
            stop_grace: written.stop_grace.unwrap_or(STOP_GRACE),
            remote,
        }
    }

    /// It is ready when all its probes hold; without `<alive>` the `<ready>` ones
    /// are asked all the time.
    fn plan_attached(&mut self, written: Attached, check_every: Option<Duration>) -> AttachedPlan {
        let every = check_every.unwrap_or(ALIVE_EVERY);
        let often: Vec<_> = written.ready.iter().map(|probe| probe.every).collect();
        let mut probes = |probes: Vec<suite::Probe>, every| -> Vec<Probe> {
            probes.into_iter().map(|probe| self.probe(probe, every)).collect()
        };
        let mut ready = probes(written.ready, READY_EVERY);
        let mut alive = probes(written.alive, every);
        let at = |probe: &Probe, every| Probe { every, ..probe.clone() };
        if alive.is_empty() {
            let both = ready.iter().zip(often);
            alive = both.map(|(probe, often)| at(probe, often.unwrap_or(every))).collect();
        } else {
            ready.extend(alive.iter().map(|probe| at(probe, READY_EVERY)));
        }
        AttachedPlan { ready, alive }
    }

    fn probe(&mut self, written: suite::Probe, every: Duration) -> Probe {
        let mut timeout = written.timeout.unwrap_or(ANSWER);
        let kind = match written.question {
            Question::Tcp(address) => ProbeKind::Tcp(address),
            Question::Http(url) => ProbeKind::Http(url),
            Question::Log(pattern) => ProbeKind::Log(pattern),
            Question::Command(words) => {
                ProbeKind::Command(self.command(Spanned::new(words, written.span)))
            }
            Question::File(path) => ProbeKind::File(self.scope.folder.join(path)),
            Question::Middleware(asked) => {
                let limit = written.timeout.unwrap_or(middleware::ANSWER);
                timeout = limit + middleware::START;
                middleware::probe(&asked, limit, &self.scope).unwrap_or_else(|problem| {
                    self.problems.push(problem.label(self.source.label(written.span, "")));
                    ProbeKind::Command(Vec::new())
                })
            }
        };
        Probe { kind, every: written.every.unwrap_or(every), timeout }
    }

    /// The user's `ssh` with its options.
    fn ssh(&mut self, host: &Spanned<String>) -> Vec<String> {
        let named = self.scope.variable(SSH_VARIABLE).filter(|named| !named.is_empty());
        let written = named.unwrap_or("ssh");
        match shell_words::split(written) {
            Ok(words) if !words.is_empty() => self.command(Spanned::new(words, host.span)),
            _ => {
                let message = format!("`{SSH_VARIABLE}` is no command: `{written}`");
                let label = self.source.label(host.span, "");
                self.problems.push(Diagnostic::error("invalid-value", message).label(label));
                Vec::new()
            }
        }
    }

    fn command(&mut self, written: Spanned<Vec<String>>) -> Vec<String> {
        program::command(written, &self.scope, self.source, self.problems)
    }
}
