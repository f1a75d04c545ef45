//! The host: runs a test when the runner asks for it.

use rtf_host::{HostPlugin, LoadError, PluginKind, Reaction, Session, Step, StepEnd};
use rtf_model::protocol::{Initialize, Initialized, PROTOCOL_VERSION, Plugin, StackSupport};
use rustix::process::Signal;

use crate::framework::Framework;
use crate::supervisor::{self, RunningProgram};

/// Runs tests of one framework.
pub struct FrameworkHost {
    name: &'static str,
    framework: Box<dyn Framework + Send + Sync>,
    session: Session,
    running: RunningProgram,
    /// For files of the program; removed with the host.
    scratch: tempfile::TempDir,
    plugin: Plugin,
}

impl FrameworkHost {
    /// A host for this framework.
    ///
    /// # Errors
    /// There is no directory for temporary files.
    pub fn new(
        name: &'static str,
        framework: Box<dyn Framework + Send + Sync>,
        session: Session,
    ) -> std::io::Result<Self> {
        let (running, plugin) = (RunningProgram::default(), Plugin::default());
        let scratch = tempfile::Builder::new().prefix("rtf-").tempdir()?;
        Ok(Self { name, framework, session, running, scratch, plugin })
    }
}

impl HostPlugin for FrameworkHost {
    fn describe(&self) -> Initialized {
        Initialized {
            protocol: PROTOCOL_VERSION,
            host: format!("{} {}", self.name, env!("CARGO_PKG_VERSION")),
            stack: StackSupport::Message,
            supports_shared: false,
            selects_cases: true,
        }
    }

    fn prepare(&mut self, _initialize: &Initialize) {}

    fn load(&mut self, kind: PluginKind, plugin: &Plugin) -> Result<(), LoadError> {
        if kind == PluginKind::Fixture {
            let message = format!("a program of `{}` is a test, not a fixture", self.name);
            return Err(LoadError { message, location: None });
        }
        self.plugin = plugin.clone();
        Ok(())
    }

    fn step(&mut self, step: Step) -> StepEnd {
        if step == Step::Run {
            let (session, running) = (&self.session, &self.running);
            let scratch = self.scratch.path();
            supervisor::run(&*self.framework, &self.plugin, session, running, scratch);
        }
        StepEnd::Done
    }

    fn stack_dumper(&self) -> Option<Reaction> {
        let (running, kind) = (self.running.clone(), self.framework.stack_dump());
        let file = self.scratch.path().join("stacks");
        Some(Box::new(move |session| {
            if let Some(text) = supervisor::dump_stack(&running, kind, &file) {
                session.stack(text);
            }
        }))
    }

    fn stopper(&self) -> Option<Reaction> {
        let running = self.running.clone();
        Some(Box::new(move |_| running.signal(Signal::TERM)))
    }
}
