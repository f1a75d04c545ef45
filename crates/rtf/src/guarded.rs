//! `rtf run` under a guard: what the process does that the user started.
//!
//! The runner is its child. This module tells what the guard had to do.

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;

use rtf_engine::guard::{self, Died, Ended, Side};
use rtf_model::LeftProcess;
use rtf_report::journal;

use crate::cli::RunArgs;
use crate::command::{self, Outcome};
use crate::error::Failure;
use crate::exit;

/// Runs.
pub fn run(args: &RunArgs) -> Outcome {
    let ended = match guard::split().map_err(Failure::own)? {
        Side::Runner(link) => return command::run::run(args, link),
        Side::Guard(guard) => guard.watch(),
    };
    let mut err = anstream::stderr().lock();
    match ended {
        Ended::ByItself { code, left } => {
            Failure::unless_reader_left(tell_left(&mut err, &left))?;
            Ok(ExitCode::from(code))
        }
        Ended::Died(died) => {
            Failure::unless_reader_left(tell(&mut err, &died))?;
            write_reports(args, died.journal.as_deref());
            let unsafe_robot = died.hooks.iter().any(|hook| hook.problem.is_some());
            Ok(ExitCode::from(if unsafe_robot { exit::HOOK_FAILED } else { exit::RUNNER_DIED }))
        }
    }
}

fn tell(err: &mut impl Write, died: &Died) -> io::Result<()> {
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
        (Some(journal), None) => {
            let folder = journal.parent().unwrap_or(journal);
            writeln!(err, "{bold}hint{reset}: `rtf show {}` shows what was done", folder.display())
        }
        (None, _) => writeln!(err, "{bold}hint{reset}: nothing was started"),
    }
}

fn tell_left(err: &mut impl Write, left: &[LeftProcess]) -> io::Result<()> {
    for LeftProcess { pid, command, owner } in left {
        let owner = owner.as_ref().map_or(String::new(), |owner| format!("  ({owner})"));
        writeln!(err, "  killed: {pid} {command}{owner}")?;
    }
    Ok(())
}

/// The reports that the runner would have written at its end.
fn write_reports(args: &RunArgs, journal: Option<&Path>) {
    let Some(journal) = journal.filter(|_| !args.reports.is_empty()) else { return };
    let stored = match journal::read(journal) {
        Ok(stored) => stored,
        Err(error) => {
            let _ = Failure::own(error).show();
            return;
        }
    };
    for (format, path) in &args.reports {
        let report = command::run::open_report(*format, path, journal.parent());
        let written =
            report.and_then(|mut report| report.finish(&stored.record).map_err(Failure::own));
        if let Err(failure) = written {
            let _ = failure.show();
        }
    }
}
