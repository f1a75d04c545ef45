//! The task around a suite's state machine: it carries out the effects and
//! brings the inputs.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::ENVIRONMENT_VARIABLE;
use rtf_model::{EventKind, Source};
use tokio::sync::{mpsc, watch};
use tokio::time::Instant;

use super::events::Events;
use super::machine::{
    Deadline, Effect, HostId, HostInput, Input, Program, Start, Stop, SuiteMachine,
};
use crate::guard::{HookBegins, gate};
use crate::host::launch::Launch;
use crate::host::spawner::{SpawnRequest, Streams};
use crate::host::task::{self, Job, Order, Shared};
use crate::plan::SuitePlan;

/// How many inputs may wait; then processes wait.
const INPUTS: usize = 1024;

/// Runs a suite to its end.
pub async fn run_suite(
    plan: &SuitePlan,
    shared: &Arc<Shared>,
    events: &Events,
    stops: watch::Receiver<Option<Stop>>,
) {
    let (inputs, queue) = mpsc::channel(INPUTS);
    let mut task = SuiteTask {
        plan,
        shared,
        events,
        inputs,
        machine: SuiteMachine::new(plan),
        effects: Vec::new(),
        orders: HashMap::new(),
        spares: Vec::new(),
        called: None,
        scopes: 0,
        deadlines: BTreeMap::new(),
        over: false,
    };
    task.run(queue, stops).await;
    for spare in task.spares {
        spare.discard().await;
    }
}

struct SuiteTask<'a> {
    plan: &'a SuitePlan,
    shared: &'a Arc<Shared>,
    events: &'a Events,
    inputs: task::Inputs,
    machine: SuiteMachine<'a>,
    effects: Vec<Effect>,
    orders: HashMap<HostId, mpsc::UnboundedSender<Order>>,
    /// Hosts that were started ahead of their need.
    spares: Vec<Launch>,
    /// What called for the hook that is started next.
    called: Option<HookBegins>,
    /// How many scopes were given out.
    scopes: u64,
    deadlines: BTreeMap<Deadline, Duration>,
    over: bool,
}

impl SuiteTask<'_> {
    async fn run(
        &mut self,
        mut queue: mpsc::Receiver<(HostId, HostInput)>,
        mut stops: watch::Receiver<Option<Stop>>,
    ) {
        let stop = stops.borrow_and_update().clone();
        if let Some(stop) = stop {
            self.feed(Input::Stop(stop));
        }
        self.feed(Input::Start);
        while !self.over {
            let next = self.deadlines.values().min().copied();
            tokio::select! {
                biased;
                Ok(()) = stops.changed() => {
                    let stop = stops.borrow_and_update().clone();
                    if let Some(stop) = stop {
                        self.feed(Input::Stop(stop));
                    }
                }
                () = self.sleep_until(next) => self.deadlines_passed(),
                Some((host, input)) = queue.recv() => self.host_input(host, input),
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

    fn deadlines_passed(&mut self) {
        let now = self.events.now();
        let passed: Vec<Deadline> = self
            .deadlines
            .iter()
            .filter(|(_, at)| **at <= now)
            .map(|(deadline, _)| *deadline)
            .collect();
        for deadline in passed {
            // An earlier one of these may have moved or cleared it.
            if self.deadlines.get(&deadline).is_some_and(|at| *at <= now) {
                self.deadlines.remove(&deadline);
                self.feed(Input::Deadline(deadline));
            }
        }
    }

    fn host_input(&mut self, host: HostId, input: HostInput) {
        if matches!(input, HostInput::Exited(..) | HostInput::SpawnFailed(_)) {
            self.orders.remove(&host);
        }
        self.feed(Input::Host(host, input));
    }

    fn feed(&mut self, input: Input) {
        let mut effects = std::mem::take(&mut self.effects);
        self.machine.handle(input, self.events.now(), &mut effects);
        for effect in effects.drain(..) {
            self.carry_out(effect);
        }
        self.effects = effects;
    }

    fn carry_out(&mut self, effect: Effect) {
        match effect {
            Effect::Emit(kind) => {
                self.tell_guard(&kind);
                self.events.emit(kind);
            }
            Effect::SetDeadline(deadline, at) => drop(self.deadlines.insert(deadline, at)),
            Effect::ClearDeadline(deadline) => drop(self.deadlines.remove(&deadline)),
            Effect::Spawn { host, source, start } => self.spawn(host, source, start),
            Effect::SpawnAhead(starts) => self.spawn_ahead(starts),
            Effect::Send(host, id, request) => self.order(host, Order::Send(id, request)),
            Effect::CloseChannel(host) => self.order(host, Order::CloseChannel),
            Effect::TakeStack(host, support) => self.order(host, Order::TakeStack(support)),
            Effect::Signal(host, signal) => self.order(host, Order::Signal(signal)),
            Effect::KillTree(host) => self.order(host, Order::KillTree),
            Effect::WatchAlive(host) => self.order(host, Order::WatchAlive),
            Effect::Done => self.over = true,
        }
    }

    /// What the guard must know of tests and hooks, should the runner die.
    fn tell_guard(&mut self, kind: &EventKind) {
        let guard = &self.shared.guard;
        match kind {
            EventKind::TestStarted { test, .. } => {
                let first = self.plan.tests.first().map_or(0, |first| first.id.index());
                let plan = self.plan.tests.get(test.index() - first);
                guard.test_begins(*test, plan.map_or("", |plan| &plan.name));
            }
            EventKind::TestFinished(_) => guard.test_ends(),
            EventKind::HookFinished { hook, problem } => guard.hook_ends(*hook, problem.clone()),
            EventKind::HookStarted { hook, trigger, reason, test } => {
                let (reason, scope) = (reason.clone(), String::new());
                let (hook, trigger, test) = (*hook, *trigger, *test);
                self.called = Some(HookBegins { hook, scope, trigger, reason, test });
            }
            _ => {}
        }
    }

    fn order(&self, host: HostId, order: Order) {
        if let Some(orders) = self.orders.get(&host) {
            // A task that has ended has told so; its input is on the way.
            let _ = orders.send(order);
        }
    }

    fn spawn(&mut self, host: HostId, source: Source, start: Start) {
        let process = match &start.what {
            Program::Host(_) | Program::Command(_) => None,
            Program::Process(plan) => Some(plan.clone()),
        };
        let request = self.request(start);
        let (orders, queue) = mpsc::unbounded_channel();
        self.orders.insert(host, orders);
        let launch = match self.spares.iter().position(|spare| spare.request == request) {
            Some(place) => self.spares.remove(place),
            None => self.launch(request),
        };
        if let Some(called) = self.called.take_if(|_| matches!(source, Source::Hook(_))) {
            self.shared.guard.hook_begins(HookBegins { scope: launch.scope.clone(), ..called });
        }
        let job = Job { host, source, launch, process };
        tokio::spawn(task::run(job, self.shared.clone(), queue, self.inputs.clone()));
    }

    fn spawn_ahead(&mut self, starts: Vec<Start>) {
        let mut before = std::mem::take(&mut self.spares);
        for start in starts {
            let request = self.request(start);
            let spare = match before.iter().position(|spare| spare.request == request) {
                Some(place) => before.remove(place),
                None => {
                    let mut launch = self.launch(request);
                    launch.start_ahead(&self.shared.spawner);
                    launch
                }
            };
            self.spares.push(spare);
        }
        for unwanted in before {
            tokio::spawn(unwanted.discard());
        }
    }

    fn request(&self, start: Start) -> SpawnRequest {
        let mut env = vec![(ENVIRONMENT_VARIABLE.to_owned(), self.plan.environment.clone())];
        env.extend(start.env);
        let (command, channel) = match start.what {
            Program::Host(plan) => {
                // Last: the plan has put what the suite says into it already.
                env.extend_from_slice(&plan.env);
                (plan.command.clone(), Some(Vec::new()))
            }
            Program::Process(plan) => (plan.command.clone(), None),
            Program::Command(command) => (gate::behind(&command), Some(Vec::new())),
        };
        let folder = Some(start.folder);
        SpawnRequest { command, env, folder, channel, streams: Streams::Both }
    }

    fn launch(&mut self, request: SpawnRequest) -> Launch {
        self.scopes += 1;
        let scope = format!("{}.{}.{}", self.events.run_token(), self.plan.id, self.scopes);
        Launch::new(request, scope, &self.shared.scratch)
    }
}
