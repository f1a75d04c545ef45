//! `rtf history prune`.

use clap::ArgMatches;
use rtf_history::store::Keep;
use rtf_report::format_count;

use super::{failure, open, print, runs, time};
use crate::cli::HistoryPruneArgs;
use crate::command::VerbResult;

/// Removes old runs.
pub fn run(mut args: HistoryPruneArgs, matches: &ArgMatches) -> VerbResult {
    let keep = match args.keep.parse() {
        Ok(number) => Keep::Newest(number),
        Err(_) => Keep::Since(time::parse_since(&args.keep)?),
    };
    let mut store = open(&mut args.history, matches)?;
    let removed = if args.dry_run { store.prunable(keep) } else { store.prune(keep) };
    let removed = removed.map_err(failure)?;
    print(args.history.format, "removed", &removed, |out| {
        if !removed.is_empty() {
            runs::write(out, &removed)?;
        }
        let verb = if args.dry_run { "would be removed" } else { "removed" };
        writeln!(out, "{} {verb}", format_count(removed.len() as u64, "run"))
    })
}
