//! The task around a suite's state machine: it carries out the effects and
//! brings the inputs.

use std::collections::{HashMap, HashSet};
use std::time::Duration;

use rtf_model::protocol::{ENVIRONMENT_VARIABLE, RUN_DIR_VARIABLE};
use rtf_model::{EventKind, ExitStatus, Source, TestId};
use tokio::sync::{mpsc, watch};
use tokio::time::Instant;

use super::clock::Clock;
use super::context::{RunContext, attachments_dir};
use super::control::{Controls, Unseen};
use super::deadlines::Deadlines;
use super::events::Events;
use super::fail_limit::FailLimit;
use super::machine::{Effect, HostId, HostInput, Input, Program, Start, Stop, SuiteMachine};
use super::probes;
use crate::guard::HookBegins;
use crate::isolate::Prepared;
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

/// How many inputs may wait; then processes wait.
const INPUTS: usize = 1024;
/// The exit status of a process whose own is unknown.
const UNKNOWN: ExitStatus = ExitStatus::Code(-1);
/// How many more are taken before anything else is looked at.
const AT_ONCE: usize = 16;

/// What may come from outside while a suite runs.
#[derive(Clone, Debug)]
pub struct Asked {
    /// The request to end the run.
    pub stops: watch::Receiver<Option<Stop>>,
    /// Everything else.
    pub controls: Controls,
    /// How many tests of the run have failed, and may.
    pub fails: FailLimit,
    /// When the suite is repeated no more, as a time of the run.
    pub until: Option<Duration>,
}

/// Runs a suite to its end.
pub async fn run_suite(
    prepared: &Prepared<'_>,
    context: &RunContext,
    events: &Events,
    asked: Asked,
) {
    let (inputs, queue) = mpsc::channel(INPUTS);
    let plan = &*prepared.plan;
    let mut task = SuiteTask {
        plan,
        network: prepared.network(),
        context,
        events,
        inputs,
        machine: SuiteMachine::new(plan, asked.fails.clone()).until(asked.until),
        effects: Vec::new(),
        commands: HashMap::new(),
        leaving: HashSet::new(),
        unanswered: Vec::new(),
        spares: Vec::new(),
        called: None,
        scopes: 0,
        repeats: asked.until.is_some() || plan.repeats(),
        deadlines: Deadlines::default(),
        clock: Clock::of(plan, &context.scratch_dir),
        over: false,
    };
    task.run(queue, asked).await;
    for spare in task.spares {
        spare.discard().await;
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
    /// Those that will be known by another id.
    leaving: HashSet<HostId>,
    /// Inputs for orders whose process has no task any more.
    unanswered: Vec<(HostId, HostInput)>,
    /// Hosts that were started ahead of their need.
    spares: Vec<Launch>,
    /// What called for the hook that is started next.
    called: Option<HookBegins>,
    /// Whether tests are repeated: then what fixtures and shared hosts use is measured.
    repeats: bool,
    /// How many scopes were given out.
    scopes: u64,
    deadlines: Deadlines,
    clock: Clock,
    over: bool,
}

impl SuiteTask<'_> {
    async fn run(
        &mut self,
        mut queue: mpsc::Receiver<(HostId, HostInput)>,
        Asked { mut stops, controls, .. }: Asked,
    ) {
        let stop = stops.borrow_and_update().clone();
        let (mut controls, skip) = Unseen::at_start(controls, self.plan);
        for input in stop.map(Input::Stop).into_iter().chain(skip) {
            self.feed(input);
        }
        self.feed(Input::Start);
        while !self.over {
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
                () = self.sleep_until(next) => self.time_passed(),
                Some((host, input)) = queue.recv() => {
                    self.host_input(host, input);
                    self.take_more(&mut queue);
                }
            }
        }
    }

    /// Takes what came with the last input: mostly several come at once.
    fn take_more(&mut self, queue: &mut mpsc::Receiver<(HostId, HostInput)>) {
        for _ in 0..AT_ONCE {
            match queue.try_recv() {
                Ok((host, input)) if !self.over => self.host_input(host, input),
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

    /// When something has to be done for the sake of time.
    fn next_due(&mut self) -> Option<Duration> {
        let look = self.clock.next_look(self.machine.follows_clock(), self.events.now());
        self.deadlines.next(self.plan).into_iter().chain(look).min()
    }

    fn time_passed(&mut self) {
        let now = self.events.now();
        if let Some(time) = self.clock.look(now) {
            self.feed(Input::Clock(time));
        }
        for deadline in self.deadlines.passed(now, self.plan) {
            // An earlier one of these may have moved or cleared it.
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
            Released => self.leave(host),
            _ => {}
        }
        self.feed(Input::Host(host, input));
    }

    /// A host has another id when both was told: the test is over, and it has or
    /// gets another test.
    fn leave(&mut self, host: HostId) {
        if !self.leaving.insert(host) {
            self.leaving.remove(&host);
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
        while let Some((host, input)) = self.unanswered.pop() {
            self.host_input(host, input);
        }
    }

    fn carry_out(&mut self, effect: Effect) {
        match effect {
            Effect::Emit(kind) => {
                self.tell_guard(&kind);
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
                    None => self.unanswered.push((host, HostInput::Unbegun(UNKNOWN))),
                }
                self.leave(on);
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
            Effect::Done => self.over = true,
        }
    }

    /// What the guard must know of tests and hooks, should the runner die.
    fn tell_guard(&mut self, kind: &EventKind) {
        let guard = &self.context.guard;
        match kind {
            EventKind::TestStarted { test, .. } => {
                let name = self.test(*test).map_or("", |plan| &plan.name);
                guard.test_begins(self.plan, *test, name);
            }
            EventKind::TestFinished(finished) => guard.test_ends(self.plan, finished.test),
            EventKind::HookFinished { hook, problem } => guard.hook_ends(*hook, problem.clone()),
            EventKind::HookStarted { hook, trigger, reason, test } => {
                let (reason, scope) = (reason.clone(), String::new());
                let (hook, trigger, test) = (*hook, *trigger, *test);
                self.called = Some(HookBegins { hook, scope, trigger, reason, test });
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

    /// Kills a process; one without a task has ended.
    fn kill(&mut self, host: HostId) {
        let commands = self.commands.get(&host);
        if commands.is_none_or(|(_, commands)| commands.send(ProcessCommand::KillTree).is_err()) {
            self.unanswered.push((host, HostInput::Exited(UNKNOWN, Vec::new())));
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
        let launch = match self.spares.iter().position(|spare| spare.request == request) {
            Some(place) => self.spares.remove(place),
            None => self.launch(request),
        };
        if let Some(plan) = attached {
            let probes = probes::convert(&plan.ready, &plan.alive, self.network.clone());
            let (job, spawner) = (AttachedJob { host, probes, launch }, self.spawner().clone());
            let watch = watch_attached(job, spawner, queue, self.inputs.clone());
            return drop(tokio::spawn(watch));
        }
        if let Some(called) = self.called.take_if(|_| matches!(source, Source::Hook(_))) {
            self.context.guard.hook_begins(HookBegins { scope: launch.scope.clone(), ..called });
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

    /// Joining a control group may take longer than a short test: it is for those
    /// that live long, and where each leak counts.
    fn is_grouped(&self, source: Source) -> bool {
        match source {
            Source::Test(test) => self.test(test).is_some_and(|plan| plan.leaks == Leaks::Fail),
            Source::Fixture(_) | Source::Hook(_) => true,
        }
    }

    /// What may grow while tests are repeated: fixtures on this machine, and the
    /// hosts that tests share.
    fn is_measured(&self, source: Source, process: Option<&ProcessPlan>) -> bool {
        let lives_on = match source {
            Source::Fixture(_) => process.is_none_or(|process| process.remote.is_none()),
            Source::Test(test) => self.test(test).is_some_and(|plan| plan.shared),
            Source::Hook(_) => false,
        };
        self.repeats && lives_on
    }

    fn spawn_ahead(&mut self, starts: Vec<Start>) {
        let mut before = std::mem::take(&mut self.spares);
        for start in starts {
            let request = self.request(start, ProcessRole::Test);
            let spare = match before.iter().position(|spare| spare.request == request) {
                Some(place) => before.remove(place),
                None => {
                    let mut launch = self.launch(request);
                    launch.start_ahead(self.spawner());
                    launch
                }
            };
            self.spares.push(spare);
        }
        for unwanted in before {
            tokio::spawn(unwanted.discard());
        }
    }

    /// What is to be started; as a fork only if it may be one.
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
                // Last: the plan has put what the suite says into it already.
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
