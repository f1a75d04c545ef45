//! `rtf show`: a past run on the console, or what is there of one that was killed.

use std::io::Write;
use std::path::{Path, PathBuf};

use rtf_model::{Damage, Record};
use rtf_report::console::{Console, ConsoleOptions, Verbosity};
use rtf_report::journal::{self, JournalError};
use rtf_report::run_dir;

use super::{Outcome, again};
use crate::cli::{ResultsArgs, ShowArgs};
use crate::error::Failure;
use crate::exit;

/// Shows.
pub fn run(args: &ShowArgs) -> Outcome {
    let path = find(&args.results, &args.run)?;
    let mut console = Console::stdout(ConsoleOptions {
        verbosity: if args.verbose { Verbosity::Verbose } else { Verbosity::Normal },
        folder: path.parent().map(Path::to_owned),
        progress: false,
        rerun: again::command(),
    });
    let stored = journal::replay(&path, &mut console).map_err(unreadable)?;
    Ok(exit::of_run(&stored.record))
}

/// The journal of a run, in the run's own folder: what leads through `latest`
/// today leads elsewhere tomorrow.
pub fn find(results: &ResultsArgs, run: &str) -> Result<PathBuf, Failure> {
    let journal = run_dir::resolve(&results.results, run).map_err(|error| {
        let hint = error.hint();
        Failure::input(error).hint(hint)
    })?;
    Ok(without_link(&journal).unwrap_or(journal))
}

/// The path with its folder named directly, when that is a link.
fn without_link(file: &Path) -> Option<PathBuf> {
    let link = file.parent()?;
    let folder = std::fs::read_link(link).ok()?;
    Some(link.parent()?.join(folder).join(file.file_name()?))
}

/// A journal that is none is bad input; a report that cannot be written is not.
pub fn unreadable(error: JournalError) -> Failure {
    match error {
        JournalError::Report(error) => Failure::own(error),
        error => Failure::input(error),
    }
}

/// For commands whose result would hide what is missing from a damaged journal.
pub fn refuse_damaged(run: &str, record: &Record) -> Result<(), Failure> {
    let Some(damage) = record.damages.first() else { return Ok(()) };
    let what = format!("the journal of `{run}` is damaged: {damage}");
    let hint = format!("`rtf show {}` shows what can be read of it", shell_words::quote(run));
    Err(Failure::input(what).hint(hint))
}

/// Prints on standard error where the journal is damaged.
pub fn print_damage(damages: &[Damage]) -> Result<(), Failure> {
    let mut err = anstream::stderr().lock();
    let (red, reset) = ("\u{1b}[1;31m", "\u{1b}[0m");
    for damage in damages {
        let told = writeln!(err, "{red}error{reset}: the journal is damaged: {damage}");
        Failure::unless_reader_left(told)?;
    }
    Ok(())
}
