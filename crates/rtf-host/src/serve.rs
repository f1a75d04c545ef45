//! The host's work: one request after the other, in order.

use rtf_model::protocol::{
    Answer, Initialize, PROTOCOL_VERSION, Plugin, Request, RpcError, VERSION_MISMATCH,
};
use rtf_model::{Message, MessageKind, Outcome, Phase};
use rustix::process::Pid;

use crate::decode::{INVALID_REQUEST, Incoming};
use crate::reader::Reader;
use crate::sharing::Sharing;
use crate::{HostPlugin, Role, Session, Step, StepEnd, Told, unix};

/// Serves the runner until it has got its last answer or has closed the
/// channel. The caller then ends the process the ordinary way, so that what
/// the plug-in left for the end of the process is done.
///
/// While a plug-in is loaded, the end of the channel ends the process at once.
///
/// # Errors
/// The thread that reads the channel cannot be started.
pub fn serve(session: &Session, host: impl HostPlugin) -> std::io::Result<()> {
    let reader = Reader::new(session, host.stack_dumper(), host.stopper());
    let process = rustix::process::getpid();
    let mut server =
        Server { session, host, process, initialized: false, loaded: None, sharing: None };
    let Some((reader, first)) = server.before_plugins(reader) else {
        return Ok(());
    };
    reader.spawn()?;
    let mut incoming = Some(first);
    while let Some(next) = incoming {
        if server.take(next) {
            break;
        }
        incoming = session.next();
    }
    Ok(())
}

struct Server<'a, H> {
    session: &'a Session,
    host: H,
    /// The process that serves: a plug-in may fork.
    process: Pid,
    initialized: bool,
    loaded: Option<Role>,
    /// Once a test came that may leave the host to the next one.
    sharing: Option<Sharing>,
}

impl<H: HostPlugin> Server<'_, H> {
    /// Serves, on this thread alone, what needs no plug-in. Gives back the first
    /// request that does, and the reader that is to go on beside it.
    fn before_plugins(&mut self, mut reader: Reader) -> Option<(Reader, Incoming)> {
        loop {
            let incoming = reader.next()?;
            self.session.begin(&incoming);
            if self.initialized && matches!(incoming, Incoming::Request { .. }) {
                return Some((reader, incoming));
            }
            self.take(incoming);
            if self.initialized && reader.is_drained() {
                self.host.idle();
            }
        }
    }

    /// Deals with what came in; true when it was the last request.
    fn take(&mut self, incoming: Incoming) -> bool {
        match incoming {
            Incoming::Refused { id, error } => {
                self.session.pass();
                self.session.refuse(id, error);
                false
            }
            Incoming::Request { id, request } => self.carry_out(id, request),
        }
    }

    /// Carries out a request; true when it was the last one.
    fn carry_out(&mut self, id: Option<u64>, request: Request) -> bool {
        if let Request::Initialize(initialize) = request {
            self.session.pass();
            self.initialize(id, &initialize);
            return false;
        }
        if !self.initialized {
            self.session.pass();
            let message = "the first request must be `initialize`".to_owned();
            self.session.refuse(id, RpcError { code: INVALID_REQUEST, message });
            return false;
        }
        let (mut last, mut shared) = (false, None);
        let sets_up = matches!(request, Request::SetUpFixture(_));
        match request {
            Request::RunTest(plugin) => {
                last = plugin.is_last;
                if plugin.end_marker.is_some() {
                    self.begin_shared();
                }
                self.run_test(&plugin);
                shared = plugin.end_marker;
            }
            Request::SetUpFixture(plugin) => self.set_up_fixture(&plugin),
            Request::CheckFixture {} => self.check_fixture(),
            Request::TestStarted(starts) => self.tell(Told::Starts(&starts)),
            Request::TestFinished(ends) => {
                self.session.keep_in(ends.attachments_dir.as_ref().map(Into::into));
                self.tell(Told::Ends(&ends));
                self.session.keep_in(None);
            }
            Request::TearDownFixture {} => self.tear_down_fixture(),
            // Heard by the thread that reads the channel, and by nobody else.
            Request::Initialize(_) | Request::Interrupt { .. } | Request::DumpStack {} => {}
        }
        // The answer may make the runner close the channel at once. Only a
        // fixture that is still up makes that a reason to end the hard way.
        self.session.engage(self.loaded.is_some());
        let mut answer = self.session.conclude();
        if sets_up && answer.outcome == Outcome::Passed {
            answer.subscriptions = self.host.subscriptions();
        }
        if let (Some(mark), false) = (shared, last) {
            let passed = answer.outcome == Outcome::Passed;
            answer.continues = passed && self.sharing.as_ref().is_some_and(|ours| ours.stay(&mark));
            last = !answer.continues;
        }
        self.answer(id, answer);
        last
    }

    /// Whatever comes from now on belongs to this test.
    fn begin_shared(&mut self) {
        if self.sharing.is_none() {
            // Without it, the host ends after the test.
            self.sharing = Sharing::begin().ok();
        }
        self.session.phase(Phase::Load);
    }

    fn initialize(&mut self, id: Option<u64>, initialize: &Initialize) {
        if initialize.protocol != PROTOCOL_VERSION {
            let message = format!(
                "rtf {} speaks version {} of the host protocol, this host version {PROTOCOL_VERSION}",
                initialize.rtf, initialize.protocol
            );
            self.session.refuse(id, RpcError { code: VERSION_MISMATCH, message });
            return;
        }
        self.host.prepare(initialize);
        self.initialized = true;
        self.session.answer(id, self.host.describe());
    }

    /// Sends the answer. A reason that does not fit on a line was sent as a
    /// message before; what is left here names it.
    fn answer(&self, id: Option<u64>, answer: Answer) {
        if !self.session.answer(id, &answer) {
            let reason = answer.reason.map(|reason| reason.chars().take(10_000).collect());
            self.session.answer(id, Answer { reason, ..answer });
        }
    }

    fn run_test(&mut self, plugin: &Plugin) {
        self.session.keep_in(plugin.attachments_dir.as_ref().map(Into::into));
        if !self.load(Role::Test, plugin) {
            return;
        }
        self.session.phase(Phase::Setup);
        self.step(Step::Setup, true);
        if self.session.judge(|judge| judge.all_holds()) {
            self.session.phase(Phase::Run);
            self.step(Step::Run, false);
        }
        self.session.phase(Phase::TearDown);
        self.tear_down();
    }

    fn set_up_fixture(&mut self, plugin: &Plugin) {
        if self.load(Role::Fixture, plugin) {
            self.step(Step::Setup, true);
        }
    }

    fn check_fixture(&mut self) {
        if self.has_fixture() {
            self.step(Step::Check, false);
        }
    }

    fn tell(&mut self, told: Told<'_>) {
        if self.has_fixture() {
            self.session.judge(|judge| judge.failures_are_errors = false);
            let end = self.host.tell(told);
            self.judge_end(end, told.name());
        }
    }

    fn has_fixture(&self) -> bool {
        if self.loaded.is_none() {
            self.session.judge(|judge| judge.note(Outcome::Error, "no fixture is set up"));
        }
        self.loaded.is_some()
    }

    /// A fixture that could not be loaded has nothing to tear down.
    fn tear_down_fixture(&mut self) {
        if self.loaded.is_some() {
            self.tear_down();
        }
    }

    fn load(&mut self, role: Role, plugin: &Plugin) -> bool {
        if self.loaded.is_some() {
            let reason = "a fixture is still set up in this host";
            self.session.judge(|judge| judge.note(Outcome::Error, reason));
            return false;
        }
        self.session.engage(true);
        let loaded = self.host.load(role, plugin);
        unix::end_forked_child(self.process);
        match loaded {
            Ok(()) => {
                self.loaded = Some(role);
                true
            }
            Err(error) => {
                self.error(error.message, error.location);
                false
            }
        }
    }

    fn tear_down(&mut self) {
        self.session.clear_stop();
        self.step(Step::TearDown, true);
        let end = self.host.unload();
        self.judge_end(end, "unloading");
        self.loaded = None;
    }

    fn step(&mut self, step: Step, failures_are_errors: bool) {
        self.session.judge(|judge| judge.failures_are_errors = failures_are_errors);
        let end = self.host.step(step);
        self.judge_end(end, name(step));
    }

    fn judge_end(&self, end: StepEnd, what: &str) {
        unix::end_forked_child(self.process);
        match end {
            StepEnd::Done => {}
            StepEnd::Refused => {
                self.session.judge(|judge| judge.note_failure(&format!("{what} returned false")));
            }
            // Whatever stopped it was reported; a host that forgot must not pass.
            StepEnd::Stopped => self.session.judge(|judge| {
                judge.note(Outcome::Error, &format!("{what} stopped without a reason"));
            }),
            StepEnd::Broken(text, location) => self.error(text, location),
        }
    }

    fn error(&self, text: String, location: Option<rtf_model::Location>) {
        let kind = MessageKind::Error;
        self.session.message(Message { kind, text, location, comparison: None, critical: false });
    }
}

/// The function's name, as plug-ins spell it.
fn name(step: Step) -> &'static str {
    match step {
        Step::Setup => "setup",
        Step::Run => "run",
        Step::Check => "check",
        Step::TearDown => "tearDown",
    }
}
