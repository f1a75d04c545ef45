//! The progress bar, on standard error when that is a terminal.

use std::io::Write;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use rtf_model::{Event, EventKind, Record, TestId};

use crate::escape;

/// How often the bar's clock moves while nothing happens.
const TICK: Duration = Duration::from_millis(250);

const TEMPLATE: &str = "{elapsed_precise} [{bar:20}] {pos} of {len} done  {wide_msg}";

/// What the bar shows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct BarState {
    done: u64,
    tests: u64,
    message: String,
    /// In place of the bar: where an operator types.
    prompt: Option<String>,
    /// Taken away for good.
    is_over: bool,
}

/// The bar itself. It may wait for the terminal.
#[derive(Debug)]
pub(crate) struct Bar {
    bar: Option<ProgressBar>,
    prompt: Option<String>,
}

/// Moves the cursor to the start of its line, and erases the line.
const ERASE_LINE: &str = "\r\x1b[K";

impl Bar {
    /// No bar, until one is shown.
    pub fn hidden() -> Self {
        Self { bar: None, prompt: None }
    }

    /// Shows it.
    pub fn show(&mut self, state: &BarState) {
        self.show_prompt(state.prompt.as_deref());
        if state.is_over || self.prompt.is_some() {
            self.bar.take().into_iter().for_each(|bar| bar.finish_and_clear());
            return;
        }
        let bar = self.bar.get_or_insert_with(|| {
            let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
            if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
                bar.set_style(style.progress_chars("=> "));
            }
            bar.enable_steady_tick(TICK);
            bar
        });
        bar.set_length(state.tests);
        bar.set_message(state.message.clone());
        bar.set_position(state.done);
    }

    /// Shows or removes the prompt. What was typed stays.
    fn show_prompt(&mut self, prompt: Option<&str>) {
        if self.prompt.as_deref() == prompt {
            return;
        }
        self.prompt = prompt.map(str::to_owned);
        self.bar.take().into_iter().for_each(|bar| bar.finish_and_clear());
        erase_line();
        prompt.into_iter().for_each(print_prompt);
    }

    /// Takes the bar or the prompt away while `write` writes to the same terminal.
    pub fn around<T>(&self, write: impl FnOnce() -> T) -> T {
        if let Some(prompt) = &self.prompt {
            erase_line();
            let written = write();
            print_prompt(prompt);
            return written;
        }
        match &self.bar {
            Some(bar) => bar.suspend(write),
            None => write(),
        }
    }
}

// Standard error is a terminal if there is a prompt. One that is gone shows nothing.

fn erase_line() {
    // Not a colour, which `NO_COLOR` removes.
    let mut err = std::io::stderr().lock();
    let _ = err.write_all(ERASE_LINE.as_bytes()).and_then(|()| err.flush());
}

fn print_prompt(text: &str) {
    let mut err = anstream::stderr().lock();
    let _ = err.write_all(text.as_bytes()).and_then(|()| err.flush());
}

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

    /// No bar.
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
