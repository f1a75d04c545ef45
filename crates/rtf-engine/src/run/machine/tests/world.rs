//! Simulates the world around the machine: plans, hosts that tests control, and time.

mod format;
mod host_actions;
mod plans;

use std::collections::{BTreeMap, BTreeSet};
use std::time::Duration;

use rtf_model::protocol::{Plugin, Reply, Request};
use rtf_model::{
    Event, EventKind, ExitStatus, FixturePlanned, HookPlanned, Micros, OrderChecker, Record,
    RunStarted, Source, SuitePlanned, TestId, TestPlanned,
};

use self::format::{effect_of, line_of};
pub use self::host_actions::{FIXTURE, HOOK, TEST};
pub use self::plans::{hook, suite};
use crate::run::FailLimit;
use crate::run::machine::{
    Deadline, Effect, HostId, Input, ProbeSelection, ProcessEvent, Stop, StopLevel, SuiteMachine,
    TestTimer,
};
use rtf_plan::plan::SuitePlan;

pub const SECOND: Duration = Duration::from_secs(1);

pub struct World<'p> {
    pub now: Duration,
    pub machine: SuiteMachine<'p>,
    pub record: Record,
    pub hosts: BTreeMap<HostId, Source>,
    pub sent: Vec<(HostId, Option<u64>, Request)>,
    pub log: Vec<String>,
    /// The first line of the transcript.
    transcript_start: usize,
    pub events: Vec<EventKind>,
    pub deadlines: BTreeMap<Deadline, Duration>,
    /// The tests whose limits are paused, and since when.
    asking: BTreeMap<TestId, Duration>,
    pub done: bool,
    /// Shared hosts without a test.
    pub idle: BTreeSet<HostId>,
    /// Shared hosts that have answered and stay alive.
    pub answered: BTreeSet<HostId>,
    /// The tests that shared hosts were assigned.
    pub assigned: BTreeMap<HostId, (HostId, Source, u64)>,
    /// What they were assigned, in order.
    pub joined: Vec<Plugin>,
    /// Whether examinations of fixtures get no answer.
    pub hides_liveness: bool,
    /// The probes of each examination.
    pub probes: Vec<ProbeSelection>,
    /// How long the runner waits for stack dumps of hosts.
    pub dump_waits: Vec<Duration>,
    order: OrderChecker,
    seq: u64,
}

impl<'p> World<'p> {
    pub fn new(plan: &'p SuitePlan) -> Self {
        Self::build(plan, false)
    }

    /// A soak.
    pub fn timed(plan: &'p SuitePlan) -> Self {
        Self::build(plan, true)
    }

    fn build(plan: &'p SuitePlan, timed: bool) -> Self {
        let mut world = Self {
            now: Duration::ZERO,
            machine: SuiteMachine::new(plan, FailLimit::default()),
            record: Record::default(),
            hosts: BTreeMap::new(),
            sent: Vec::new(),
            log: Vec::new(),
            transcript_start: 0,
            events: Vec::new(),
            deadlines: BTreeMap::new(),
            asking: BTreeMap::new(),
            done: false,
            idle: BTreeSet::new(),
            answered: BTreeSet::new(),
            assigned: BTreeMap::new(),
            joined: Vec::new(),
            hides_liveness: false,
            probes: Vec::new(),
            dump_waits: Vec::new(),
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
            working_dir: String::new(),
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
            parallel: plan.settings.parallel,
            requires: Vec::new(),
            skips_fail: plan.settings.skips_fail,
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
                learned: Vec::new(),
                test: test.id,
                suite: plan.id,
                name: test.name.clone(),
                plugin_type: "dll".to_owned(),
                plugin: String::new(),
                repetitions: test.settings.repetitions,
                timed,
                tags: Vec::new(),
                plugin_hash: None,
                source_hash: None,
                was: None,
                expected: test.expected.clone(),
                parameters: Vec::new(),
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
        self.events.push(event.kind.clone());
        let json = serde_json::to_value(&event.kind).unwrap();
        self.log.push(format!("{:>5.1}  {}", self.now.as_secs_f64(), line_of(&json)));
    }

    pub fn feed(&mut self, input: Input) {
        use ProcessEvent::{Exited, Released};
        let ends = matches!(&input, Input::Host(_, Exited(..) | Released));
        let (mut effects, mut checked) = (Vec::new(), Vec::new());
        self.machine.handle(input, self.now, &mut effects);
        let mut examined = Vec::new();
        for effect in effects {
            match effect {
                Effect::CheckAlive(host, probes) => {
                    self.probes.push(probes);
                    examined.push(host);
                }
                Effect::Emit(kind) => self.emit(kind),
                Effect::Spawn { host, source, .. } => drop(self.hosts.insert(host, source)),
                Effect::Join { host, on, source, request, plugin } => {
                    let is_assigned = self.assigned.values().any(|(id, ..)| *id == on);
                    assert!(is_assigned || self.hosts.contains_key(&on) || self.idle.contains(&on));
                    assert!(self.assigned.insert(on, (host, source, request)).is_none());
                    self.joined.push(*plugin);
                }
                Effect::Send(host, id, request) => {
                    if let (true, Some(id), Request::CheckFixture {}) = (ends, id, &*request) {
                        checked.push((host, id));
                    }
                    self.sent.push((host, id, *request));
                }
                Effect::SetDeadline(deadline, at) => drop(self.deadlines.insert(deadline, at)),
                Effect::ClearDeadline(deadline) => drop(self.deadlines.remove(&deadline)),
                Effect::PauseLimits(test) => {
                    assert!(self.asking.insert(test, self.now).is_none());
                }
                Effect::ResumeLimits(test) => self.resume_limits(test),
                Effect::Done => self.done = true,
                Effect::SpawnAhead(_) => {}
                other => {
                    if let Effect::DumpStack(.., wait) = other {
                        self.dump_waits.push(wait);
                    }
                    self.log.push(format!(
                        "{:>5.1}    {}",
                        self.now.as_secs_f64(),
                        effect_of(&other)
                    ));
                }
            }
        }
        examined.retain(|host| !self.hides_liveness && self.hosts.contains_key(host));
        examined.into_iter().for_each(|host| self.feed(Input::Host(host, ProcessEvent::Alive)));
        // Fixtures that are checked after a test pass.
        checked.retain(|(host, _)| !self.hides_liveness && self.hosts.contains_key(host));
        for (host, id) in checked {
            let answer = Reply::Result(serde_json::json!({ "outcome": "passed" }));
            self.feed(Input::Host(host, ProcessEvent::Replied(id, answer)));
        }
    }

    fn resume_limits(&mut self, test: TestId) {
        let since = self.asking.remove(&test).expect("its limits are paused");
        for timer in [TestTimer::Limit, TestTimer::Slow] {
            if let Some(at) = self.deadlines.get_mut(&Deadline::Test(test, timer)) {
                *at += self.now - since;
            }
        }
    }

    pub fn start(&mut self) {
        self.feed(Input::Start);
    }

    pub fn stop(&mut self, level: StopLevel) {
        let (reason, limit) = ("SIGINT".to_owned(), 20 * SECOND);
        self.feed(Input::Stop(Stop { level, reason, limit }));
    }

    pub fn host_of(&self, source: Source) -> HostId {
        let host = self.hosts.iter().find(|(_, of)| **of == source);
        *host.unwrap_or_else(|| panic!("no host of {source:?}\n{:#?}", self.log)).0
    }

    pub fn input(&mut self, source: Source, input: ProcessEvent) {
        let host = self.host_of(source);
        if matches!(input, ProcessEvent::Exited(..) | ProcessEvent::SpawnFailed(_)) {
            self.hosts.remove(&host);
            self.answered.remove(&host);
        }
        let status = match &input {
            ProcessEvent::Exited(status, _) => Some(*status),
            _ => None,
        };
        self.feed(Input::Host(host, input));
        status.into_iter().for_each(|status| self.refuse_assigned(host, status));
    }

    pub fn exit(&mut self, source: Source, status: ExitStatus) {
        self.input(source, ProcessEvent::Exited(status, Vec::new()));
    }

    /// Advances time to the next deadline.
    pub fn next_deadline(&mut self) -> Deadline {
        let is_paused = |deadline: &Deadline| match deadline {
            Deadline::Test(test, TestTimer::Limit | TestTimer::Slow) => {
                self.asking.contains_key(test)
            }
            _ => false,
        };
        let due = self.deadlines.iter().filter(|(deadline, _)| !is_paused(deadline));
        let next = due.min_by_key(|(_, at)| **at);
        let (deadline, at) = next.map(|(deadline, at)| (*deadline, *at)).expect("a deadline");
        self.now = self.now.max(at);
        self.deadlines.remove(&deadline);
        self.feed(Input::Deadline(deadline));
        deadline
    }

    pub fn finish(&mut self) {
        assert!(self.done, "the suite has not finished\n{:#?}", self.log);
        assert!(self.asking.is_empty(), "limits are paused: {:?}", self.asking);
        assert!(self.deadlines.is_empty(), "deadlines are left: {:?}", self.deadlines);
        self.emit(EventKind::RunFinished { interrupted: None });
    }

    /// Lets the transcript begin here.
    pub fn restart_transcript(&mut self) {
        self.transcript_start = self.log.len();
    }

    /// The events without the plan, and the effects.
    pub fn transcript(&self) -> String {
        let lines = self.log[self.transcript_start..].iter();
        let lines = lines.filter(|line| !line.contains("-planned") && !line.contains("run-"));
        lines.cloned().collect::<Vec<_>>().join("\n")
    }
}
