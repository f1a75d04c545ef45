//! The task around a suite's state machine: feeds it with inputs, and carries out its effects.

use std::collections::{HashMap, HashSet};
use std::time::Duration;

use rtf_model::protocol::{ENVIRONMENT_VARIABLE, RUN_DIR_VARIABLE};
use rtf_model::{EventKind, ExitStatus, Source, TestId};
use tokio::sync::{mpsc, watch};
use tokio::time::Instant;

use super::clock::Clock;
use super::context::{RunContext, attachments_dir};
use super::control_queue::ControlQueue;
use super::deadlines::Deadlines;
use super::fail_limit::FailLimit;
use super::machine::{Effect, HostId, HostInput, Input, Program, Start, Stop, SuiteMachine};
use super::probes;
use crate::control::Controls;
use crate::events::Events;
use crate::guard::HookStart;
use crate::isolate::PreparedSuite;
use rtf_plan::plan::{Leaks, ProcessPlan, SuitePlan, TestPlan};
use rtf_process::launch::Launch;
use rtf_process::network::Network;
use rtf_process::spawn_request::{ProcessRole, SpawnRequest, Streams};
use rtf_process::spawner::Spawner;
use rtf_process::ssh::{self, RemoteCommand};
use rtf_process::start_gate;
use rtf_process::task::{
    Assignment, AttachedJob, EventSender, ProcessCommand, ProcessJob, run_process, watch_attached,
};

/// The capacity of the event queue; the tasks of processes wait if it is full.
const QUEUE_CAPACITY: usize = 1024;
/// The status of a process whose exit status is unknown.
const UNKNOWN_STATUS: ExitStatus = ExitStatus::Code(-1);
/// How many events are handled before deadlines and requests are checked again.
const BATCH: usize = 16;

/// The requests that may end or shorten a suite.
#[derive(Clone, Debug)]
pub struct SuiteRequests {
    /// Requests to end the run.
    pub stops: watch::Receiver<Option<Stop>>,
    /// Requests that concern a test or a suite.
    pub controls: Controls,
    /// The limit of failed tests.
    pub fails: FailLimit,
    /// Until when the suite is repeated, as a time of the run.
    pub soak_until: Option<Duration>,
}

/// Runs a suite.
pub async fn run_suite(
    prepared: &PreparedSuite<'_>,
    context: &RunContext,
    events: &Events,
    requests: SuiteRequests,
) {
    let (inputs, queue) = mpsc::channel(QUEUE_CAPACITY);
    let plan = &*prepared.plan;
    let mut task = SuiteTask {
        plan,
        network: prepared.network(),
        context,
        events,
        inputs,
        machine: SuiteMachine::new(plan, requests.fails.clone()).until(requests.soak_until),
        effects: Vec::new(),
        commands: HashMap::new(),
        changing_ids: HashSet::new(),
        substitutes: Vec::new(),
        prelaunched: Vec::new(),
        triggered: None,
        scopes: 0,
        is_repeated: requests.soak_until.is_some() || plan.repeats(),
        deadlines: Deadlines::default(),
        clock: Clock::new(plan, &context.scratch_dir),
        is_done: false,
    };
    task.run(queue, requests).await;
    for launch in task.prelaunched {
        launch.discard().await;
    }
}

/// The source of a process, and the queue of commands of its task.
type ProcessHandle = (Source, mpsc::UnboundedSender<ProcessCommand>);

fn role_of(source: Source) -> ProcessRole {
    match source {
        Source::Test(_) => ProcessRole::Test,
        Source::Fixture(_) => ProcessRole::Fixture,
        Source::Hook(_) => ProcessRole::Hook,
    }
}

struct SuiteTask<'a> {
    plan: &'a SuitePlan,
    network: Option<Network>,
    context: &'a RunContext,
    events: &'a Events,
    inputs: EventSender,
    machine: SuiteMachine<'a>,
    effects: Vec<Effect>,
    commands: HashMap<HostId, ProcessHandle>,
    /// Shared hosts whose id changes once the test has ended and the next is assigned, if one of
    /// both has happened.
    changing_ids: HashSet<HostId>,
    /// Inputs that replace the events of ended tasks.
    substitutes: Vec<(HostId, HostInput)>,
    /// Hosts that were started ahead of time.
    prelaunched: Vec<Launch>,
    /// The start of the next hook, whose scope is not known yet.
    triggered: Option<HookStart>,
    /// Whether tests are repeated: then the resource usage of fixtures and shared hosts is
    /// measured.
    is_repeated: bool,
    /// The number of assigned scopes.
    scopes: u64,
    deadlines: Deadlines,
    clock: Clock,
    is_done: bool,
}

impl SuiteTask<'_> {
    async fn run(
        &mut self,
        mut queue: mpsc::Receiver<(HostId, HostInput)>,
        SuiteRequests { mut stops, controls, .. }: SuiteRequests,
    ) {
        let stop = stops.borrow_and_update().clone();
        let (mut controls, skip) = ControlQueue::new(controls, self.plan);
        for input in stop.map(Input::Stop).into_iter().chain(skip) {
            self.feed(input);
        }
        self.feed(Input::Start);
        while !self.is_done {
            let next = self.next_due();
            tokio::select! {
                biased;
                Ok(()) = stops.changed() => {
                    let stop = stops.borrow_and_update().clone();
                    if let Some(stop) = stop {
                        self.feed(Input::Stop(stop));
                    }
                }
                input = controls.next(self.plan) => self.feed(input),
                () = self.sleep_until(next) => self.handle_due(),
                Some((host, input)) = queue.recv() => {
                    self.host_input(host, input);
                    self.handle_batch(&mut queue);
                }
            }
        }
    }

    /// Handles the events that arrived with the last one: often there are several.
    fn handle_batch(&mut self, queue: &mut mpsc::Receiver<(HostId, HostInput)>) {
        for _ in 0..BATCH {
            match queue.try_recv() {
                Ok((host, input)) if !self.is_done => self.host_input(host, input),
                _ => return,
            }
        }
    }

    async fn sleep_until(&self, next: Option<Duration>) {
        match next {
            Some(next) => {
                tokio::time::sleep_until(Instant::from_std(self.events.start() + next)).await
            }
            None => std::future::pending().await,
        }
    }

    /// Returns the time of the next deadline or poll of the clock.
    fn next_due(&mut self) -> Option<Duration> {
        let poll = self.clock.next_poll(self.machine.follows_clock(), self.events.now());
        self.deadlines.next(self.plan).into_iter().chain(poll).min()
    }

    fn handle_due(&mut self) {
        let now = self.events.now();
        if let Some(time) = self.clock.poll(now) {
            self.feed(Input::Clock(time));
        }
        for deadline in self.deadlines.passed(now, self.plan) {
            // An earlier deadline may have moved or cleared it.
            if self.deadlines.take(deadline, now, self.plan) {
                self.feed(Input::Deadline(deadline));
            }
        }
    }

    fn host_input(&mut self, host: HostId, input: HostInput) {
        use HostInput::{Exited, Released, Resumed, SpawnFailed, Throttled, Unbegun};
        let now = self.events.now();
        match &input {
            Exited(..) | SpawnFailed(_) | Unbegun(_) => {
                self.commands.remove(&host);
                self.deadlines.forget(host, now, self.plan);
            }
            Throttled => {
                if let Some((source, _)) = self.commands.get(&host) {
                    self.deadlines.pause(host, *source, now);
                }
            }
            Resumed => self.deadlines.resume(host, now, self.plan),
            Released => self.retire_id(host),
            _ => {}
        }
        self.feed(Input::Host(host, input));
    }

    /// Removes the id of a shared host once its test has ended and the next is assigned, in either
    /// order.
    fn retire_id(&mut self, host: HostId) {
        if !self.changing_ids.insert(host) {
            self.changing_ids.remove(&host);
            self.commands.remove(&host);
        }
    }

    fn feed(&mut self, input: Input) {
        let mut effects = std::mem::take(&mut self.effects);
        self.machine.handle(input, self.events.now(), &mut effects);
        for effect in effects.drain(..) {
            self.carry_out(effect);
        }
        self.effects = effects;
        while let Some((host, input)) = self.substitutes.pop() {
            self.host_input(host, input);
        }
    }

    fn carry_out(&mut self, effect: Effect) {
        match effect {
            Effect::Emit(kind) => {
                self.notify_guard(&kind);
                self.events.emit(kind);
            }
            Effect::SetDeadline(deadline, at) => self.deadlines.set(deadline, at),
            Effect::ClearDeadline(deadline) => self.deadlines.clear(deadline),
            Effect::Spawn { host, source, start } => self.spawn(host, source, start),
            Effect::Join { host, on, source, request, plugin } => {
                let leak_owner = format!("test {}/{}", self.plan.name, plugin.name);
                let owner = self.context.process_owner(source);
                let attachments_dir = attachments_dir(source, host);
                let assignment =
                    Assignment { host, owner, attachments_dir, leak_owner, request, plugin };
                let commands = self.commands.get(&on).map(|(_, commands)| commands.clone());
                match commands.filter(|commands| !commands.is_closed()) {
                    Some(commands) => {
                        let _ = commands.send(ProcessCommand::Assign(assignment));
                        self.commands.insert(host, (source, commands));
                    }
                    None => self.substitutes.push((host, HostInput::Unbegun(UNKNOWN_STATUS))),
                }
                self.retire_id(on);
            }
            Effect::SpawnAhead(starts) => self.spawn_ahead(starts),
            Effect::Send(host, id, request) => {
                self.command(host, ProcessCommand::Send(id, request))
            }
            Effect::CloseChannel(host) => self.command(host, ProcessCommand::CloseChannel),
            Effect::TakeStack(host, support) => {
                self.command(host, ProcessCommand::TakeStack(support))
            }
            Effect::Signal(host, signal) => self.command(host, ProcessCommand::Signal(signal)),
            Effect::KillTree(host) => self.kill(host),
            Effect::WatchAlive(host) => self.command(host, ProcessCommand::WatchAlive),
            Effect::LookAlive(host, probes) => {
                self.command(host, ProcessCommand::CheckAlive(probes))
            }
            Effect::Done => self.is_done = true,
        }
    }

    /// Notifies the guard of tests and hooks.
    fn notify_guard(&mut self, kind: &EventKind) {
        let guard = &self.context.guard;
        match kind {
            EventKind::TestStarted { test, .. } => {
                let name = self.test(*test).map_or("", |plan| &plan.name);
                guard.test_started(self.plan, *test, name);
            }
            EventKind::TestFinished(finished) => guard.test_finished(self.plan, finished.test),
            EventKind::HookFinished { hook, problem } => {
                guard.hook_finished(*hook, problem.clone())
            }
            EventKind::HookStarted { hook, trigger, reason, test } => {
                let (reason, scope) = (reason.clone(), String::new());
                let (hook, trigger, test) = (*hook, *trigger, *test);
                self.triggered = Some(HookStart { hook, scope, trigger, reason, test });
            }
            _ => {}
        }
    }

    fn command(&mut self, host: HostId, command: ProcessCommand) {
        if command.stops() {
            self.deadlines.stop(host, self.events.now(), self.plan);
        }
        if let Some((_, commands)) = self.commands.get(&host) {
            // A task that has ended has reported it; the event is in the queue.
            let _ = commands.send(command);
        }
    }

    /// Kills a process. One without a task has ended.
    fn kill(&mut self, host: HostId) {
        let commands = self.commands.get(&host);
        if commands.is_none_or(|(_, commands)| commands.send(ProcessCommand::KillTree).is_err()) {
            self.substitutes.push((host, HostInput::Exited(UNKNOWN_STATUS, Vec::new())));
        }
    }

    fn spawn(&mut self, host: HostId, source: Source, start: Start) {
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
            let probes = probes::convert(&plan.ready, &plan.alive, self.network.clone());
            let (job, spawner) = (AttachedJob { host, probes, launch }, self.spawner().clone());
            let watch = watch_attached(job, spawner, queue, self.inputs.clone());
            return drop(tokio::spawn(watch));
        }
        if let Some(start) = self.triggered.take_if(|_| matches!(source, Source::Hook(_))) {
            self.context.guard.hook_starting(HookStart { scope: launch.scope.clone(), ..start });
        }
        let job = ProcessJob {
            host,
            owner: self.context.process_owner(source),
            launch,
            attachments_dir: attachments_dir(source, host),
            is_grouped: self.is_grouped(source),
            is_measured: self.is_measured(source, process.as_deref()),
            probes: process.map(|process| {
                probes::convert(&process.ready, &process.alive, self.network.clone())
            }),
        };
        let tasks = self.context.tasks.clone();
        tokio::spawn(run_process(job, tasks, queue, self.inputs.clone()));
    }

    fn test(&self, test: TestId) -> Option<&TestPlan> {
        let first = self.plan.tests.first()?.id.index();
        self.plan.tests.get(test.index() - first)
    }

    /// Joining a control group may take longer than a short test: only long-lived processes, and
    /// tests whose leaks are failures, get one.
    fn is_grouped(&self, source: Source) -> bool {
        match source {
            Source::Test(test) => self.test(test).is_some_and(|plan| plan.leaks == Leaks::Fail),
            Source::Fixture(_) | Source::Hook(_) => true,
        }
    }

    /// Only fixtures on this machine and shared hosts may grow while tests are repeated.
    fn is_measured(&self, source: Source, process: Option<&ProcessPlan>) -> bool {
        let outlives_test = match source {
            Source::Fixture(_) => process.is_none_or(|process| process.remote.is_none()),
            Source::Test(test) => self.test(test).is_some_and(|plan| plan.shared),
            Source::Hook(_) => false,
        };
        self.is_repeated && outlives_test
    }

    fn spawn_ahead(&mut self, starts: Vec<Start>) {
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
    fn request(&self, start: Start, role: ProcessRole) -> SpawnRequest {
        let mut can_fork = false;
        let run_dir = self.context.tasks.run_dir.to_string_lossy().into_owned();
        let mut env = vec![
            (ENVIRONMENT_VARIABLE.to_owned(), self.plan.environment.clone()),
            (RUN_DIR_VARIABLE.to_owned(), run_dir),
        ];
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
            streams: Streams::Both,
            can_fork,
            namespaces: self.network.as_ref().map(|network| network.namespaces().clone()),
            role: Some(role),
        }
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
