//! One fixture, from set-up to tear-down, over all its restarts.

use std::sync::Arc;
use std::time::Duration;

use rtf_model::protocol::{Answer, Notification, Plugin, Reply, Request, StackSupport};
use rtf_model::{EventKind, ExitStatus, FixtureId, LeftProcess, Outcome, Source, Stream};

use super::capture::Capture;
use super::io::{Deadline, Effect, FixtureTimer, HostId, HostInput, Program, Start, environment};
use super::log_watch::LogWatch;
use super::suite::Context;
use super::test::{TERM_GRACE, parse_answer, parse_initialized};
use crate::host::codec::INITIALIZE;
use crate::plan::{FixtureBody, FixturePlan, ProbeKind, ProcessPlan, SuitePlan};

const SIGTERM: i32 = 15;
const SET_UP: u64 = 2;
/// The environment variable that counts a fixture's starts, from 1.
const START_VARIABLE: &str = "RTF_FIXTURE_START";
/// No restart waits longer than this.
const LONGEST_DELAY: Duration = Duration::from_secs(10);

/// Where a fixture is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// Not there: never started, or torn down.
    Stopped,
    /// Not there, and to be started again after a while.
    Waiting,
    /// Being set up.
    Starting,
    /// There, and watched.
    Ready,
    /// It was ready and is not any more, or its set-up failed: it waits to be torn down.
    Unwell,
    /// Asked to tear down.
    Stopping,
    /// Torn down and asked to end, or being ended by force.
    Ending,
}

/// What an input meant.
#[derive(Debug, PartialEq, Eq)]
pub enum Change {
    /// Set-up failed.
    SetupFailed(String),
    /// It collapsed.
    Collapsed(String),
}

/// One fixture of a suite.
#[derive(Debug)]
pub struct FixtureRun<'p> {
    plan: &'p FixturePlan,
    suite: &'p SuitePlan,
    place: usize,
    state: State,
    host: Option<HostId>,
    starts: u32,
    request: u64,
    check: Option<u64>,
    teardown: Option<u64>,
    stack: StackSupport,
    probes_hold: bool,
    log: LogWatch,
    captures: [Capture; 2],
    problem: Option<String>,
    /// How long the next start has to wait.
    delay: Duration,
    /// Whether the plug-in may be in the middle of something.
    busy: bool,
    forced: bool,
}

impl<'p> FixtureRun<'p> {
    pub fn new(suite: &'p SuitePlan, place: usize) -> Self {
        let plan = &suite.fixtures[place];
        Self {
            plan,
            suite,
            place,
            state: State::Stopped,
            host: None,
            starts: 0,
            request: SET_UP,
            check: None,
            teardown: None,
            stack: StackSupport::None,
            probes_hold: false,
            log: LogWatch::default(),
            captures: captures(plan.id),
            problem: None,
            delay: Duration::ZERO,
            busy: false,
            forced: false,
        }
    }

    pub fn plan(&self) -> &'p FixturePlan {
        self.plan
    }

    pub fn state(&self) -> State {
        self.state
    }

    pub fn host(&self) -> Option<HostId> {
        self.host
    }

    /// How often it was started.
    pub fn starts(&self) -> u32 {
        self.starts
    }

    /// Whether a `check` waits for its answer.
    pub fn is_checking(&self) -> bool {
        self.check.is_some()
    }

    fn source(&self) -> Source {
        Source::Fixture(self.plan.id)
    }

    fn timer(&self, timer: FixtureTimer) -> Deadline {
        Deadline::Fixture(self.place, timer)
    }

    /// Lets the next start wait, the longer the more restarts there were.
    pub fn delay_restart(&mut self, restart: u32) {
        let factor = 1_u32.checked_shl(restart.saturating_sub(1)).unwrap_or(u32::MAX);
        self.delay = self.plan.restart_delay.saturating_mul(factor).min(LONGEST_DELAY);
    }

    /// Starts it, or lets it wait for its next start.
    pub fn start(&mut self, cx: &mut Context<'_>) {
        let delay = std::mem::take(&mut self.delay);
        if delay.is_zero() {
            return self.start_now(cx);
        }
        self.state = State::Waiting;
        cx.set(self.timer(FixtureTimer::RestartDue), delay);
    }

    /// Emits `fixture-starting`, and asks for its set-up.
    fn start_now(&mut self, cx: &mut Context<'_>) {
        let host = cx.new_host();
        self.host = Some(host);
        self.state = State::Starting;
        self.starts += 1;
        self.request = SET_UP;
        self.check = None;
        self.teardown = None;
        self.probes_hold = false;
        self.problem = None;
        self.busy = true;
        self.forced = false;
        self.captures = captures(self.plan.id);
        cx.emit(EventKind::FixtureStarting { fixture: self.plan.id, attempt: self.starts });
        let (what, folder) = match &self.plan.body {
            FixtureBody::Plugin(plugin) => {
                self.log = LogWatch::default();
                (Program::Host(plugin.host.clone()), self.suite.folder.clone())
            }
            FixtureBody::Process(process) => {
                self.log = log_watch(process);
                (Program::Process(Arc::new((**process).clone())), process.folder.clone())
            }
        };
        let mut env = environment(self.suite, &self.plan.env, "fixture", &self.plan.name);
        env.push((START_VARIABLE.to_owned(), self.starts.to_string()));
        let start = Start { what, env, folder };
        cx.out(Effect::Spawn { host, source: self.source(), start });
        if let FixtureBody::Plugin(plugin) = &self.plan.body {
            let request = Request::SetUpFixture(Plugin {
                file: plugin.file.to_string_lossy().into_owned(),
                name: self.plan.name.clone(),
                param: plugin.param.clone(),
                args: plugin.args.clone(),
                environment: self.suite.environment.clone(),
                repetition: self.starts,
                last: false,
                keep_folder: None,
            });
            cx.out(Effect::Send(host, Some(SET_UP), request));
        }
        cx.set(self.timer(FixtureTimer::Limit), self.plan.limits.setup);
    }

    /// Takes in what its process did.
    pub fn handle(&mut self, input: HostInput, cx: &mut Context<'_>) -> Option<Change> {
        match input {
            HostInput::SpawnFailed(reason) => {
                self.host = None;
                self.unwell(reason, cx)
            }
            HostInput::Exited(status, left) => self.exited(status, left, cx),
            HostInput::Told(notification) => self.told(notification, cx),
            HostInput::Attached(_) => None,
            HostInput::Answered(id, reply) => self.answered(id, reply, cx),
            HostInput::Garbage(what) => {
                self.unwell(format!("its host broke the protocol: {what}"), cx)
            }
            HostInput::Printed(stream, bytes) => self.printed(stream, &bytes, cx),
            HostInput::ProbesHold => {
                self.probes_hold = true;
                self.try_ready(cx);
                None
            }
            HostInput::ProbeFailed(reason) => self.unwell(reason, cx),
            HostInput::StackTaken(text) => {
                cx.emit(EventKind::StackDumped { source: self.source(), text });
                None
            }
        }
    }

    fn told(&mut self, notification: Notification, cx: &mut Context<'_>) -> Option<Change> {
        match notification {
            Notification::Message(message) => {
                cx.emit(EventKind::Message { source: self.source(), message });
                None
            }
            Notification::Collapsed { reason } => self.unwell(reason, cx),
            Notification::Stack { text } => self.handle(HostInput::StackTaken(text), cx),
            Notification::Phase { .. } | Notification::Measured(_) | Notification::Attached(_) => {
                None
            }
        }
    }

    fn printed(&mut self, stream: Stream, bytes: &[u8], cx: &mut Context<'_>) -> Option<Change> {
        if let Some(output) = self.captures[stream as usize].push(bytes) {
            cx.emit(EventKind::Output(output));
        }
        self.log.push(bytes);
        let change =
            self.log.take_found().and_then(|line| self.unwell(format!("it printed `{line}`"), cx));
        self.try_ready(cx);
        change
    }

    fn answered(
        &mut self,
        id: u64,
        reply: Reply<serde_json::Value>,
        cx: &mut Context<'_>,
    ) -> Option<Change> {
        if id == INITIALIZE {
            return match parse_initialized(reply) {
                Ok(stack) => {
                    self.stack = stack;
                    None
                }
                Err(what) => self.unwell(format!("its host broke the protocol: {what}"), cx),
            };
        }
        let answer = match parse_answer(reply) {
            Ok(Ok(answer)) => problem_of(&answer),
            Ok(Err(error)) => Some(format!("its host refused: {} ({})", error.message, error.code)),
            Err(what) => Some(format!("its host broke the protocol: {what}")),
        };
        if self.check == Some(id) {
            self.check = None;
            cx.clear(self.timer(FixtureTimer::Check));
            self.plan_check(cx);
            return answer.and_then(|why| self.unwell(format!("check failed: {why}"), cx));
        }
        if self.teardown == Some(id) {
            self.torn_down(answer, cx);
            return None;
        }
        if id == SET_UP && self.state == State::Starting {
            if let Some(why) = answer {
                return self.unwell(why, cx);
            }
            self.ready(cx);
        }
        None
    }

    fn try_ready(&mut self, cx: &mut Context<'_>) {
        let process = matches!(self.plan.body, FixtureBody::Process(_));
        if process && self.state == State::Starting && self.probes_hold && self.log.awaited_seen() {
            self.ready(cx);
        }
    }

    fn ready(&mut self, cx: &mut Context<'_>) {
        self.state = State::Ready;
        self.busy = false;
        cx.clear(self.timer(FixtureTimer::Limit));
        cx.emit(EventKind::FixtureReady { fixture: self.plan.id });
        match (&self.plan.body, self.host) {
            (FixtureBody::Process(process), Some(host)) if !process.alive.is_empty() => {
                cx.out(Effect::WatchAlive(host));
            }
            _ => self.plan_check(cx),
        }
    }

    fn plan_check(&mut self, cx: &mut Context<'_>) {
        let plugin = matches!(self.plan.body, FixtureBody::Plugin(_));
        if let (true, State::Ready, Some(every)) = (plugin, self.state, self.plan.check_every) {
            cx.set(self.timer(FixtureTimer::CheckDue), every);
        }
    }

    /// Asks a plug-in whether it is well, unless that is being asked already.
    pub fn ask_check(&mut self, cx: &mut Context<'_>) {
        let plugin = matches!(self.plan.body, FixtureBody::Plugin(_));
        if let (true, State::Ready, None, Some(host)) = (plugin, self.state, self.check, self.host)
        {
            let id = self.next_request();
            self.check = Some(id);
            cx.clear(self.timer(FixtureTimer::CheckDue));
            cx.out(Effect::Send(host, Some(id), Request::CheckFixture {}));
            cx.set(self.timer(FixtureTimer::Check), self.plan.limits.check);
        }
    }

    fn next_request(&mut self) -> u64 {
        self.request += 1;
        self.request
    }

    /// A set-up that failed, or a collapse. Only the first one counts; while
    /// it is torn down it is the tear-down's problem.
    fn unwell(&mut self, reason: String, cx: &mut Context<'_>) -> Option<Change> {
        self.busy |= self.check.take().is_some();
        cx.clear(self.timer(FixtureTimer::Check));
        cx.clear(self.timer(FixtureTimer::CheckDue));
        match self.state {
            State::Starting => {
                self.state = State::Unwell;
                cx.clear(self.timer(FixtureTimer::Limit));
                let reason = format!("set-up failed: {reason}");
                self.problem = Some(reason.clone());
                Some(Change::SetupFailed(reason))
            }
            State::Ready => {
                self.state = State::Unwell;
                let log_tail = self.log.tail();
                let fixture = self.plan.id;
                cx.emit(EventKind::FixtureCollapsed { fixture, reason: reason.clone(), log_tail });
                Some(Change::Collapsed(reason))
            }
            _ => None,
        }
    }

    fn exited(
        &mut self,
        status: ExitStatus,
        left: Vec<LeftProcess>,
        cx: &mut Context<'_>,
    ) -> Option<Change> {
        for capture in &mut self.captures {
            if let Some(output) = capture.finish() {
                cx.emit(EventKind::Output(output));
            }
        }
        if !left.is_empty() {
            cx.emit(EventKind::ProcessesLeft { source: self.source(), processes: left });
        }
        self.host = None;
        match self.state {
            State::Starting => {
                self.unwell(format!("it ended with {status} before it was ready"), cx)
            }
            State::Ready => self.unwell(format!("its process ended with {status}"), cx),
            State::Stopping | State::Ending => {
                self.judge_end(status);
                self.stopped(cx);
                None
            }
            State::Unwell | State::Stopped | State::Waiting => None,
        }
    }

    fn judge_end(&mut self, status: ExitStatus) {
        let plugin = matches!(self.plan.body, FixtureBody::Plugin(_));
        let clean = status == ExitStatus::Code(0);
        if plugin && !self.forced && (self.state == State::Stopping || !clean) {
            let problem = format!("its process ended with {status} in tear-down");
            self.problem.get_or_insert(problem);
        }
    }

    /// Tears it down.
    pub fn stop(&mut self, cx: &mut Context<'_>) {
        if self.state == State::Waiting {
            return self.forget_restart(cx);
        }
        cx.emit(EventKind::FixtureStopping { fixture: self.plan.id });
        self.busy |= self.check.take().is_some();
        cx.clear(self.timer(FixtureTimer::Check));
        cx.clear(self.timer(FixtureTimer::CheckDue));
        self.state = State::Stopping;
        let Some(host) = self.host else {
            return self.stopped(cx);
        };
        match &self.plan.body {
            FixtureBody::Plugin(_) => {
                if self.busy {
                    let reason = "the fixture is being torn down".to_owned();
                    cx.out(Effect::Send(host, None, Request::Interrupt { reason }));
                }
                let id = self.next_request();
                self.teardown = Some(id);
                cx.out(Effect::Send(host, Some(id), Request::TearDownFixture {}));
                cx.set(self.timer(FixtureTimer::Limit), self.plan.limits.teardown);
            }
            FixtureBody::Process(process) => {
                cx.out(Effect::Signal(host, process.stop_signal));
                cx.set(self.timer(FixtureTimer::Limit), process.stop_grace);
            }
        }
    }

    fn torn_down(&mut self, problem: Option<String>, cx: &mut Context<'_>) {
        self.teardown = None;
        if let Some(why) = problem {
            self.problem.get_or_insert(format!("tear-down failed: {why}"));
        }
        self.state = State::Ending;
        if let Some(host) = self.host {
            cx.out(Effect::CloseChannel(host));
        }
        cx.set(self.timer(FixtureTimer::Limit), self.plan.limits.teardown);
    }

    /// Kills its process and everything below it, now.
    pub fn kill(&mut self, cx: &mut Context<'_>) {
        match self.state {
            State::Stopped => return,
            State::Waiting => return self.forget_restart(cx),
            _ => {}
        }
        if !matches!(self.state, State::Stopping | State::Ending) {
            cx.emit(EventKind::FixtureStopping { fixture: self.plan.id });
        }
        self.state = State::Ending;
        self.force(cx);
    }

    /// It waits for its next start, which will not come.
    fn forget_restart(&mut self, cx: &mut Context<'_>) {
        self.state = State::Stopped;
        cx.clear(self.timer(FixtureTimer::RestartDue));
    }

    fn force(&mut self, cx: &mut Context<'_>) {
        self.forced = true;
        match self.host {
            Some(host) => {
                cx.out(Effect::KillTree(host));
                cx.set(self.timer(FixtureTimer::Limit), 5 * TERM_GRACE);
            }
            None => self.stopped(cx),
        }
    }

    fn stopped(&mut self, cx: &mut Context<'_>) {
        self.state = State::Stopped;
        self.check = None;
        for timer in [FixtureTimer::Limit, FixtureTimer::Check, FixtureTimer::CheckDue] {
            cx.clear(self.timer(timer));
        }
        let problem = self.problem.take();
        let log_tail = if problem.is_some() { self.log.tail() } else { Vec::new() };
        cx.emit(EventKind::FixtureStopped { fixture: self.plan.id, problem, log_tail });
    }

    /// A deadline about this fixture has passed.
    pub fn deadline(&mut self, timer: FixtureTimer, cx: &mut Context<'_>) -> Option<Change> {
        match (timer, self.state) {
            (FixtureTimer::RestartDue, State::Waiting) => {
                self.start_now(cx);
                None
            }
            (FixtureTimer::CheckDue, State::Ready) => {
                self.ask_check(cx);
                None
            }
            (FixtureTimer::Check, State::Ready) => {
                self.dump_stack(cx);
                let limit = self.plan.limits.check;
                self.unwell(format!("check did not answer within {limit:?}"), cx)
            }
            (FixtureTimer::Limit, State::Starting) => {
                self.dump_stack(cx);
                let limit = self.plan.limits.setup;
                self.unwell(format!("it was not ready within {limit:?}"), cx)
            }
            (FixtureTimer::Limit, State::Stopping | State::Ending) => {
                self.stop_by_force(cx);
                None
            }
            _ => None,
        }
    }

    fn dump_stack(&self, cx: &mut Context<'_>) {
        if let (FixtureBody::Plugin(_), Some(host)) = (&self.plan.body, self.host) {
            cx.out(Effect::TakeStack(host, self.stack));
        }
    }

    /// The tear-down's limit has passed: first SIGTERM, then SIGKILL.
    fn stop_by_force(&mut self, cx: &mut Context<'_>) {
        let limit = match &self.plan.body {
            FixtureBody::Plugin(_) => self.plan.limits.teardown,
            FixtureBody::Process(process) => process.stop_grace,
        };
        self.problem.get_or_insert(format!("it did not stop within {limit:?} and was killed"));
        let terminated_already = match &self.plan.body {
            FixtureBody::Plugin(_) => self.forced,
            FixtureBody::Process(_) => true,
        };
        if terminated_already {
            return self.force(cx);
        }
        self.forced = true;
        self.state = State::Ending;
        if let Some(host) = self.host {
            cx.out(Effect::Signal(host, SIGTERM));
        }
        cx.set(self.timer(FixtureTimer::Limit), TERM_GRACE);
    }
}

fn captures(fixture: FixtureId) -> [Capture; 2] {
    let source = Source::Fixture(fixture);
    [Capture::new(source, Stream::Stdout), Capture::new(source, Stream::Stderr)]
}

fn log_watch(process: &ProcessPlan) -> LogWatch {
    let patterns = |probes: &[crate::plan::Probe]| {
        let pattern = |probe: &crate::plan::Probe| match &probe.kind {
            ProbeKind::Log(pattern) => Some(pattern.clone()),
            _ => None,
        };
        probes.iter().filter_map(pattern).collect()
    };
    LogWatch::new(patterns(&process.ready), patterns(&process.alive))
}

fn problem_of(answer: &Answer) -> Option<String> {
    let default = match answer.outcome {
        Outcome::Passed => return None,
        Outcome::Failed => "it says that it failed",
        Outcome::Error => "it says that it went wrong",
        Outcome::Interrupted => "it was interrupted",
    };
    Some(answer.reason.clone().unwrap_or_else(|| default.to_owned()))
}
