//! The progress bar on standard error, and the prompt in its place.

use std::io::Write;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// How often the bar's clock moves while nothing happens.
const TICK: Duration = Duration::from_millis(250);

const TEMPLATE: &str = "{elapsed_precise} [{bar:20}] {pos} of {len} done  {wide_msg}";

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct BarState {
    pub done: u64,
    pub tests: u64,
    /// What the run does now.
    pub message: String,
    /// In place of the bar: where an operator types.
    pub prompt: Option<String>,
    /// Taken away for good.
    pub is_over: bool,
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
