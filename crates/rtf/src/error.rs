//! Errors of the program as a whole, and how they are shown.

use std::io::{self, Write};
use std::process::ExitCode;

use crate::exit;

/// An error that ends the program, with its exit code and a hint.
#[derive(Debug)]
pub struct Failure {
    /// The exit code.
    code: u8,
    /// What went wrong; `None` when the user was told already.
    error: Option<Box<dyn std::error::Error + Send + Sync>>,
    /// What to do about it.
    hint: Option<String>,
}

impl Failure {
    /// Bad input: nothing was started.
    pub fn input(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self { code: exit::BAD_INPUT, error: Some(error.into()), hint: None }
    }

    /// `rtf` could not do its own work.
    pub fn own(error: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        Self { code: exit::BROKEN, ..Self::input(error) }
    }

    /// Ends the program with a code; the user was told why.
    pub fn told(code: u8) -> Self {
        Self { code, error: None, hint: None }
    }

    /// For what is written to standard output or standard error: a reader that
    /// has gone (`| head`) has seen enough, which is no failure.
    pub fn unless_reader_left(written: io::Result<()>) -> Result<(), Self> {
        match written {
            Err(error) if rtf_report::is_disconnect(&error) => Ok(()),
            written => written.map_err(Self::own),
        }
    }

    /// Says what to do about it.
    pub fn hint(mut self, hint: impl Into<Option<String>>) -> Self {
        self.hint = hint.into();
        self
    }

    /// Prints it to standard error; returns the exit code.
    pub fn show(&self) -> ExitCode {
        let mut err = anstream::stderr().lock();
        // Nothing is left to tell it to when standard error is closed.
        let _ = self.write(&mut err);
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
