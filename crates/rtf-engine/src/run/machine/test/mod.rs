//! One attempt of a test: its phases and limits, up to its end. How it is
//! stopped is in [`stop`], how it gets its host in [`sharing`], what its plug-in
//! tells in [`telling`], how it waits for fixtures in [`looking`].

mod answers;
mod looking;
pub mod sharing;
mod stop;
mod stopwatch;
mod telling;

use std::time::Duration;

use rtf_model::protocol::{Reply, StackSupport};
use rtf_model::{
    EventKind, ExitStatus, LeakedProcess, Phase, Source, StopCause, Stream, TestFinished, TestId,
    Verdict,
};

pub use answers::{parse_answer, parse_initialized};

use crate::run::machine::capture::Capture;
use crate::run::machine::io::{
    Deadline, Effect, HostId, HostInput, Program, Start, TestTimer, environment,
};
use crate::run::machine::judge::{Evidence, judge, leak_of};
use crate::run::machine::suite::Context;
use rtf_plan::plan::{SuitePlan, TestPlan};
use rtf_process::codec::INITIALIZE;
use stopwatch::Stopwatch;

/// The number of the first `run-test` on a host's channel.
const RUN_TEST: u64 = 2;

/// From SIGTERM to SIGKILL.
pub const TERM_GRACE: Duration = Duration::from_secs(1);
/// How often a process is killed, and how long each time until it must have ended.
/// One that waits in the kernel may never end.
pub const KILLS: u32 = 2;
pub const KILL_WAIT: Duration = Duration::from_secs(5);
/// A test that did not pass waits this long for a fixture's collapse: a connection
/// breaks before the kernel tells of the death at its other end. One that passed
/// waits until all fixtures have passed an examination, which has limits of its own.
/// Both wait for the end of a fixture that was seen to die.
const SETTLE: Duration = Duration::from_millis(200);

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Step {
    /// A stack dump is being taken; then the test is asked to stop.
    DumpThenAsk,
    /// It was asked to stop.
    Asked,
    /// Its grace is over, a stack dump is being taken.
    DumpThenForce,
    /// It got SIGTERM.
    Terminated,
    /// It got SIGKILL.
    Killed,
}

/// How far its process is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Process {
    /// It lives, or is being started.
    Alive,
    /// It is gone and would have passed, if all fixtures live.
    Looking,
    /// It is gone, but a fixture may turn out to have collapsed before.
    Settling,
    /// It is gone, and nothing more is waited for.
    Over,
    /// The attempt is judged, and nothing changes that.
    Judged,
}

/// What an attempt that is over means for the suite.
#[derive(Debug)]
pub struct Ended {
    /// The judgement.
    pub verdict: Verdict,
    /// Why it did not pass.
    pub reason: Option<String>,
    /// Where it was decided.
    pub phase: Phase,
    /// How the process ended.
    pub exit: Option<ExitStatus>,
    /// A critical assertion that did not hold: its text.
    pub critical: Option<String>,
}

/// Where a test runs.
#[derive(Clone, Copy, Debug)]
pub enum Place {
    /// In a host of its own, at least at first.
    New,
    /// In the host that served this one last.
    On(HostId),
    /// In a host that was asked for it before.
    Asked(HostId),
}

/// One attempt of a test.
#[derive(Debug)]
pub struct TestRun<'p> {
    plan: &'p TestPlan,
    host: HostId,
    /// The number of its request.
    request: u64,
    /// Whether its host can serve several tests.
    shares: bool,
    /// Whether its host has outlived it.
    released: bool,
    phase: Phase,
    evidence: Evidence,
    stack: StackSupport,
    stack_taken: bool,
    step: Option<Step>,
    /// How often its process was killed.
    kills: u32,
    /// How many times a limit it may take in wall time, if it follows another clock.
    backstop: Option<u32>,
    /// The measure of its phase, if it follows another clock.
    stopwatch: Option<Stopwatch>,
    process: Process,
    /// Whether there are fixtures that may have collapsed.
    has_fixtures: bool,
    leak: Option<String>,
    captures: [Capture; 2],
    critical: Option<String>,
    ended: Option<Ended>,
}

impl<'p> TestRun<'p> {
    /// Starts an attempt: emits `test-started`, starts the host, and asks it
    /// for everything at once.
    pub fn start(
        suite: &SuitePlan,
        plan: &'p TestPlan,
        (repetition, attempt): (u32, u32),
        (place, last): (Place, bool),
        cx: &mut Context<'_>,
    ) -> Self {
        let source = Source::Test(plan.id);
        cx.emit(EventKind::TestStarted { test: plan.id, repetition, attempt });
        let wanted = (repetition, last);
        let (host, request) = match place {
            Place::New => (sharing::spawn(suite, plan, wanted, cx), RUN_TEST),
            Place::On(on) => {
                let host = sharing::ask(suite, plan, wanted, on, cx);
                (host, sharing::request_of(host))
            }
            Place::Asked(host) => (host, sharing::request_of(host)),
        };
        cx.set(Deadline::Test(plan.id, TestTimer::Limit), plan.limits.load);
        Self {
            plan,
            host,
            request,
            shares: !matches!(place, Place::New),
            released: false,
            phase: Phase::Load,
            evidence: Evidence::default(),
            stack: StackSupport::None,
            stack_taken: false,
            step: None,
            kills: 0,
            backstop: suite.clock.as_ref().map(|clock| clock.backstop),
            stopwatch: None,
            process: Process::Alive,
            has_fixtures: !suite.fixtures.is_empty(),
            leak: None,
            captures: [Capture::new(source, Stream::Stdout), Capture::new(source, Stream::Stderr)],
            critical: None,
            ended: None,
        }
    }

    /// How a test's host is started.
    pub fn host_start(suite: &SuitePlan, plan: &TestPlan) -> Start {
        Start {
            what: Program::Host(plan.plugin.host.clone()),
            env: environment(suite, &plan.env, "test", &plan.name),
            folder: suite.folder.clone(),
        }
    }

    /// Its test.
    pub fn id(&self) -> TestId {
        self.plan.id
    }

    /// The process of this attempt.
    pub fn host(&self) -> HostId {
        self.host
    }

    /// Takes in what its process did.
    pub fn handle(&mut self, input: HostInput, cx: &mut Context<'_>) {
        match input {
            HostInput::SpawnFailed(reason) => {
                self.note(Verdict::Error, reason);
                self.process = Process::Over;
            }
            HostInput::Exited(status, left) => self.exited(Some(status), left, cx),
            HostInput::Released => {
                self.released = true;
                self.exited(None, Vec::new(), cx);
            }
            HostInput::Told(notification) => self.told(notification, cx),
            HostInput::Attached(Ok(attachment)) => {
                cx.emit(EventKind::Attached { test: self.plan.id, fixture: None, attachment });
            }
            HostInput::Attached(Err(reason)) => self.own_error(reason, cx),
            HostInput::Answered(INITIALIZE, reply) => self.initialized(reply, cx),
            HostInput::Answered(id, reply) if id == self.request => self.answered(reply, cx),
            HostInput::Answered(id, _) => self.broke_protocol(format!("answered request {id}"), cx),
            HostInput::Garbage(what) => self.broke_protocol(what, cx),
            HostInput::Printed(stream, bytes) => {
                if let Some(output) = self.captures[stream as usize].push(&bytes) {
                    cx.emit(EventKind::Output(output));
                }
            }
            HostInput::StackTaken(text) => self.stack_taken(text, cx),
            HostInput::Uses { usage, tests_served } => {
                cx.emit(EventKind::ResourcesMeasured {
                    source: Source::Test(self.plan.id),
                    usage,
                    tests_served,
                });
            }
            HostInput::Throttled => self.pause_clock(true),
            HostInput::Resumed => self.pause_clock(false),
            HostInput::Unbegun(_)
            | HostInput::ProbesHold
            | HostInput::ProbeWaits(_)
            | HostInput::ProbeFailed(_)
            | HostInput::Lives
            | HostInput::Dies => {}
        }
    }

    fn initialized(&mut self, reply: Reply<serde_json::Value>, cx: &mut Context<'_>) {
        match parse_initialized(reply) {
            Ok(initialized) => {
                self.stack = initialized.stack;
                self.shares = self.plan.shared && initialized.supports_shared;
            }
            Err(what) => self.broke_protocol(what, cx),
        }
    }

    fn answered(&mut self, reply: Reply<serde_json::Value>, cx: &mut Context<'_>) {
        if self.evidence.answer.is_some() {
            return self.broke_protocol("answered the same request twice".to_owned(), cx);
        }
        match parse_answer(reply) {
            Ok(answer) => {
                if !answer.as_ref().is_ok_and(|answer| answer.continues) {
                    cx.out(Effect::CloseChannel(self.host));
                }
                self.evidence.answer = Some(answer);
                self.phase = Phase::Exit;
                self.stopwatch = None;
                cx.clear(Deadline::Test(self.plan.id, TestTimer::Slow));
                if self.step.is_none() {
                    cx.set(
                        Deadline::Test(self.plan.id, TestTimer::Limit),
                        self.plan.limits.teardown,
                    );
                }
            }
            Err(what) => self.broke_protocol(what, cx),
        }
    }

    fn broke_protocol(&mut self, what: String, cx: &mut Context<'_>) {
        let reason = format!("the host broke the protocol: {what}");
        self.stop(StopCause::Protocol, reason, cx);
    }

    fn exited(&mut self, exit: Option<ExitStatus>, left: Vec<LeakedProcess>, cx: &mut Context<'_>) {
        self.stopwatch = None;
        cx.clear(Deadline::Test(self.plan.id, TestTimer::Slow));
        for capture in &mut self.captures {
            if let Some(output) = capture.finish() {
                cx.emit(EventKind::Output(output));
            }
        }
        self.leak = leak_of(self.plan.leaks, &left);
        if !left.is_empty() {
            let source = Source::Test(self.plan.id);
            cx.emit(EventKind::ProcessesLeaked { source, processes: left });
        }
        (self.evidence.exit, self.evidence.released) = (exit, self.released);
        let (verdict, ..) = judge(&self.evidence, self.phase);
        let may_be_collapsed = self.has_fixtures && self.evidence.stopped.is_none();
        self.process = match (may_be_collapsed, verdict.is_green()) {
            (false, _) => Process::Over,
            (true, true) => Process::Looking,
            (true, false) => Process::Settling,
        };
        let limit = Deadline::Test(self.plan.id, TestTimer::Limit);
        match self.process {
            Process::Settling => cx.set(limit, SETTLE),
            _ => cx.clear(limit),
        }
    }

    /// Judges it once its process is gone: verdict and reason, when that is now.
    pub fn judge_once(&mut self, cx: &mut Context<'_>) -> Option<(Verdict, Option<String>)> {
        if self.process != Process::Over {
            return None;
        }
        cx.clear(Deadline::Test(self.plan.id, TestTimer::Limit));
        cx.clear(Deadline::Test(self.plan.id, TestTimer::Slow));
        let (mut verdict, mut reason, phase) = judge(&self.evidence, self.phase);
        if let (Verdict::Passed, Some(problem)) = (verdict, self.leak.take()) {
            verdict = Verdict::Error;
            reason = Some(problem);
        }
        self.process = Process::Judged;
        let (exit, critical) = (self.evidence.exit, self.critical.take());
        self.ended = Some(Ended { verdict, reason: reason.clone(), phase, exit, critical });
        Some((verdict, reason))
    }

    /// Whether its verdict is spoken.
    pub fn is_judged(&self) -> bool {
        self.process == Process::Judged
    }

    /// Its end, once it is judged. The caller then emits `test-finished` with [`Self::finished`].
    pub fn take_end(&mut self) -> Option<Ended> {
        self.ended.take()
    }

    /// The last event of this attempt.
    pub fn finished(&self, ended: &Ended, rerun: bool) -> EventKind {
        EventKind::TestFinished(TestFinished {
            test: self.plan.id,
            verdict: ended.verdict,
            reason: ended.reason.clone(),
            phase: ended.phase,
            exit: ended.exit,
            rerun,
        })
    }
}
