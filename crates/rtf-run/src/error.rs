//! Errors that end the program.

use std::error::Error;
use std::io::{self, Write};
use std::process::ExitCode;

use crate::exit;

/// An error with its exit code and a hint.
#[derive(Debug)]
pub struct Failure {
    code: u8,
    /// `None` if it has been printed.
    error: Option<Box<dyn Error + Send + Sync>>,
    hint: Option<String>,
}

impl Failure {
    /// Bad input: nothing was started.
    pub fn input(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self { code: exit::BAD_INPUT, error: Some(error.into()), hint: None }
    }

    /// `rtf` itself failed.
    pub fn internal(error: impl Into<Box<dyn Error + Send + Sync>>) -> Self {
        Self { code: exit::BROKEN, ..Self::input(error) }
    }

    /// Bad input that has been printed.
    pub fn printed() -> Self {
        Self { code: exit::BAD_INPUT, error: None, hint: None }
    }

    /// Replaces the hint.
    pub fn hint(self, hint: impl Into<String>) -> Self {
        self.maybe_hint(Some(hint))
    }

    /// Replaces the hint if there is a new one.
    pub fn maybe_hint(mut self, hint: Option<impl Into<String>>) -> Self {
        self.hint = hint.map(Into::into).or(self.hint);
        self
    }

    /// The error and its hint on one line.
    pub fn text(&self) -> String {
        let error = self.error.as_ref().map(ToString::to_string).unwrap_or_default();
        match &self.hint {
            Some(hint) => format!("{error} ({hint})"),
            None => error,
        }
    }

    /// Prints the error to standard error and returns the exit code.
    pub fn print(&self) -> ExitCode {
        // Standard error may be closed.
        let _ = self.write(&mut anstream::stderr().lock());
        ExitCode::from(self.code)
    }

    fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let Some(error) = &self.error else { return Ok(()) };
        let (red, bold, reset) = ("\u{1b}[1;31m", "\u{1b}[1m", "\u{1b}[0m");
        writeln!(out, "{red}error{reset}: {error}")?;
        let mut cause = error.source();
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
