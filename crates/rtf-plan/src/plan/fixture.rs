//! Plans the fixtures of a suite.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::{Diagnostic, FixtureId};

use super::fixture_values::DeclaredValues;
use super::names::UniqueNames;
use super::plugin_planner::PluginPlanner;
use super::plugin_search::base_name;
use super::search_scope::SearchScope;
use super::use_site::PluginRole;
use super::{
    FixtureBody, FixtureLimits, FixturePlan, Probe, ProbeKind, ProbePlans, ProcessPlan,
    ProvidePlan, RemotePlan, ResetPlan, ValueProbe, defaults, dependencies, hook, middleware,
    program,
};
use crate::suite::{
    self, DeclaredFixture, DeclaredProbeKind, DeclaredProbes, DeclaredProcess, DeclaredProvide,
    DeclaredValueSource, FixtureKind, FixtureReference, SourceText, Spanned,
};

// `spec/suite.md` lists these defaults.
const READY_EVERY: Duration = Duration::from_millis(100);
const ALIVE_EVERY: Duration = Duration::from_secs(1);
const PROBE_TIMEOUT: Duration = Duration::from_secs(1);
/// The limit for a command that prints a value; set-up has a limit, too.
const VALUE_TIMEOUT: Duration = Duration::from_secs(10);
/// The variable with the user's `ssh` command line.
const SSH_VARIABLE: &str = "RTF_SSH";
/// The limit of `<reset>`.
const RESET_TIMEOUT: Duration = Duration::from_secs(10);
const STOP_SIGNAL: i32 = 15;
const STOP_GRACE: Duration = Duration::from_secs(5);

/// Plans all fixtures of a suite, each after its dependencies.
pub(super) fn plan_all(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    (fixtures, references): (Vec<DeclaredFixture>, &[FixtureReference]),
) -> Vec<FixturePlan> {
    let declared = fixtures.iter().map(|fixture| fixture.name.as_ref());
    let problems = &mut planner.context.problems;
    let mut unique = UniqueNames::reserve("fixture", declared, source, problems);
    let names: Vec<String> = fixtures
        .iter()
        .map(|fixture| match &fixture.name {
            Some(name) => name.value.clone(),
            None => unique.unique(default_name(fixture)),
        })
        .collect();
    let steps = dependencies::setup_order(&fixtures, &names, source, problems);
    let values = DeclaredValues { fixtures: &fixtures, names: &names, steps: &steps };
    values.check(references, source, problems);
    let mut fixtures: Vec<_> = fixtures.into_iter().zip(names).map(Some).collect();
    let mut plans = Vec::with_capacity(steps.len());
    for step in steps {
        let Some((fixture, name)) = fixtures[step.fixture].take() else { continue };
        let planned = plan(planner, source, fixture, name);
        plans.extend(planned.map(|planned| FixturePlan { depends: step.depends, ..planned }));
    }
    plans
}

/// Returns the name of a fixture without `name`.
fn default_name(fixture: &DeclaredFixture) -> &str {
    match &fixture.body {
        FixtureKind::Plugin(plugin) => base_name(&plugin.name.value),
        FixtureKind::Process(process) => program::base_name(&process.command.value),
        FixtureKind::Attached(_) => "attached",
    }
}

fn plan(
    planner: &mut PluginPlanner<'_, '_>,
    source: &Arc<SourceText>,
    fixture: DeclaredFixture,
    name: String,
) -> Option<FixturePlan> {
    let limits = FixtureLimits {
        setup: fixture.setup.unwrap_or(defaults::FIXTURE.setup),
        check: fixture.check.unwrap_or(defaults::FIXTURE.check),
        notify: fixture.notify.unwrap_or(defaults::FIXTURE.notify),
        teardown: fixture.teardown.unwrap_or(defaults::FIXTURE.teardown),
    };
    let check_every = fixture.check_every;
    let reset = match fixture.reset {
        Some(reset) => Some(ResetPlan {
            body: hook::plan_body(planner, source, reset.body, &fixture.env)?,
            timeout: reset.timeout.unwrap_or(RESET_TIMEOUT),
            restart_every: reset.restart_every,
        }),
        None => None,
    };
    let scope = planner.scope();
    let body = match fixture.body {
        FixtureKind::Plugin(plugin) => {
            let role = PluginRole::Fixture;
            FixtureBody::Plugin(planner.plan(plugin, source, &fixture.env, role)?)
        }
        FixtureKind::Process(process) => {
            let scope = scope.with(&fixture.env);
            let mut planner =
                ProcessPlanner { source, scope, problems: &mut planner.context.problems };
            FixtureBody::Process(Arc::new(planner.plan(*process, &fixture.provides, check_every)))
        }
        FixtureKind::Attached(probes) => {
            let scope = scope.with(&fixture.env);
            let mut planner =
                ProcessPlanner { source, scope, problems: &mut planner.context.problems };
            let attached = planner.plan_attached(probes, &fixture.provides, check_every);
            FixtureBody::Attached(Arc::new(attached))
        }
    };
    Some(FixturePlan {
        id: FixtureId(0),
        name,
        depends: Vec::new(),
        provides: fixture.provides.into_iter().map(provide).collect(),
        body,
        env: fixture.env,
        limits,
        reset,
        restarts: fixture.restarts.unwrap_or(defaults::RESTARTS),
        restart_delay: fixture.restart_delay.unwrap_or(defaults::RESTART_DELAY),
        check_every,
    })
}

fn provide(declared: DeclaredProvide) -> ProvidePlan {
    ProvidePlan { name: declared.name.value, secret: declared.secret }
}

struct ProcessPlanner<'a> {
    source: &'a Arc<SourceText>,
    scope: SearchScope<'a>,
    problems: &'a mut Vec<Diagnostic>,
}

impl ProcessPlanner<'_> {
    fn plan(
        &mut self,
        declared: DeclaredProcess,
        provides: &[DeclaredProvide],
        check_every: Option<Duration>,
    ) -> ProcessPlan {
        let probes = self.probes(declared.probes, provides, check_every);
        let remote =
            declared.host.map(|host| RemotePlan { ssh: self.ssh(&host), host: host.value });
        let command = match remote {
            Some(_) => declared.command.value,
            None => self.command(declared.command),
        };
        ProcessPlan {
            command,
            probes,
            stop_signal: declared.stop_signal.unwrap_or(STOP_SIGNAL),
            stop_grace: declared.stop_grace.unwrap_or(STOP_GRACE),
            stop_codes: declared.stop_codes,
            remote,
        }
    }

    /// All probes must pass before it is ready. Without `<alive>`, the `<ready>`
    /// probes also run as `<alive>` probes.
    fn plan_attached(
        &mut self,
        declared: DeclaredProbes,
        provides: &[DeclaredProvide],
        check_every: Option<Duration>,
    ) -> ProbePlans {
        let intervals: Vec<_> = declared.ready.iter().map(|probe| probe.every).collect();
        let every = check_every.unwrap_or(ALIVE_EVERY);
        let plans = self.probes(declared, provides, check_every);
        let ProbePlans { mut ready, mut alive, values } = plans;
        let at = |probe: &Probe, every| Probe { every, ..probe.clone() };
        if alive.is_empty() {
            let both = ready.iter().zip(intervals);
            alive = both.map(|(probe, interval)| at(probe, interval.unwrap_or(every))).collect();
        } else {
            ready.extend(alive.iter().map(|probe| at(probe, READY_EVERY)));
        }
        ProbePlans { ready, alive, values }
    }

    fn probes(
        &mut self,
        declared: DeclaredProbes,
        provides: &[DeclaredProvide],
        check_every: Option<Duration>,
    ) -> ProbePlans {
        let mut plan = |probes: Vec<suite::DeclaredProbe>, every| {
            probes.into_iter().map(|probe| self.probe(probe, every)).collect()
        };
        ProbePlans {
            ready: plan(declared.ready, READY_EVERY),
            alive: plan(declared.alive, check_every.unwrap_or(ALIVE_EVERY)),
            values: self.values(provides),
        }
    }

    fn values(&mut self, provides: &[DeclaredProvide]) -> Vec<ValueProbe> {
        let mut values = Vec::with_capacity(provides.len());
        for provide in provides {
            let kind = match &provide.source {
                DeclaredValueSource::Plugin => continue,
                DeclaredValueSource::Log(pattern) => ProbeKind::Log(pattern.clone()),
                DeclaredValueSource::File(path) => ProbeKind::File(self.scope.dir.join(path)),
                DeclaredValueSource::Command(words) => {
                    ProbeKind::Command(self.command(words.clone()))
                }
            };
            let probe = Probe { kind, every: READY_EVERY, timeout: VALUE_TIMEOUT };
            values.push(ValueProbe { name: provide.name.value.clone(), probe });
        }
        values
    }

    fn probe(&mut self, declared: suite::DeclaredProbe, every: Duration) -> Probe {
        let mut timeout = declared.timeout.unwrap_or(PROBE_TIMEOUT);
        let kind = match declared.kind {
            DeclaredProbeKind::Tcp(address) => ProbeKind::Tcp(address),
            DeclaredProbeKind::Http(url) => ProbeKind::Http(url),
            DeclaredProbeKind::Log(pattern) => ProbeKind::Log(pattern),
            DeclaredProbeKind::Command(words) => {
                ProbeKind::Command(self.command(Spanned::new(words, declared.span)))
            }
            DeclaredProbeKind::File(path) => ProbeKind::File(self.scope.dir.join(path)),
            DeclaredProbeKind::Middleware(query) => {
                let limit = declared.timeout.unwrap_or(middleware::TIMEOUT);
                timeout = limit + middleware::STARTUP_TIME;
                middleware::probe(&query, limit, &self.scope).unwrap_or_else(|problem| {
                    self.problems.push(problem.label(self.source.label(declared.span, "")));
                    ProbeKind::Command(Vec::new())
                })
            }
        };
        Probe { kind, every: declared.every.unwrap_or(every), timeout }
    }

    /// Returns the user's `ssh` command with its options.
    fn ssh(&mut self, host: &Spanned<String>) -> Vec<String> {
        let variable = self.scope.variable(SSH_VARIABLE).filter(|line| !line.is_empty());
        let line = variable.unwrap_or("ssh");
        match shell_words::split(line) {
            Ok(words) if !words.is_empty() => self.command(Spanned::new(words, host.span)),
            _ => {
                let message = format!("`{SSH_VARIABLE}` is not a command: `{line}`");
                self.problems.push(self.source.error("invalid-value", host.span, message));
                Vec::new()
            }
        }
    }

    fn command(&mut self, declared: Spanned<Vec<String>>) -> Vec<String> {
        program::command(declared, &self.scope, self.source, self.problems)
    }
}
