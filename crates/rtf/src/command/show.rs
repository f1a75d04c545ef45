//! `rtf show`: a past run on the console, or what is there of one that was killed.

use std::io::Write;
use std::process::ExitCode;

use rtf_report::console::{Console, ConsoleOptions, Verbosity};
use rtf_report::journal::{self, Stored};
use rtf_report::run_folder;

use super::Outcome;
use crate::cli::ShowArgs;
use crate::error::Failure;
use crate::exit;

/// Shows.
pub fn run(args: &ShowArgs) -> Outcome {
    let path = run_folder::resolve(&args.results.results, &args.run).map_err(Failure::input)?;
    let mut console = Console::stdout(ConsoleOptions {
        verbosity: if args.verbose { Verbosity::Verbose } else { Verbosity::Normal },
        folder: path.parent().map(std::path::Path::to_owned),
        progress: false,
        ..ConsoleOptions::default()
    });
    let stored = journal::replay(&path, &mut console).map_err(Failure::input)?;
    tell_damage(&stored)?;
    if stored.record.is_complete() {
        return Ok(exit::of_run(&stored.record));
    }
    Ok(ExitCode::from(exit::FAILED))
}

/// Says on standard error what of the journal could not be read.
pub fn tell_damage(stored: &Stored) -> Result<(), Failure> {
    let mut err = anstream::stderr().lock();
    for damage in &stored.damages {
        writeln!(err, "warning: the journal is damaged: {damage}").map_err(Failure::own)?;
    }
    Ok(())
}
