//! Starts the processes of a suite.

use rtf_model::protocol::{ENVIRONMENT_VARIABLE, RUN_DIR_VARIABLE};
use rtf_model::{Source, TestId};
use tokio::sync::mpsc;

use super::SuiteTask;
use crate::guard::{FixtureStop, HookStart};
use crate::run::context::{DebugMode, attachments_dir};
use crate::run::machine::kill_escalation::SIGTERM;
use crate::run::machine::{HostId, Program, StartRequest};
use crate::run::probes;
use crate::unbuffered;
use rtf_plan::plan::{Leaks, ProcessPlan, TestPlan};
use rtf_process::launch::Launch;
use rtf_process::spawn_request::{ProcessRole, SpawnRequest, Streams};
use rtf_process::spawner::Spawner;
use rtf_process::ssh::{self, RemoteCommand};
use rtf_process::start_gate;
use rtf_process::task::{AttachedJob, ProcessJob, run_process, watch_attached};

impl SuiteTask<'_> {
    pub(super) fn spawn(&mut self, host: HostId, source: Source, mut start: StartRequest) {
        start.env.extend(self.take_domain(host, source));
        let (mut process, mut attached) = (None, None);
        match &start.what {
            Program::Host(_) | Program::Command(_) => {}
            Program::Process(plan) => process = Some(plan.clone()),
            Program::Attached(plan) => attached = Some(plan.clone()),
        }
        let request = self.request(start, role_of(source));
        let (commands, queue) = mpsc::unbounded_channel();
        self.commands.insert(host, (source, commands));
        let launch = match self.prelaunched.iter().position(|launch| launch.request == request) {
            Some(index) => self.prelaunched.remove(index),
            None => self.launch(request),
        };
        if let Some(plan) = attached {
            let probes = probes::convert(&plan, self.network.clone());
            let (job, spawner) = (AttachedJob { host, probes, launch }, self.spawner().clone());
            let watch = watch_attached(job, spawner, queue, self.inputs.clone());
            return drop(tokio::spawn(watch));
        }
        if let Some(start) = self.triggered.take_if(|_| matches!(source, Source::Hook(_))) {
            self.context.guard.hook_starting(HookStart { scope: launch.scope.clone(), ..start });
        }
        let stop = self.fixture_stop(source, process.as_deref(), &launch);
        let job = ProcessJob {
            host,
            owner: self.context.process_owner(source, stop),
            launch,
            attachments_dir: attachments_dir(source, host),
            is_grouped: self.is_grouped(source),
            is_measured: self.is_measured(source, process.as_deref()),
            probes: process.map(|process| probes::convert(&process.probes, self.network.clone())),
            waits_for_debugger: self.debug_mode(role_of(source)) == Some(DebugMode::Wait),
        };
        let tasks = self.context.tasks.clone();
        tokio::spawn(run_process(job, tasks, queue, self.inputs.clone()));
    }

    /// Returns the variables of a domain for a test that has its own, until its process has ended.
    fn take_domain(&mut self, host: HostId, source: Source) -> Vec<(String, String)> {
        let Source::Test(test) = source else { return Vec::new() };
        let needs_domain = |plan: &&TestPlan| plan.settings.own_domain;
        let Some(written) = self.test(test).filter(needs_domain).map(|plan| plan.env.clone())
        else {
            return Vec::new();
        };
        let Some(domain) = self.free_domains.pop() else { return Vec::new() };
        self.used_domains.insert(host, domain.clone());
        let is_free = |name: &str| written.iter().all(|(known, _)| known != name);
        domain.into_iter().filter(|(name, _)| is_free(name)).collect()
    }

    pub(super) fn test(&self, test: TestId) -> Option<&TestPlan> {
        let first = self.plan.tests.first()?.id.index();
        self.plan.tests.get(test.index() - first)
    }

    /// How the guard stops a fixture's process.
    fn fixture_stop(
        &self,
        source: Source,
        process: Option<&ProcessPlan>,
        launch: &Launch,
    ) -> Option<FixtureStop> {
        let Source::Fixture(id) = source else { return None };
        let plan = self.plan.fixtures.iter().find(|plan| plan.id == id)?;
        let scope = launch.scope.clone();
        let (signal, tree_signal, grace) = match process {
            Some(process) if process.remote.is_some() => (None, None, process.stop_grace),
            Some(process) => {
                (Some(process.stop_signal), Some(process.stop_signal), process.stop_grace)
            }
            None => (None, Some(SIGTERM), plan.limits.teardown),
        };
        Some(FixtureStop { scope, signal, tree_signal, grace })
    }

    /// Joining a control group may take longer than a short test: only long-lived processes, and
    /// tests whose leaks are failures, get one.
    fn is_grouped(&self, source: Source) -> bool {
        match source {
            Source::Test(test) => {
                self.test(test).is_some_and(|plan| plan.settings.leaks == Leaks::Fail)
            }
            Source::Fixture(_) | Source::Hook(_) => true,
        }
    }

    /// Only fixtures on this machine and shared hosts may grow while tests are repeated.
    fn is_measured(&self, source: Source, process: Option<&ProcessPlan>) -> bool {
        let outlives_test = match source {
            Source::Fixture(_) => process.is_none_or(|process| process.remote.is_none()),
            Source::Test(test) => self.test(test).is_some_and(|plan| plan.settings.shared),
            Source::Hook(_) => false,
        };
        self.is_repeated && outlives_test
    }

    pub(super) fn spawn_ahead(&mut self, starts: Vec<StartRequest>) {
        if self.context.debug.is_some() {
            return;
        }
        let mut before = std::mem::take(&mut self.prelaunched);
        for start in starts {
            let request = self.request(start, ProcessRole::Test);
            let launch = match before.iter().position(|launch| launch.request == request) {
                Some(index) => before.remove(index),
                None => {
                    let mut launch = self.launch(request);
                    launch.start_ahead(self.spawner());
                    launch
                }
            };
            self.prelaunched.push(launch);
        }
        for unneeded in before {
            tokio::spawn(unneeded.discard());
        }
    }

    /// Converts the start of a process. Only hosts of tests may be forked.
    fn request(&self, start: StartRequest, role: ProcessRole) -> SpawnRequest {
        let mut can_fork = false;
        let run_dir = self.context.tasks.run_dir.to_string_lossy().into_owned();
        let mut env = vec![
            (ENVIRONMENT_VARIABLE.to_owned(), self.plan.settings.environment.clone()),
            (RUN_DIR_VARIABLE.to_owned(), run_dir),
        ];
        env.extend(unbuffered::variable());
        env.extend(start.env);
        if !matches!(&start.what, Program::Process(plan) if plan.remote.is_some()) {
            env.extend(self.clock.variables(role));
        }
        let (command, channel) = match start.what {
            Program::Host(plan) => {
                // Last: it contains the suite's variables.
                env.extend_from_slice(&plan.env);
                can_fork = plan.forks && role == ProcessRole::Test;
                (plan.command.clone(), Some(Vec::new()))
            }
            Program::Process(plan) => match &plan.remote {
                None => (plan.command.clone(), None),
                Some(remote) => {
                    let remote = RemoteCommand {
                        host: &remote.host,
                        ssh: &remote.ssh,
                        command: &plan.command,
                        stop_signal: plan.stop_signal,
                        stop_grace: plan.stop_grace,
                    };
                    (ssh::command(remote, &env), Some(Vec::new()))
                }
            },
            Program::Attached(_) => (Vec::new(), None),
            Program::Command(command) => (start_gate::behind(&command), Some(Vec::new())),
        };
        SpawnRequest {
            command,
            env,
            working_dir: Some(start.folder),
            channel,
            streams: match self.debug_mode(role) {
                Some(DebugMode::Terminal) => Streams::Terminal,
                _ => Streams::Both,
            },
            can_fork,
            namespaces: self.network.as_ref().map(|network| network.namespaces().clone()),
            role: Some(role),
        }
    }

    /// How a process is debugged, if it is that of the test.
    fn debug_mode(&self, role: ProcessRole) -> Option<DebugMode> {
        let debug = self.context.debug.filter(|_| role == ProcessRole::Test);
        debug.map(|debug| debug.mode)
    }

    fn launch(&mut self, request: SpawnRequest) -> Launch {
        self.scopes += 1;
        let scope = format!("{}.{}.{}", self.events.run_token(), self.plan.id, self.scopes);
        Launch::new(request, scope, &self.context.scratch_dir)
    }

    fn spawner(&self) -> &Spawner {
        &self.context.tasks.spawner
    }
}

fn role_of(source: Source) -> ProcessRole {
    match source {
        Source::Test(_) => ProcessRole::Test,
        Source::Fixture(_) => ProcessRole::Fixture,
        Source::Hook(_) => ProcessRole::Hook,
    }
}
