//! `rtf show`: a past run on the console, or what is there of one that was killed.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

use rtf_model::Record;
use rtf_report::console::{Console, ConsoleOptions, Verbosity};
use rtf_report::journal::{self, JournalError, Stored};
use rtf_report::run_folder;

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
    tell_damage(&stored)?;
    Ok(exit_code(&stored.record))
}

/// The exit code of a past run, which may have no end.
pub fn exit_code(record: &Record) -> ExitCode {
    if record.is_complete() { exit::of_run(record) } else { ExitCode::from(exit::FAILED) }
}

/// The journal of a run, in the run's own folder: what leads through `latest`
/// today leads elsewhere tomorrow.
pub fn find(results: &ResultsArgs, run: &str) -> Result<PathBuf, Failure> {
    let journal = run_folder::resolve(&results.results, run).map_err(|error| {
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

/// Says on standard error what of the journal could not be read.
pub fn tell_damage(stored: &Stored) -> Result<(), Failure> {
    let mut err = anstream::stderr().lock();
    for damage in &stored.damages {
        let told = writeln!(err, "warning: the journal is damaged: {damage}");
        Failure::unless_reader_left(told)?;
    }
    Ok(())
}
