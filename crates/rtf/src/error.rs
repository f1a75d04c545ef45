//! Errors of the program as a whole, and how they are shown.

use std::io::Write;
use std::process::ExitCode;

use crate::exit;

/// An error that ends the program, with its exit code and a hint.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    pub code: u8,
    /// What went wrong.
    pub error: Box<dyn std::error::Error + Send + Sync>,
    /// What to do about it.
    pub hint: Option<String>,
}

impl Failure {
    /// Bad input: nothing was started.
    pub fn input(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self { code: exit::BAD_INPUT, error: error.into(), hint: None }
    }

    /// `rtf` could not do its own work.
    pub fn own(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self { code: exit::BROKEN, ..Self::input(error) }
    }

    /// Says what to do about it.
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Prints it to standard error; returns the exit code.
    pub fn show(&self) -> ExitCode {
        let mut err = anstream::stderr().lock();
        // Nothing is left to tell it to when standard error is closed.
        let _ = self.write(&mut err);
        ExitCode::from(self.code)
    }

    fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        let (red, bold, reset) = ("\u{1b}[1;31m", "\u{1b}[1m", "\u{1b}[0m");
        writeln!(out, "{red}error{reset}: {}", self.error)?;
        let mut cause = self.error.source();
        while let Some(error) = cause {
            writeln!(out, "{bold}caused by{reset}: {error}")?;
            cause = error.source();
        }
        match &self.hint {
            Some(hint) => writeln!(out, "{bold}hint{reset}: {hint}"),
            None => Ok(()),
        }
    }
}
