//! How far the run is, as the progress bar shows it.

use indicatif::ProgressDrawTarget;
use rtf_model::{Event, EventKind, Record, TestId};

use crate::escape;
use crate::progress_bar::BarState;

/// How far the run is, and what it does now.
#[derive(Debug)]
pub(super) struct Progress {
    is_shown: bool,
    state: BarState,
    /// The tests that run, in the order in which they began.
    running: Vec<TestId>,
    /// Nothing is shown before the number of tests is known.
    begun: bool,
}

impl Progress {
    /// A bar on standard error; none when that is no terminal, or when a
    /// machine watches (`CI` is set).
    pub fn on_terminal() -> Self {
        let is_watched_by_machine = std::env::var_os("CI").is_some_and(|value| !value.is_empty());
        Self {
            is_shown: !is_watched_by_machine && !ProgressDrawTarget::stderr().is_hidden(),
            ..Self::hidden()
        }
    }

    pub fn hidden() -> Self {
        let (state, running) = (BarState::default(), Vec::new());
        Self { is_shown: false, state, running, begun: false }
    }

    /// Moves on; what is shown now, if that is something else.
    pub fn event(&mut self, event: &Event, record: &Record) -> Option<BarState> {
        if !self.is_shown {
            return None;
        }
        let before = self.state.clone();
        self.take(event, record);
        Some(&self.state).filter(|state| self.begun && **state != before).cloned()
    }

    /// Shows a prompt in place of the bar, or the bar again.
    pub fn set_prompt(&mut self, prompt: Option<String>) -> BarState {
        self.state.prompt = prompt;
        self.state.clone()
    }

    fn take(&mut self, event: &Event, record: &Record) {
        match &event.kind {
            EventKind::TestStarted { test, .. } => {
                self.running.push(*test);
                self.tests(record);
            }
            EventKind::FixtureStarting { fixture, .. } => self.fixture(record, *fixture, "set up"),
            EventKind::FixtureStopping { fixture } => self.fixture(record, *fixture, "tear down"),
            EventKind::HookStarted { hook, .. } => {
                let name = record.full_hook_name(*hook);
                self.state.message = format!("hook {}", escape::line(&name));
            }
            EventKind::SuiteStarted { .. } if !self.begun => {
                self.begun = true;
                self.state.tests = record.tests.len() as u64;
            }
            EventKind::TestFinished(finished) => {
                self.running.retain(|test| *test != finished.test);
                if !self.running.is_empty() {
                    self.tests(record);
                }
                if record.verdict(finished.test).is_some() {
                    self.state.done += 1;
                }
            }
            EventKind::TestSkipped { .. } | EventKind::TestRepeated { .. } => self.state.done += 1,
            _ => {}
        }
    }

    /// Says which tests run: more than fit are cut off by the terminal's width.
    fn tests(&mut self, record: &Record) {
        let names: Vec<_> = self.running.iter().map(|test| record.full_name(*test)).collect();
        self.state.message = escape::line(&names.join(", ")).into_owned();
    }

    fn fixture(&mut self, record: &Record, id: rtf_model::FixtureId, what: &str) {
        let name = record.fixture_name(id);
        self.state.message = format!("{what} fixture {}", escape::line(&name));
    }

    /// Takes the bar away for good.
    pub fn end(&mut self) -> Option<BarState> {
        self.begun.then(|| BarState { is_over: true, ..BarState::default() })
    }
}
