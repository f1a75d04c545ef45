//! A world for the machine: plans, hosts that do what a test says, and time.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::{Notification, Reply, Request};
use rtf_model::{
    Event, EventKind, ExitStatus, FixtureId, FixturePlanned, HookId, HookPlanned, Message,
    MessageKind, Micros, OrderChecker, Phase, Record, RunStarted, Source, SuiteId, SuitePlanned,
    TestId, TestPlanned, Trigger,
};

use crate::plan::*;
use crate::run::FailLimit;
use crate::run::machine::{
    Deadline, Effect, HostId, HostInput, Input, Stop, StopLevel, SuiteMachine,
};

pub const SECOND: Duration = Duration::from_secs(1);

pub fn suite(fixtures: usize, tests: usize) -> SuitePlan {
    SuitePlan {
        id: SuiteId(0),
        name: "arm".to_owned(),
        file: "arm.xml".to_owned(),
        folder: PathBuf::from("."),
        description: String::new(),
        environment: String::new(),
        env: Arc::default(),
        timeout: None,
        isolate: Isolation::default(),
        given: Given::Nothing,
        requires: Vec::new(),
        tolerates_collapse: false,
        critical_stops_run: false,
        parallel: 1,
        fixtures: (0..fixtures).map(fixture).collect(),
        hooks: Vec::new(),
        tests: (0..tests).map(test).collect(),
    }
}

fn plugin() -> PluginPlan {
    PluginPlan {
        plugin_type: "dll".into(),
        file: PathBuf::from("plugin.so"),
        param: String::new(),
        args: Vec::new(),
        host: Arc::new(HostPlan {
            command: vec!["host".to_owned()],
            env: Vec::new(),
            forks: false,
        }),
    }
}

fn fixture(index: usize) -> FixturePlan {
    FixturePlan {
        id: FixtureId(u32::try_from(index).unwrap()),
        name: format!("fixture{index}"),
        depends: index.checked_sub(1).into_iter().collect(),
        body: FixtureBody::Plugin(plugin()),
        env: Vec::new(),
        limits: FixtureLimits {
            setup: 10 * SECOND,
            check: SECOND,
            notice: 2 * SECOND,
            teardown: 3 * SECOND,
        },
        restarts: 1,
        restart_delay: Duration::ZERO,
        check_every: None,
    }
}

/// A hook that is a command.
pub fn hook(index: usize, on: &[Trigger]) -> HookPlan {
    HookPlan {
        id: HookId(u32::try_from(index).unwrap()),
        name: format!("hook{index}"),
        on: on.to_vec(),
        body: HookBody::Command(vec!["park".to_owned()]),
        env: Vec::new(),
        timeout: 4 * SECOND,
    }
}

fn test(index: usize) -> TestPlan {
    let limits = TestLimits {
        load: 10 * SECOND,
        setup: 10 * SECOND,
        run: 5 * SECOND,
        teardown: 3 * SECOND,
        slow: 2 * SECOND,
        grace: SECOND,
    };
    TestPlan {
        id: TestId(u32::try_from(index).unwrap()),
        name: format!("test{index}"),
        plugin: plugin(),
        env: Vec::new(),
        repetitions: 1,
        limits: Arc::new(limits),
        after_collapse: AfterCollapse::Fail,
        leaks: Leaks::Report,
        retries: Retries::default(),
        critical: false,
        exclusive: false,
        shared: false,
        tags: Vec::new(),
    }
}

/// The machine, what it asked for, and what it reported.
pub struct World<'p> {
    pub now: Duration,
    pub machine: SuiteMachine<'p>,
    pub record: Record,
    pub hosts: BTreeMap<HostId, Source>,
    pub sent: Vec<(HostId, Option<u64>, Request)>,
    pub log: Vec<String>,
    pub happened: Vec<EventKind>,
    pub deadlines: BTreeMap<Deadline, Duration>,
    pub done: bool,
    /// Shared hosts that have nothing to do, and what others were asked for next.
    pub idle: BTreeSet<HostId>,
    /// Shared hosts that have answered, and stay.
    pub answered: BTreeSet<HostId>,
    pub joined: BTreeMap<HostId, (HostId, Source, u64)>,
    /// Whether it cannot be seen that fixtures live.
    pub unseen: bool,
    order: OrderChecker,
    seq: u64,
}

impl<'p> World<'p> {
    pub fn new(plan: &'p SuitePlan) -> Self {
        Self::of(plan, false)
    }

    /// Of tests that are repeated until a time is over.
    pub fn timed(plan: &'p SuitePlan) -> Self {
        Self::of(plan, true)
    }

    fn of(plan: &'p SuitePlan, timed: bool) -> Self {
        let mut world = Self {
            now: Duration::ZERO,
            machine: SuiteMachine::new(plan, FailLimit::default()),
            record: Record::default(),
            hosts: BTreeMap::new(),
            sent: Vec::new(),
            log: Vec::new(),
            happened: Vec::new(),
            deadlines: BTreeMap::new(),
            done: false,
            idle: BTreeSet::new(),
            answered: BTreeSet::new(),
            joined: BTreeMap::new(),
            unseen: false,
            order: OrderChecker::default(),
            seq: 0,
        };
        world.announce(plan, timed);
        world
    }

    fn announce(&mut self, plan: &SuitePlan, timed: bool) {
        self.emit(EventKind::RunStarted(RunStarted {
            version: 1,
            run: "r".to_owned(),
            rtf: "0".to_owned(),
            started_at: String::new(),
            command: Vec::new(),
            folder: String::new(),
            suites: 1,
            tests: u32::try_from(plan.tests.len()).unwrap(),
            manifest: Box::default(),
        }));
        self.emit(EventKind::SuitePlanned(SuitePlanned {
            suite: plan.id,
            name: plan.name.clone(),
            file: plan.file.clone(),
            description: String::new(),
            environment: String::new(),
            tolerates_collapse: false,
            parallel: plan.parallel,
        }));
        for fixture in &plan.fixtures {
            let (fixture, suite, name) = (fixture.id, plan.id, fixture.name.clone());
            let plugin_type = "dll".to_owned();
            self.emit(EventKind::FixturePlanned(FixturePlanned {
                fixture,
                suite,
                name,
                plugin_type,
            }));
        }
        for hook in &plan.hooks {
            let (hook, suite, name, on) = (hook.id, plan.id, hook.name.clone(), hook.on.clone());
            self.emit(EventKind::HookPlanned(HookPlanned { hook, suite, name, on }));
        }
        for test in &plan.tests {
            self.emit(EventKind::TestPlanned(TestPlanned {
                test: test.id,
                suite: plan.id,
                name: test.name.clone(),
                plugin_type: "dll".to_owned(),
                plugin: String::new(),
                repetitions: test.repetitions,
                timed,
                tags: Vec::new(),
            }));
        }
    }

    fn emit(&mut self, kind: EventKind) {
        let event = Event { seq: self.seq, at: Micros::from(self.now), kind };
        self.seq += 1;
        self.order
            .check(&event)
            .unwrap_or_else(|error| panic!("{error}\n{event:?}\n{:#?}", self.log));
        self.record.apply(&event);
        self.happened.push(event.kind.clone());
        let json = serde_json::to_value(&event.kind).unwrap();
        self.log.push(format!("{:>5.1}  {}", self.now.as_secs_f64(), line_of(&json)));
    }

    pub fn feed(&mut self, input: Input) {
        let mut effects = Vec::new();
        self.machine.handle(input, self.now, &mut effects);
        let mut looked_at = Vec::new();
        for effect in effects {
            match effect {
                Effect::LookAlive(host) => looked_at.push(host),
                Effect::Emit(kind) => self.emit(kind),
                Effect::Spawn { host, source, .. } => drop(self.hosts.insert(host, source)),
                Effect::Join { host, on, source, request, .. } => {
                    assert!(self.hosts.contains_key(&on) || self.idle.contains(&on));
                    assert!(self.joined.insert(on, (host, source, request)).is_none());
                }
                Effect::Send(host, id, request) => self.sent.push((host, id, request)),
                Effect::SetDeadline(deadline, at) => drop(self.deadlines.insert(deadline, at)),
                Effect::ClearDeadline(deadline) => drop(self.deadlines.remove(&deadline)),
                Effect::Done => self.done = true,
                Effect::SpawnAhead(_) => {}
                other => self.log.push(format!(
                    "{:>5.1}    {}",
                    self.now.as_secs_f64(),
                    effect_of(&other)
                )),
            }
        }
        looked_at.retain(|host| !self.unseen && self.hosts.contains_key(host));
        looked_at.into_iter().for_each(|host| self.feed(Input::Host(host, HostInput::Lives)));
    }

    pub fn start(&mut self) {
        self.feed(Input::Start);
    }

    pub fn stop(&mut self, level: StopLevel) {
        let (reason, limit) = ("SIGINT".to_owned(), 20 * SECOND);
        self.feed(Input::Stop(Stop { level, reason, limit }));
    }

    /// The host of a source that is alive.
    pub fn host_of(&self, source: Source) -> HostId {
        let host = self.hosts.iter().find(|(_, of)| **of == source);
        *host.unwrap_or_else(|| panic!("no host of {source:?}\n{:#?}", self.log)).0
    }

    pub fn input(&mut self, source: Source, input: HostInput) {
        let host = self.host_of(source);
        if matches!(input, HostInput::Exited(..) | HostInput::SpawnFailed(_)) {
            self.hosts.remove(&host);
            self.joined.remove(&host);
            self.answered.remove(&host);
        }
        self.feed(Input::Host(host, input));
    }

    pub fn exit(&mut self, source: Source, status: ExitStatus) {
        self.input(source, HostInput::Exited(status, Vec::new()));
    }

    /// Answers the request that was sent last to a host and waits for an answer.
    pub fn answer(&mut self, source: Source, outcome: &str) {
        let host = self.host_of(source);
        let asked = self.sent.iter().rev().find(|(to, id, _)| *to == host && id.is_some());
        let id = asked.and_then(|(_, id, _)| *id).expect("a request");
        let value = serde_json::json!({ "outcome": outcome, "reason": format!("says {outcome}") });
        self.input(source, HostInput::Answered(id, Reply::Result(value)));
    }

    /// A fixture is set up, and wants to be told of each test.
    pub fn set_up_to_hear(&mut self, fixture: u32) {
        let source = Source::Fixture(FixtureId(fixture));
        let notices = ["test-started", "test-finished"];
        let value = serde_json::json!({ "outcome": "passed", "notices": notices });
        self.input(source, HostInput::Answered(2, Reply::Result(value)));
    }

    pub fn phase(&mut self, source: Source, phase: Phase) {
        self.input(source, HostInput::Told(Notification::Phase { phase }));
    }

    pub fn failure(&mut self, source: Source, text: &str, critical: bool) {
        let kind = MessageKind::Failure;
        let message =
            Message { kind, text: text.to_owned(), location: None, comparison: None, critical };
        self.input(source, HostInput::Told(Notification::Message(message)));
    }

    /// A test that goes through all its phases and ends well.
    pub fn pass(&mut self, test: u32) {
        let source = Source::Test(TestId(test));
        for phase in [Phase::Setup, Phase::Run, Phase::TearDown] {
            self.phase(source, phase);
        }
        self.answer(source, "passed");
        self.exit(source, ExitStatus::Code(0));
    }

    /// A fixture that is torn down and ends well.
    pub fn tear_down(&mut self, fixture: u32) {
        let source = Source::Fixture(FixtureId(fixture));
        self.answer(source, "passed");
        self.exit(source, ExitStatus::Code(0));
    }

    /// Lets time pass up to the next deadline, which then passes.
    pub fn next_deadline(&mut self) -> Deadline {
        let next = self.deadlines.iter().min_by_key(|(_, at)| **at);
        let (deadline, at) = next.map(|(deadline, at)| (*deadline, *at)).expect("a deadline");
        self.now = self.now.max(at);
        self.deadlines.remove(&deadline);
        self.feed(Input::Deadline(deadline));
        deadline
    }

    pub fn finish(&mut self) {
        assert!(self.done, "the suite is not over\n{:#?}", self.log);
        assert!(self.deadlines.is_empty(), "deadlines are left: {:?}", self.deadlines);
        self.emit(EventKind::RunFinished { interrupted: None });
    }

    /// What happened after the plan.
    pub fn story(&self) -> String {
        let story =
            self.log.iter().filter(|line| !line.contains("-planned") && !line.contains("run-"));
        story.cloned().collect::<Vec<_>>().join("\n")
    }
}

fn line_of(json: &serde_json::Value) -> String {
    let mut line = json["type"].as_str().unwrap_or_default().to_owned();
    // Their order in the map depends on features that others ask of serde_json.
    let fields: BTreeMap<_, _> = json.as_object().unwrap().iter().collect();
    for (key, value) in fields {
        if !["type", "suite", "log_tail", "message"].contains(&key.as_str()) {
            let text = text_of(value);
            line += &format!(" {key}={text}");
        }
    }
    line
}

fn text_of(value: &serde_json::Value) -> String {
    sorted(value).to_string().replace('"', "")
}

fn sorted(value: &serde_json::Value) -> serde_json::Value {
    let Some(object) = value.as_object() else { return value.clone() };
    let fields: BTreeMap<_, _> = object.iter().map(|(key, value)| (key, sorted(value))).collect();
    fields.into_iter().map(|(key, value)| (key.clone(), value)).collect()
}

fn effect_of(effect: &Effect) -> String {
    match effect {
        Effect::CloseChannel(_) => "→ close the channel".to_owned(),
        Effect::TakeStack(..) => "→ take a stack dump".to_owned(),
        Effect::Signal(_, signal) => format!("→ signal {signal}"),
        Effect::KillTree(_) => "→ kill the tree".to_owned(),
        other => format!("→ {other:?}"),
    }
}
