//! The progress bar, on standard error when that is a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rtf_model::{Event, EventKind, Record, TestId};

use crate::escape;

/// How often the bar's clock moves while nothing happens.
const TICK: Duration = Duration::from_millis(250);

const TEMPLATE: &str = "{elapsed_precise} [{bar:20}] {pos} of {len} done  {wide_msg}";

/// How far the run is, and what it does now.
#[derive(Debug)]
pub(super) struct Progress {
    bar: ProgressBar,
    done: u64,
    /// The tests that run, in the order in which they began.
    running: Vec<TestId>,
    /// Nothing is shown before the number of tests is known.
    begun: bool,
}

impl Progress {
    /// A bar on standard error; none when that is no terminal, or when a
    /// machine watches (`CI` is set).
    pub fn on_terminal() -> Self {
        if std::env::var_os("CI").is_some_and(|value| !value.is_empty()) {
            return Self::hidden();
        }
        let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
            bar.set_style(style.progress_chars("=> "));
        }
        Self { bar, done: 0, running: Vec::new(), begun: false }
    }

    /// No bar.
    pub fn hidden() -> Self {
        Self { bar: ProgressBar::hidden(), done: 0, running: Vec::new(), begun: false }
    }

    /// Moves on.
    pub fn event(&mut self, event: &Event, record: &Record) {
        if self.bar.is_hidden() {
            return;
        }
        match &event.kind {
            EventKind::TestStarted { test, .. } => {
                self.running.push(*test);
                self.tests(record);
            }
            EventKind::FixtureStarting { fixture, .. } => self.fixture(record, *fixture, "set up"),
            EventKind::FixtureStopping { fixture } => self.fixture(record, *fixture, "tear down"),
            EventKind::HookStarted { hook, .. } => {
                let name = record.full_hook_name(*hook);
                self.bar.set_message(format!("hook {}", escape::line(&name)));
            }
            EventKind::SuiteStarted { .. } if !self.begun => {
                self.begun = true;
                self.bar.set_length(record.tests.len() as u64);
                self.bar.enable_steady_tick(TICK);
            }
            EventKind::TestFinished(finished) => {
                self.running.retain(|test| *test != finished.test);
                if !self.running.is_empty() {
                    self.tests(record);
                }
                if record.verdict(finished.test).is_some() {
                    self.step();
                }
            }
            EventKind::TestSkipped { .. } | EventKind::TestRepeated { .. } => self.step(),
            _ => {}
        }
    }

    /// Says which tests run: more than fit are cut off by the terminal's width.
    fn tests(&self, record: &Record) {
        let names: Vec<_> = self.running.iter().map(|test| record.full_name(*test)).collect();
        self.bar.set_message(escape::line(&names.join(", ")).into_owned());
    }

    fn fixture(&self, record: &Record, id: rtf_model::FixtureId, what: &str) {
        let name = record.fixture_name(id);
        self.bar.set_message(format!("{what} fixture {}", escape::line(&name)));
    }

    fn step(&mut self) {
        self.done += 1;
        self.bar.set_position(self.done);
    }

    /// Takes the bar away while `write` writes to the same terminal.
    pub fn around<T>(&self, write: impl FnOnce() -> T) -> T {
        if self.begun { self.bar.suspend(write) } else { write() }
    }

    /// Takes the bar away for good.
    pub fn end(&self) {
        if self.begun {
            self.bar.finish_and_clear();
        }
    }
}
