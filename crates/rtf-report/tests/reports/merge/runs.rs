//! Random runs, and their parts.

use proptest::prelude::*;
use rtf_model::{
    Attachment, Event, EventKind, FixtureId, FixturePlanned, FixtureProvided, HookId, HookPlanned,
    Manifest, Measurement, Message, MessageKind, Micros, Phase, RunStarted, Source, SuiteId,
    SuitePlanned, TestFinished, TestId, TestPlanned, Trigger, Usage, Verdict,
};

/// What each attempt of a test comes to, whichever part runs it.
#[derive(Clone, Debug)]
pub struct Try {
    pub verdict: Verdict,
    pub takes: u64,
    pub messages: u32,
    pub measured: Option<f64>,
}

#[derive(Clone, Debug)]
pub struct Test {
    /// The attempts of each repetition, the last of which counts.
    pub repetitions: Vec<Vec<Try>>,
    /// Whether it is skipped after the first attempts.
    pub skipped: bool,
    pub part: u32,
}

#[derive(Clone, Debug)]
pub struct Suite {
    pub fixtures: u32,
    pub hooks: u32,
    /// Whether its first fixture collapses after each test, and once for all
    /// after the first one of a part.
    pub collapses: bool,
    pub breaks: bool,
    pub tests: Vec<Test>,
}

fn attempt() -> impl Strategy<Value = Try> {
    let verdict = prop_oneof![
        4 => Just(Verdict::Passed),
        1 => Just(Verdict::Failed),
        1 => Just(Verdict::Crashed),
        1 => Just(Verdict::Collapsed),
    ];
    let measured = proptest::option::of(-10.0..10.0);
    (verdict, 0..5000_u64, 0..4_u32, measured)
        .prop_map(|(verdict, takes, messages, measured)| Try { verdict, takes, messages, measured })
}

fn test() -> impl Strategy<Value = Test> {
    let repetitions = prop::collection::vec(prop::collection::vec(attempt(), 1..3), 1..3);
    (repetitions, prop::bool::weighted(0.1), 0..PARTS)
        .prop_map(|(repetitions, skipped, part)| Test { repetitions, skipped, part })
}

pub fn suites() -> impl Strategy<Value = Vec<Suite>> {
    let suite =
        (0..3_u32, 0..2_u32, any::<bool>(), any::<bool>(), prop::collection::vec(test(), 1..5));
    let suite = suite.prop_map(|(fixtures, hooks, collapses, breaks, tests)| Suite {
        fixtures,
        hooks,
        collapses,
        breaks,
        tests,
    });
    prop::collection::vec(suite, 1..4)
}

pub const PARTS: u32 = 3;

/// A run of those tests that are chosen.
pub struct Run {
    events: Vec<Event>,
    now: u64,
    /// How many tests the shared host of the suite has served.
    tests_served: u32,
}

impl Run {
    fn push(&mut self, kind: EventKind) {
        self.now += 7;
        self.events.push(Event { seq: self.events.len() as u64, at: Micros(self.now), kind });
    }

    pub fn of(suites: &[Suite], part: Option<u32>) -> Option<Vec<Event>> {
        let chosen = |test: &Test| part.is_none_or(|part| test.part == part);
        let all: usize = suites.iter().map(|suite| suite.tests.len()).sum();
        let tests =
            suites.iter().flat_map(|suite| &suite.tests).filter(|test| chosen(test)).count();
        if tests == 0 {
            return None;
        }
        let manifest = Manifest {
            inputs: vec!["suites".into()],
            shard: part.map(|part| format!("{}/{PARTS}", part + 1)),
            selected_from: if tests == all { 0 } else { all as u32 },
            ..Manifest::default()
        };
        let now = u64::from(part.unwrap_or(0)) * 1000;
        let mut run = Self { events: Vec::new(), now, tests_served: 0 };
        let with_tests = suites.iter().filter(|suite| suite.tests.iter().any(chosen)).count();
        run.push(run_started((with_tests as u32, tests as u32), manifest));
        let mut planned = Vec::new();
        for (number, suite) in suites.iter().enumerate() {
            if suite.tests.iter().any(chosen) {
                planned.push(run.plan(number, suite, planned.last(), &chosen));
            }
        }
        for plan in &planned {
            run.suite(plan);
        }
        run.push(EventKind::RunFinished { interrupted: None });
        Some(run.events)
    }

    fn plan<'a>(
        &mut self,
        number: usize,
        suite: &'a Suite,
        last: Option<&Planned<'a>>,
        chosen: &impl Fn(&Test) -> bool,
    ) -> Planned<'a> {
        let id = SuiteId(last.map_or(0, |last| last.id.0 + 1));
        let fixture = last.map_or(0, |last| last.fixture + last.suite.fixtures);
        let hook = last.map_or(0, |last| last.hook + last.suite.hooks);
        let next = last.map_or(0, |last| last.test + last.tests.len() as u32);
        self.push(EventKind::SuitePlanned(SuitePlanned {
            suite: id,
            name: format!("suite-{number}"),
            file: format!("suite-{number}.xml"),
            description: String::new(),
            environment: String::new(),
            tolerates_collapse: number == 0,
            parallel: 1,
            requires: Vec::new(),
            skips_fail: false,
        }));
        for place in 0..suite.fixtures {
            self.push(EventKind::FixturePlanned(FixturePlanned {
                fixture: FixtureId(fixture + place),
                suite: id,
                name: format!("fixture-{place}"),
                plugin_type: "process".into(),
            }));
        }
        for place in 0..suite.hooks {
            self.push(EventKind::HookPlanned(HookPlanned {
                hook: HookId(hook + place),
                suite: id,
                name: format!("hook-{place}"),
                on: vec![Trigger::End],
            }));
        }
        let tests: Vec<_> =
            suite.tests.iter().enumerate().filter(|(_, test)| chosen(test)).collect();
        for (place, (name, test)) in (0..).zip(&tests) {
            self.push(EventKind::TestPlanned(TestPlanned {
                learned: Vec::new(),
                test: TestId(next + place),
                suite: id,
                name: format!("test-{name}"),
                plugin_type: "lua".into(),
                plugin: "/robot/test.lua".into(),
                repetitions: test.repetitions.len() as u32,
                timed: false,
                tags: Vec::new(),
                plugin_hash: None,
                source_hash: None,
                was: None,
                expected: None,
                parameters: Vec::new(),
            }));
        }
        let tests = tests.into_iter().map(|(_, test)| test).collect();
        Planned { id, number, suite, fixture, hook, test: next, tests }
    }

    fn suite(&mut self, plan: &Planned<'_>) {
        self.push(EventKind::SuiteStarted { suite: plan.id });
        self.tests_served = 0;
        let fixtures = || (plan.fixture..plan.fixture + plan.suite.fixtures).map(FixtureId);
        fixtures().for_each(|fixture| self.up(plan, fixture, 1));
        let (mut starts, mut broken) = (1, false);
        for (test, planned) in (plan.test..).map(TestId).zip(&plan.tests) {
            if broken {
                self.push(EventKind::TestSkipped { test, reason: "fixture broken".into() });
                continue;
            }
            self.test(test, planned);
            if let Some(fixture) = fixtures().next().filter(|_| plan.suite.collapses) {
                let reason = "gone".to_owned();
                let log_tail = Vec::new();
                self.push(EventKind::FixtureCollapsed {
                    fixture,
                    reason: reason.clone(),
                    log_tail,
                });
                broken = plan.suite.breaks;
                if broken {
                    self.push(EventKind::FixtureBroken { fixture, reason });
                }
                self.down(fixture);
                if !broken {
                    starts += 1;
                    self.up(plan, fixture, starts);
                }
            }
        }
        for hook in (plan.hook..plan.hook + plan.suite.hooks).map(HookId) {
            let (trigger, reason) = (Trigger::End, "the suite ends".into());
            self.push(EventKind::HookStarted {
                hook,
                trigger,
                reason,
                test: Some(TestId(plan.test)),
            });
            self.push(EventKind::HookFinished { hook, problem: None });
        }
        fixtures().skip(usize::from(broken)).for_each(|fixture| self.down(fixture));
        self.push(EventKind::SuiteFinished { suite: plan.id });
    }

    fn up(&mut self, plan: &Planned<'_>, fixture: FixtureId, attempt: u32) {
        self.push(EventKind::FixtureStarting { fixture, attempt });
        // In every part the same, although the ids differ.
        let address = format!("suite-{}/fixture-{}", plan.number, fixture.0 - plan.fixture);
        for (name, value) in [("address", Some(address.into())), ("token", None)] {
            let (name, secret) = (name.to_owned(), value.is_none());
            self.push(EventKind::FixtureProvided(FixtureProvided { fixture, name, value, secret }));
        }
        self.push(EventKind::FixtureReady { fixture });
    }

    fn down(&mut self, fixture: FixtureId) {
        self.push(EventKind::FixtureStopping { fixture });
        self.push(EventKind::FixtureStopped { fixture, problem: None, log_tail: Vec::new() });
    }

    fn test(&mut self, test: TestId, planned: &Test) {
        for (repetition, tries) in (1..).zip(&planned.repetitions) {
            for (attempt, tried) in (1..).zip(tries) {
                self.push(EventKind::TestStarted { test, repetition, attempt });
                self.push(EventKind::TestPhase { test, phase: Phase::Run });
                self.reports(test, tried);
                self.now += tried.takes;
                self.used(test, tried.verdict);
                self.push(EventKind::TestFinished(TestFinished {
                    test,
                    verdict: tried.verdict,
                    reason: Some(format!("it is {}", tried.verdict)),
                    phase: Phase::Run,
                    exit: None,
                    rerun: attempt < tries.len() as u32,
                    decided_by: None,
                }));
            }
            if planned.skipped {
                self.push(EventKind::TestSkipped { test, reason: "enough".into() });
                return;
            }
        }
    }

    /// One host serves the tests, until one does not pass.
    fn used(&mut self, test: TestId, verdict: Verdict) {
        if verdict != Verdict::Passed {
            self.tests_served = 0;
            return;
        }
        self.tests_served += 1;
        let usage =
            Usage { processes: 1, memory: u64::from(self.tests_served) << 20, descriptors: 9 };
        let (source, tests_served) = (Source::Test(test), Some(self.tests_served));
        self.push(EventKind::ResourcesMeasured { source, usage, tests_served });
    }

    fn reports(&mut self, test: TestId, tried: &Try) {
        for number in 0..tried.messages {
            let (source, text) = (Source::Test(test), format!("message {number}"));
            let kind = MessageKind::Report;
            let message = Message {
                kind,
                text,
                location: None,
                comparison: None,
                critical: false,
                case: None,
                interval: None,
            };
            self.push(EventKind::Message { source, message, test: None });
        }
        if let Some(value) = tried.measured {
            let measurement = Measurement {
                learned: false,
                name: "error".into(),
                value: Some(value),
                unit: "rad".into(),
                low: None,
                high: Some(5.0),
                location: None,
                case: None,
            };
            self.push(EventKind::Measured { test, fixture: None, measurement });
            let attachment = Attachment {
                name: "plot".into(),
                path: format!("attachments/{test}/1/plot.png"),
                media_type: "image/png".into(),
                case: None,
                picture: None,
                omitted: false,
            };
            self.push(EventKind::Attached { test, fixture: None, attachment });
        }
    }
}

struct Planned<'a> {
    id: SuiteId,
    /// The suite's place in the whole run.
    number: usize,
    suite: &'a Suite,
    fixture: u32,
    hook: u32,
    test: u32,
    tests: Vec<&'a Test>,
}

fn run_started((suites, tests): (u32, u32), manifest: Manifest) -> EventKind {
    EventKind::RunStarted(RunStarted {
        version: 1,
        run: "run".into(),
        rtf: "0.1.0".into(),
        started_at: "2026-11-21T06:30:12+00:00".into(),
        command: vec!["rtf".into()],
        working_dir: "/robot".into(),
        suites,
        tests,
        manifest: Box::new(manifest),
    })
}
