//! Short ways to write event streams.

use rtf_model::{
    Event, EventKind, FixtureId, FixturePlanned, HookId, HookPlanned, LeakedProcess, Micros, Phase,
    RunStarted, SuiteId, SuitePlanned, TestFinished, TestId, TestPlanned, Trigger, Verdict,
};

pub const SUITE: SuiteId = SuiteId(0);
pub const SIMULATOR: FixtureId = FixtureId(0);
pub const TEST: TestId = TestId(0);
pub const PARK: HookId = HookId(0);

pub fn run_started() -> EventKind {
    EventKind::RunStarted(RunStarted {
        version: 1,
        run: "run".into(),
        rtf: "0.1.0".into(),
        started_at: "2026-11-21T06:30:12+00:00".into(),
        command: vec!["rtf".into()],
        working_dir: "/robot".into(),
        suites: 1,
        tests: 1,
        manifest: Box::default(),
    })
}

pub fn suite(id: u32) -> EventKind {
    EventKind::SuitePlanned(SuitePlanned {
        suite: SuiteId(id),
        name: format!("suite-{id}"),
        file: String::new(),
        description: String::new(),
        environment: String::new(),
        tolerates_collapse: false,
        parallel: 1,
        requires: Vec::new(),
        skips_fail: false,
    })
}

pub fn fixture(id: u32, suite: u32) -> EventKind {
    EventKind::FixturePlanned(FixturePlanned {
        fixture: FixtureId(id),
        suite: SuiteId(suite),
        name: format!("fixture-{id}"),
        plugin_type: "process".into(),
    })
}

pub fn test(id: u32, suite: u32, repetitions: u32) -> EventKind {
    EventKind::TestPlanned(TestPlanned {
        learned: Vec::new(),
        test: TestId(id),
        suite: SuiteId(suite),
        name: format!("test-{id}"),
        plugin_type: "lua".into(),
        plugin: format!("/robot/test-{id}.lua"),
        repetitions,
        timed: false,
        tags: Vec::new(),
        plugin_hash: None,
        source_hash: None,
        was: None,
        expected: None,
        parameters: Vec::new(),
    })
}

pub fn hook(id: u32, suite: u32) -> EventKind {
    EventKind::HookPlanned(HookPlanned {
        hook: HookId(id),
        suite: SuiteId(suite),
        name: format!("hook-{id}"),
        on: vec![Trigger::Collapse, Trigger::End],
    })
}

pub fn hook_started(trigger: Trigger) -> EventKind {
    EventKind::HookStarted { hook: PARK, trigger, reason: "for a reason".into(), test: Some(TEST) }
}

pub fn hook_finished(problem: Option<&str>) -> EventKind {
    EventKind::HookFinished { hook: PARK, problem: problem.map(str::to_owned) }
}

pub fn runner_died() -> EventKind {
    let left = vec![process(7, Some("test suite-0/test-0"))];
    EventKind::RunnerDied { reason: "signal 9 (SIGKILL)".into(), leaked: left }
}

pub fn process(pid: i32, owner: Option<&str>) -> LeakedProcess {
    LeakedProcess { pid, command: "sleep 9".into(), owner: owner.map(str::to_owned) }
}

pub fn started(repetition: u32, attempt: u32) -> EventKind {
    EventKind::TestStarted { test: TEST, repetition, attempt }
}

pub fn finished(verdict: Verdict) -> EventKind {
    finish(verdict, false)
}

pub fn rerun(verdict: Verdict) -> EventKind {
    finish(verdict, true)
}

fn finish(verdict: Verdict, rerun: bool) -> EventKind {
    let reason = (!verdict.is_green()).then(|| format!("{verdict} for a reason"));
    let phase = Phase::Run;
    EventKind::TestFinished(TestFinished {
        test: TEST,
        verdict,
        reason,
        phase,
        exit: None,
        rerun,
        decided_by: None,
    })
}

pub fn skipped(test: u32) -> EventKind {
    EventKind::TestSkipped { test: TestId(test), reason: "no robot".into() }
}

/// Numbers the events and gives each the time of its number in milliseconds.
pub fn stream(kinds: impl IntoIterator<Item = EventKind>) -> Vec<Event> {
    let number = |(seq, kind)| Event { seq, at: Micros(seq * 1000), kind };
    (0..).zip(kinds).map(number).collect()
}

/// A run of one suite with one fixture and one test, the suite already started.
pub fn opened(repetitions: u32) -> Vec<EventKind> {
    let planned = [run_started(), suite(0), fixture(0, 0), test(0, 0, repetitions)];
    planned.into_iter().chain([EventKind::SuiteStarted { suite: SUITE }]).collect()
}

/// As [`opened`], with a hook.
pub fn opened_with_hook(repetitions: u32) -> Vec<EventKind> {
    let mut kinds = opened(repetitions);
    kinds.insert(3, hook(0, 0));
    kinds
}

pub fn closed() -> [EventKind; 2] {
    [EventKind::SuiteFinished { suite: SUITE }, EventKind::RunFinished { interrupted: None }]
}
