//! Runs in a child process under a guard, which is the process that the user started.
//!
//! The guard must fork while there is only one thread. This module reports what the
//! guard did; the guard itself is [`rtf_engine::guard`].

use std::io::{self, Write};
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use rtf_engine::guard::{self, GuardOutcome, Lifeline, Link, Recovery, Side};
use rtf_model::{LeakedProcess, Record};
use rtf_report::journal;

use crate::VerbResult;
use crate::error::Failure;
use crate::{exit, operator, terminal};

/// How the guard supervises the runner.
pub struct Supervision {
    /// The guard ends the run when this closes.
    pub lifeline: Option<Lifeline>,
    /// How long the runner may not answer before the guard kills it.
    pub patience: Duration,
    /// Whether the journal is still there when the guard has ended.
    pub keeps_journal: bool,
}

/// Calls `run` in the runner's process. If the runner dies, calls `complete` in the
/// guard's process with the journal, to write the missing reports.
pub fn run(
    supervision: Supervision,
    run: impl FnOnce(Link) -> VerbResult,
    complete: impl FnOnce(&Path, &Record),
) -> VerbResult {
    let Supervision { lifeline, patience, keeps_journal } = supervision;
    let had_foreground = operator::has_foreground();
    let ended = match guard::split(lifeline, patience).map_err(Failure::internal)? {
        Side::Runner(link) => return run(link),
        Side::Guard(guard) => guard.supervise(),
    };
    match ended {
        GuardOutcome::RunnerExited { code, left } => {
            terminal::stderr(|err| report_leftovers(err, &left))?;
            Ok(ExitCode::from(code))
        }
        GuardOutcome::RunnerDied(died) => {
            operator::recover_terminal(had_foreground);
            terminal::stderr(|err| report_death(err, &died, keeps_journal))?;
            let hook_failed = died.hooks.iter().any(|hook| hook.problem.is_some());
            let code = if hook_failed { exit::HOOK_FAILED } else { exit::RUNNER_DIED };
            let recorded = died.journal.and_then(|journal| complete_run(&journal, complete));
            Ok(recorded.unwrap_or(ExitCode::from(code)))
        }
    }
}

/// Returns the run's exit code if the journal records the runner's death.
fn complete_run(journal: &Path, complete: impl FnOnce(&Path, &Record)) -> Option<ExitCode> {
    match journal::read(journal) {
        Ok(stored) => {
            complete(journal, &stored.record);
            stored.record.runner_death().map(|_| exit::of_run(&stored.record))
        }
        Err(error) => {
            Failure::internal(error).print();
            None
        }
    }
}

fn report_death(err: &mut dyn Write, died: &Recovery, keeps_journal: bool) -> io::Result<()> {
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
    report_leftovers(err, &died.left)?;
    match (&died.journal, &died.problem) {
        (Some(journal), Some(problem)) => {
            let journal = journal.display();
            writeln!(err, "{bold}caused by{reset}: cannot complete `{journal}`: {problem}")
        }
        (Some(_), None) if !keeps_journal => Ok(()),
        (Some(journal), None) => {
            let dir = journal.parent().unwrap_or(journal).display();
            writeln!(err, "{bold}hint{reset}: `rtf show {dir}` shows the run up to this point")
        }
        (None, _) => writeln!(err, "{bold}hint{reset}: nothing was started"),
    }
}

fn report_leftovers(err: &mut dyn Write, leftovers: &[LeakedProcess]) -> io::Result<()> {
    for LeakedProcess { pid, command, owner } in leftovers {
        let owner = owner.as_ref().map_or(String::new(), |owner| format!("  ({owner})"));
        writeln!(err, "  killed: {pid} {command}{owner}")?;
    }
    Ok(())
}
