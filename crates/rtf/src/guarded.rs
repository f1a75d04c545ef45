//! A run under a guard: what the process does that the user started.
//!
//! The runner is its child. This module tells what the guard had to do.

use std::io::{self, Write};
use std::os::fd::{AsFd, OwnedFd};
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use rtf_engine::guard::{self, GuardOutcome, Link, Recovery, Side};
use rtf_model::{LeakedProcess, Record};
use rtf_report::{Reporter, journal};

use crate::cli::RunArgs;
use crate::command::{self, Outcome, output};
use crate::error::Failure;
use crate::exit;

/// Runs.
pub fn run(args: &RunArgs) -> Outcome {
    let run = |link| command::run::run(args, link);
    let close = |journal: &Path, record: &Record| {
        for (format, path) in &args.reports {
            finish(output::open_report(*format, path, journal.parent()), record);
        }
        let closed = output::close(args, journal, record);
        if let Err(failure) = Failure::unless_reader_left(closed) {
            let _ = failure.show();
        }
    };
    let lifeline = args.end_with_stdin.then(|| std::io::stdin().as_fd().try_clone_to_owned());
    let lifeline = lifeline.transpose().map_err(Failure::own)?;
    let patience = args.shutdown_timeout;
    Guarded { run, close: &close, kept: true, lifeline, patience }.watch()
}

/// What runs under a guard.
pub struct Guarded<'a, R> {
    /// Runs, in the runner's process.
    pub run: R,
    /// What the runner would have written at its end, from the journal; in the
    /// guard's process.
    pub close: &'a dyn Fn(&Path, &Record),
    /// Whether the journal is still there when the guard has ended.
    pub kept: bool,
    /// The run is asked to end when this does.
    pub lifeline: Option<OwnedFd>,
    /// How long the runner may not answer.
    pub patience: Duration,
}

impl<R: FnOnce(Link) -> Outcome> Guarded<'_, R> {
    /// Runs it.
    pub fn watch(self) -> Outcome {
        let ended = match guard::split(self.lifeline, self.patience).map_err(Failure::own)? {
            Side::Runner(link) => return (self.run)(link),
            Side::Guard(guard) => guard.supervise(),
        };
        match ended {
            GuardOutcome::RunnerExited { code, left } => {
                let mut err = anstream::stderr().lock();
                Failure::unless_reader_left(tell_left(&mut err, &left))?;
                Ok(ExitCode::from(code))
            }
            GuardOutcome::RunnerDied(died) => {
                let told = tell(&mut anstream::stderr().lock(), &died, self.kept);
                Failure::unless_reader_left(told)?;
                let recorded = died.journal.as_ref().map(|journal| close(self.close, journal));
                let unsafe_robot = died.hooks.iter().any(|hook| hook.problem.is_some());
                let code = if unsafe_robot { exit::HOOK_FAILED } else { exit::RUNNER_DIED };
                Ok(recorded.flatten().unwrap_or(ExitCode::from(code)))
            }
        }
    }
}

/// Writes the reports; the exit code that the journal gives, when it can be read
/// and says how the run ended.
fn close(close: &dyn Fn(&Path, &Record), journal: &Path) -> Option<ExitCode> {
    match journal::read(journal) {
        Ok(stored) => {
            close(journal, &stored.record);
            stored.record.runner_death().map(|_| exit::of_run(&stored.record))
        }
        Err(error) => {
            let _ = Failure::own(error).show();
            None
        }
    }
}

/// Writes a report of a run that is over.
pub fn finish(report: Result<Box<dyn Reporter>, Failure>, record: &Record) {
    let written = report.and_then(|mut report| report.finish(record).map_err(Failure::own));
    if let Err(failure) = written {
        let _ = failure.show();
    }
}

fn tell(err: &mut impl Write, died: &Recovery, kept: bool) -> io::Result<()> {
    let (red, green, bold, reset) = ("\u{1b}[1;31m", "\u{1b}[32m", "\u{1b}[1m", "\u{1b}[0m");
    writeln!(err, "{red}error{reset}: the runner died: {}", died.reason)?;
    for hook in &died.hooks {
        match &hook.problem {
            None => writeln!(err, "  hook {}: {green}parked{reset}", hook.name)?,
            Some(problem) => {
                writeln!(err, "  hook {}: {red}NOT PARKED{reset}: {problem}", hook.name)?;
            }
        }
    }
    tell_left(err, &died.left)?;
    match (&died.journal, &died.problem) {
        (Some(journal), Some(problem)) => {
            writeln!(err, "{bold}caused by{reset}: cannot close `{}`: {problem}", journal.display())
        }
        (Some(_), None) if !kept => Ok(()),
        (Some(journal), None) => {
            let folder = journal.parent().unwrap_or(journal);
            writeln!(err, "{bold}hint{reset}: `rtf show {}` shows what was done", folder.display())
        }
        (None, _) => writeln!(err, "{bold}hint{reset}: nothing was started"),
    }
}

fn tell_left(err: &mut impl Write, left: &[LeakedProcess]) -> io::Result<()> {
    for LeakedProcess { pid, command, owner } in left {
        let owner = owner.as_ref().map_or(String::new(), |owner| format!("  ({owner})"));
        writeln!(err, "  killed: {pid} {command}{owner}")?;
    }
    Ok(())
}
