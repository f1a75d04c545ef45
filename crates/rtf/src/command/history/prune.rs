//! `rtf history prune`.

use clap::ArgMatches;
use rtf_history::store::Keep;
use rtf_report::format_count;
use rtf_run::history::time;

use super::{campaigns, failure, open, print_both, runs};
use crate::cli::HistoryPruneArgs;
use crate::command::VerbResult;

/// Removes old runs and campaigns.
pub fn run(mut args: HistoryPruneArgs, matches: &ArgMatches) -> VerbResult {
    let keep = match args.keep.parse() {
        Ok(number) => Keep::Newest(number),
        Err(_) => Keep::Since(time::parse_since(&args.keep)?),
    };
    let mut store = open(&mut args.history, matches)?;
    let removed = if args.dry_run { store.prunable(keep) } else { store.prune(keep) };
    let removed = removed.map_err(failure)?;
    let campaigns = match args.dry_run {
        true => store.prunable_campaigns(keep),
        false => store.prune_campaigns(keep),
    };
    let campaigns = campaigns.map_err(failure)?;
    let both = (("removed", &removed), ("removed_campaigns", &campaigns));
    print_both(args.history.format, both.0, both.1, |out| {
        if !removed.is_empty() {
            runs::write(out, &removed)?;
        }
        if !campaigns.is_empty() {
            campaigns::write(out, &campaigns)?;
        }
        let verb = if args.dry_run { "would be removed" } else { "removed" };
        write!(out, "{}", format_count(removed.len() as u64, "run"))?;
        if !campaigns.is_empty() {
            write!(out, " and {}", format_count(campaigns.len() as u64, "campaign"))?;
        }
        writeln!(out, " {verb}")
    })
}
