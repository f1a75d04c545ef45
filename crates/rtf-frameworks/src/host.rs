//! The host: runs a test when the runner asks for it.

use std::path::Path;
use std::sync::{Arc, OnceLock};

use rtf_host::{HostPlugin, LoadError, PluginKind, Reaction, Session, Step, StepEnd};
use rtf_model::protocol::{Initialize, Initialized, PROTOCOL_VERSION, Plugin, StackSupport};
use rustix::process::Signal;
use tempfile::TempDir;

use crate::framework::Framework;
use crate::supervisor::{self, RunningProgram};

/// Runs tests of one framework.
pub struct FrameworkHost {
    name: &'static str,
    framework: Box<dyn Framework + Send + Sync>,
    session: Session,
    running: RunningProgram,
    /// For files of the program; known when the runner has initialized the host.
    scratch: Arc<OnceLock<TempDir>>,
    plugin: Plugin,
}

impl FrameworkHost {
    #[must_use]
    pub fn new(
        name: &'static str,
        framework: Box<dyn Framework + Send + Sync>,
        session: Session,
        running: RunningProgram,
    ) -> Self {
        let (scratch, plugin) = (Arc::default(), Plugin::default());
        Self { name, framework, session, running, scratch, plugin }
    }
}

/// Creates a directory for temporary files next to the file for stack dumps. The runner, or
/// its guard, removes it with the other files of the run, also if this process is killed.
fn create_scratch(initialize: &Initialize) -> std::io::Result<TempDir> {
    let stack_file = initialize.stack_file.as_deref().map(Path::new);
    let mut builder = tempfile::Builder::new();
    builder.prefix("rtf-");
    match stack_file.and_then(Path::parent) {
        Some(dir) => builder.tempdir_in(dir),
        None => builder.tempdir(),
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
            runs_episodes: false,
        }
    }

    fn prepare(&mut self, initialize: &Initialize) {
        // `step` reports an error.
        if let Ok(scratch) = create_scratch(initialize) {
            // Only the first directory counts, and there is only this one.
            let _ = tempfile::env::override_temp_dir(scratch.path());
            let _ = self.scratch.set(scratch);
        }
    }

    fn load(&mut self, kind: PluginKind, plugin: &Plugin) -> Result<(), LoadError> {
        if kind == PluginKind::Fixture {
            let message = format!("a program of `{}` is a test, not a fixture", self.name);
            return Err(LoadError { message, location: None });
        }
        self.plugin = plugin.clone();
        Ok(())
    }

    fn step(&mut self, step: Step) -> StepEnd {
        if step != Step::Run {
            return StepEnd::Done;
        }
        let Some(scratch) = self.scratch.get() else {
            let text = "no directory for temporary files can be created";
            return StepEnd::Broken(text.to_owned(), None);
        };
        let (session, running) = (&self.session, &self.running);
        supervisor::run(&*self.framework, &self.plugin, session, running, scratch.path());
        StepEnd::Done
    }

    fn stack_dumper(&self) -> Option<Reaction> {
        let (running, kind) = (self.running.clone(), self.framework.stack_dump());
        let scratch = Arc::clone(&self.scratch);
        Some(Box::new(move |session| {
            let file = scratch.get().map(|scratch| scratch.path().join("stacks"));
            let dump = file.and_then(|file| supervisor::dump_stack(&running, kind, &file));
            if let Some(text) = dump {
                session.stack(text);
            }
        }))
    }

    fn stopper(&self) -> Option<Reaction> {
        let running = self.running.clone();
        Some(Box::new(move |_| running.signal(Signal::TERM)))
    }
}
