//! Carries out the runner's requests in order.

use rtf_model::protocol::{
    Initialize, PROTOCOL_VERSION, Plugin, Request, RpcError, TestReportedParams, VERSION_MISMATCH,
};
use rtf_model::{Outcome, Parameter, Phase};
use rustix::process::Pid;

use crate::decode::{INVALID_REQUEST, Incoming};
use crate::reader::Reader;
use crate::shared_host::SharedHost;
use crate::yarp::YarpNetwork;
use crate::{HostPlugin, PluginKind, Session, Step, StepEnd, TestNotification, unix};

/// Serves the runner until its last answer or the end of the channel. The caller then
/// ends the process with `exit`, so that the plug-in's exit handlers run.
///
/// While a plug-in is loaded, the end of the channel ends the process at once.
///
/// # Errors
/// The thread that reads the channel cannot be started.
pub fn serve(session: &Session, host: impl HostPlugin) -> std::io::Result<()> {
    let reader = Reader::new(session, &host);
    let process = rustix::process::getpid();
    let mut server = RequestLoop {
        session,
        host,
        process,
        initialized: false,
        loaded: None,
        shared: None,
        yarp: None,
    };
    let Some((reader, first)) = server.before_plugins(reader) else {
        return Ok(());
    };
    reader.spawn()?;
    let mut is_last = server.handle(first);
    while !is_last {
        if server.shared.is_some() {
            // At the same time, the runner evaluates the last test.
            server.host.idle();
        }
        let Some(incoming) = session.next() else { break };
        is_last = server.handle(incoming);
    }
    Ok(())
}

struct RequestLoop<'a, H> {
    session: &'a Session,
    host: H,
    /// The process that serves the runner: a plug-in may fork.
    process: Pid,
    initialized: bool,
    loaded: Option<PluginKind>,
    /// Set by the first test that may share the host with the next one.
    shared: Option<SharedHost>,
    /// The network of the loaded plug-in, if it uses YARP and does not make one.
    yarp: Option<YarpNetwork>,
}

impl<H: HostPlugin> RequestLoop<'_, H> {
    /// Carries out requests that need no plug-in, on this thread alone. Returns the first
    /// one that does, and the reader for a second thread.
    fn before_plugins(&mut self, mut reader: Reader) -> Option<(Reader, Incoming)> {
        loop {
            let incoming = reader.next()?;
            self.session.begin(&incoming);
            if self.initialized && matches!(incoming, Incoming::Request { .. }) {
                return Some((reader, incoming));
            }
            self.handle(incoming);
            if self.initialized && reader.is_drained() {
                self.host.idle();
            }
        }
    }

    /// Handles a line; true if it was the last request.
    fn handle(&mut self, incoming: Incoming) -> bool {
        match incoming {
            Incoming::Refused { id, error } => {
                self.session.end_without_plugin();
                self.session.refuse(id, error);
                false
            }
            Incoming::Request { id, request } => match *request {
                Request::TestReported(reported) => {
                    self.pass_on(reported);
                    false
                }
                request => self.carry_out(id, request),
            },
        }
    }

    /// Passes a report of a running test to the fixture.
    fn pass_on(&mut self, reported: TestReportedParams) {
        self.session.end_without_plugin();
        if self.loaded == Some(PluginKind::Fixture) {
            self.host.reported(reported);
        }
    }

    /// Carries out a request; true if it was the last one.
    fn carry_out(&mut self, id: Option<u64>, request: Request) -> bool {
        if let Request::Initialize(initialize) = request {
            self.session.end_without_plugin();
            self.initialize(id, &initialize);
            return false;
        }
        if !self.initialized {
            self.session.end_without_plugin();
            let message = "the first request must be `initialize`".to_owned();
            self.session.refuse(id, RpcError { code: INVALID_REQUEST, message });
            return false;
        }
        let (mut last, mut end_marker, mut after_failure) = (false, None, false);
        let sets_up = matches!(request, Request::SetUpFixture(_));
        match request {
            Request::RunTest(plugin) => {
                (last, after_failure) = (plugin.is_last, plugin.continues_after_failure);
                if plugin.end_marker.is_some() {
                    self.begin_shared(&plugin.variables);
                }
                self.run_test(&plugin);
                end_marker = plugin.end_marker;
            }
            Request::SetUpFixture(plugin) => self.set_up_fixture(&plugin),
            Request::CheckFixture {} => self.check_fixture(),
            Request::TestStarted(starts) => self.notify(TestNotification::Started(&starts)),
            Request::TestEnded(ends) => self.notify(TestNotification::Ended(&ends)),
            Request::TestFinished(ends) => {
                self.session.set_attachments_dir(ends.attachments_dir.as_deref());
                self.notify(TestNotification::Finished(&ends));
                self.session.set_attachments_dir(None);
            }
            Request::TearDownFixture {} => self.tear_down_fixture(),
            // Handled by the reader.
            Request::Initialize(_)
            | Request::TestReported(_)
            | Request::Interrupt { .. }
            | Request::QuestionClosed(_)
            | Request::Episodes { .. }
            | Request::EndOfEpisodes {}
            | Request::DumpStack {} => {}
        }
        // The runner may close the channel as soon as it has the answer. That ends the
        // process at once only if a fixture is still set up.
        self.session.set_has_plugin(self.loaded.is_some());
        let mut answer = self.session.conclude();
        if sets_up && answer.outcome == Outcome::Passed {
            answer.subscriptions = self.host.subscriptions();
        }
        if let (Some(marker), false) = (end_marker, last) {
            let may_continue = match answer.outcome {
                Outcome::Passed => true,
                Outcome::Failed | Outcome::Skipped => after_failure,
                _ => false,
            };
            answer.continues =
                may_continue && self.shared.as_ref().is_some_and(|shared| shared.end_test(&marker));
            last = !answer.continues;
        }
        self.session.answer(id, answer);
        last
    }

    /// From now on, everything that the host sends belongs to this test.
    fn begin_shared(&mut self, variables: &[Parameter]) {
        if self.shared.is_none() {
            // Without it, the host ends after the test.
            self.shared = SharedHost::begin().ok();
        }
        variables.iter().for_each(|variable| unix::set_variable(&variable.name, &variable.value));
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

    fn run_test(&mut self, plugin: &Plugin) {
        self.session.set_attachments_dir(plugin.attachments_dir.as_deref());
        if !self.load(PluginKind::Test, plugin) {
            return;
        }
        self.session.begin_attempt(&plugin.cases, plugin.episodes);
        self.session.phase(Phase::Setup);
        self.step(Step::Setup);
        if self.session.has_passed() {
            self.session.phase(Phase::Run);
            if self.step(Step::Run) {
                self.session.require_all_episodes();
            }
        }
        self.session.phase(Phase::TearDown);
        self.tear_down();
    }

    fn set_up_fixture(&mut self, plugin: &Plugin) {
        if self.load(PluginKind::Fixture, plugin) {
            self.step(Step::Setup);
        }
    }

    fn check_fixture(&mut self) {
        if self.has_fixture() {
            self.step(Step::Check);
        }
    }

    fn notify(&mut self, notification: TestNotification<'_>) {
        if self.has_fixture() {
            let end = self.host.notify(notification);
            self.record_end(end, notification.name(), Outcome::Failed);
        }
    }

    fn has_fixture(&self) -> bool {
        if self.loaded.is_none() {
            self.session.record(Outcome::Error, "no fixture is set up");
        }
        self.loaded.is_some()
    }

    /// A fixture that could not be loaded is not torn down.
    fn tear_down_fixture(&mut self) {
        if self.loaded.is_some() {
            self.tear_down();
        }
    }

    fn load(&mut self, kind: PluginKind, plugin: &Plugin) -> bool {
        if self.loaded.is_some() {
            self.session.record(Outcome::Error, "a fixture is still set up in this host");
            return false;
        }
        self.session.set_has_plugin(true);
        let loaded = self.host.load(kind, plugin);
        self.end_forked_child();
        match loaded {
            Ok(()) => {
                self.loaded = Some(kind);
                self.yarp = YarpNetwork::init();
                true
            }
            Err(error) => {
                self.session.error(error.message, error.location);
                false
            }
        }
    }

    fn tear_down(&mut self) {
        self.session.clear_stop();
        self.step(Step::TearDown);
        let end = self.host.unload();
        self.record_end(end, "unloading", Outcome::Error);
        if let Some(yarp) = self.yarp.take() {
            yarp.finish();
        }
        self.loaded = None;
    }

    /// Calls a function of the plug-in. Returns whether it returned, as it should.
    fn step(&mut self, step: Step) -> bool {
        let refused = match step {
            Step::Setup | Step::TearDown => Outcome::Error,
            Step::Run | Step::Check => Outcome::Failed,
        };
        let end = self.host.step(step);
        let is_done = end == StepEnd::Done;
        self.record_end(end, step.name(), refused);
        is_done
    }

    fn record_end(&self, end: StepEnd, step: &str, refused: Outcome) {
        self.end_forked_child();
        match end {
            StepEnd::Done => {}
            StepEnd::Refused => self.session.record(refused, &format!("{step} returned false")),
            StepEnd::Stopped => {
                self.session.record_stopped(&format!("{step} stopped without a reason"));
            }
            StepEnd::Broken(text, location) => self.session.error(text, location),
        }
    }

    /// Ends a child that the plug-in forked and that returned from the plug-in's function:
    /// the parent serves the runner.
    fn end_forked_child(&self) {
        if rustix::process::getpid() != self.process {
            unix::flush_output();
            self.session.flush();
            unix::exit_now(0);
        }
    }
}
