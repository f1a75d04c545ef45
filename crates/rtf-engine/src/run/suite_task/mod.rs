//! The task around a suite's state machine: feeds it with inputs, and carries out its effects.

mod processes;

use std::collections::{HashMap, HashSet};
use std::time::Duration;

use rtf_model::{EventKind, ExitStatus, Source};
use tokio::sync::{mpsc, watch};
use tokio::time::Instant;

use super::clock::SuiteClock;
use super::context::{RunContext, attachments_dir};
use super::control_queue::ControlQueue;
use super::deadlines::Deadlines;
use super::fail_limit::FailLimit;
use super::machine::{Effect, HostId, Input, ProcessEvent, Stop, SuiteMachine};
use crate::control::Controls;
use crate::events::Events;
use crate::guard::HookStart;
use crate::isolate::PreparedSuite;
use rtf_plan::plan::SuitePlan;
use rtf_process::launch::Launch;
use rtf_process::network::Network;
use rtf_process::task::{Assignment, EventSender, ProcessCommand};

/// The capacity of the event queue; the tasks of processes wait if it is full.
const QUEUE_CAPACITY: usize = 1024;
/// The status of a process whose exit status is unknown.
const UNKNOWN_STATUS: ExitStatus = ExitStatus::Code(-1);
/// How many events are handled before deadlines and requests are checked again.
const BATCH: usize = 16;

/// The requests that may end or shorten a suite.
#[derive(Clone, Debug)]
pub struct SuiteRequests {
    pub stops: watch::Receiver<Option<Stop>>,
    pub controls: Controls,
    pub fails: FailLimit,
    /// Until when the suite is repeated, as a time of the run.
    pub soak_until: Option<Duration>,
}

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
        machine: SuiteMachine::new(plan, requests.fails.clone())
            .until(requests.soak_until)
            .unattended(context.unattended.clone()),
        effects: Vec::new(),
        commands: HashMap::new(),
        changing_ids: HashSet::new(),
        substitutes: Vec::new(),
        prelaunched: Vec::new(),
        triggered: None,
        free_domains: prepared.test_domains(),
        used_domains: HashMap::new(),
        scopes: 0,
        is_repeated: requests.soak_until.is_some() || plan.repeats(),
        deadlines: Deadlines::default(),
        clock: SuiteClock::new(plan, &context.scratch_dir),
        is_done: false,
    };
    task.run(queue, requests).await;
    for launch in task.prelaunched {
        launch.discard().await;
    }
}

/// The source of a process, and the queue of commands of its task.
type ProcessHandle = (Source, mpsc::UnboundedSender<ProcessCommand>);

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
    substitutes: Vec<(HostId, ProcessEvent)>,
    /// Hosts that were started ahead of time.
    prelaunched: Vec<Launch>,
    /// The start of the next hook, whose scope is not known yet.
    triggered: Option<HookStart>,
    /// The variables of domains for single tests that no test uses.
    free_domains: Vec<Vec<(String, String)>>,
    /// Those that processes of tests use.
    used_domains: HashMap<HostId, Vec<(String, String)>>,
    /// Whether tests are repeated: then the resource usage of fixtures and shared hosts is
    /// measured.
    is_repeated: bool,
    /// The number of assigned scopes.
    scopes: u64,
    deadlines: Deadlines,
    clock: SuiteClock,
    is_done: bool,
}

impl SuiteTask<'_> {
    async fn run(
        &mut self,
        mut queue: mpsc::Receiver<(HostId, ProcessEvent)>,
        SuiteRequests { mut stops, controls, .. }: SuiteRequests,
    ) {
        let stop = stops.borrow_and_update().clone();
        let (mut controls, earlier) = ControlQueue::new(controls, self.plan);
        for input in stop.map(Input::Stop).into_iter().chain(earlier) {
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
    fn handle_batch(&mut self, queue: &mut mpsc::Receiver<(HostId, ProcessEvent)>) {
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

    fn host_input(&mut self, host: HostId, input: ProcessEvent) {
        use ProcessEvent::{Exited, NotStarted, Released, Resumed, SpawnFailed, Throttled};
        let now = self.events.now();
        match &input {
            Exited(..) | SpawnFailed(_) | NotStarted(_) => {
                self.commands.remove(&host);
                self.deadlines.forget(host, now, self.plan);
                self.free_domains.extend(self.used_domains.remove(&host));
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
            Effect::KeepValues(values) => self.context.guard.fixture_values(self.plan, *values),
            Effect::Emit(kind) => {
                self.notify_guard(&kind);
                self.events.emit(kind);
            }
            Effect::SetDeadline(deadline, at) => self.deadlines.set(deadline, at),
            Effect::ClearDeadline(deadline) => self.deadlines.clear(deadline),
            Effect::PauseLimits(test) => self.deadlines.pause_limits(test, self.events.now()),
            Effect::ResumeLimits(test) => self.deadlines.resume_limits(test, self.events.now()),
            Effect::Spawn { host, source, start } => self.spawn(host, source, start),
            Effect::Join { host, on, source, request, plugin } => {
                let leak_owner = format!("test {}/{}", self.plan.name, plugin.name);
                let owner = self.context.process_owner(source, None);
                let attachments_dir = attachments_dir(source, host);
                let assignment = Assignment {
                    host,
                    owner,
                    attachments_dir,
                    leak_owner,
                    request,
                    plugin: *plugin,
                };
                let commands = self.commands.get(&on).map(|(_, commands)| commands.clone());
                match commands.filter(|commands| !commands.is_closed()) {
                    Some(commands) => {
                        let _ = commands.send(ProcessCommand::Assign(assignment));
                        self.commands.insert(host, (source, commands));
                    }
                    None => self.substitutes.push((host, ProcessEvent::NotStarted(UNKNOWN_STATUS))),
                }
                self.retire_id(on);
            }
            Effect::SpawnAhead(starts) => self.spawn_ahead(starts),
            Effect::Send(host, id, request) => {
                self.command(host, ProcessCommand::Send(id, *request))
            }
            Effect::CloseChannel(host) => self.command(host, ProcessCommand::CloseChannel),
            Effect::DumpStack(host, support, wait) => {
                self.command(host, ProcessCommand::DumpStack(support, wait))
            }
            Effect::Signal(host, signal, reach) => {
                self.command(host, ProcessCommand::Signal(signal, reach))
            }
            Effect::KillTree(host) => self.kill(host),
            Effect::WatchAlive(host) => self.command(host, ProcessCommand::WatchAlive),
            Effect::CheckAlive(host, probes) => {
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
            self.substitutes.push((host, ProcessEvent::Exited(UNKNOWN_STATUS, Vec::new())));
        }
    }
}
