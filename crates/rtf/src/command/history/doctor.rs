//! `rtf history doctor`.

use std::collections::HashSet;
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_history::Store;
use rtf_history::store::StoreCounts;
use rtf_report::{escape, format_count};
use rtf_run::exit;
use rtf_run::history::{campaigns, journals};
use serde::Serialize;

use super::{failure, open, print};
use crate::cli::HistoryDoctorArgs;
use crate::command::VerbResult;

/// The state of the database.
#[derive(Debug, Serialize)]
struct HistoryChecks {
    /// The database.
    path: String,
    /// The size of its file with its write-ahead log.
    #[serde(skip_serializing_if = "Option::is_none")]
    bytes: Option<u64>,
    #[serde(flatten)]
    counts: StoreCounts,
    /// What is wrong with it.
    problems: Vec<String>,
    /// Journals, and directories of campaigns, in the results directory that are not imported.
    missing: Vec<String>,
}

/// Checks the database.
pub fn run(mut args: HistoryDoctorArgs, matches: &ArgMatches) -> VerbResult {
    let store = open(&mut args.history, matches)?;
    let known: HashSet<_> = store.run_names().map_err(failure)?.into_iter().collect();
    let results = &args.history.results.results;
    let mut missing = journals::missing(results, &known);
    missing.extend(campaigns::missing(results, &store.campaign_directories().map_err(failure)?));
    let checks = HistoryChecks {
        path: store.location().to_string(),
        bytes: bytes(&store),
        counts: store.counts().map_err(failure)?,
        problems: store.check().map_err(failure)?,
        missing: missing.iter().map(|journal| journal.display().to_string()).collect(),
    };
    print(args.history.format, "checks", &checks, |out| {
        let counts = &checks.counts;
        let count = |number, noun| format_count(number, noun);
        let size = checks.bytes.map(|bytes| format!("  ({} KiB)", bytes.div_ceil(1024)));
        writeln!(out, "{}{}", escape::line(&checks.path), size.unwrap_or_default())?;
        writeln!(
            out,
            "  {}, {}, {}, {} series, {}",
            count(counts.runs, "run"),
            count(counts.tests, "test"),
            count(counts.results, "result"),
            counts.series,
            count(counts.points, "point"),
        )?;
        if counts.campaigns > 0 {
            let episodes = count(counts.episodes, "episode");
            writeln!(out, "  {}, {episodes}", count(counts.campaigns, "campaign"))?;
        }
        if counts.pruned > 0 {
            writeln!(out, "  {} pruned or merged from others", count(counts.pruned, "run"))?;
        }
        if counts.pruned_campaigns > 0 {
            writeln!(out, "  {} pruned", count(counts.pruned_campaigns, "campaign"))?;
        }
        for problem in &checks.problems {
            writeln!(out, "  \u{1b}[31mproblem\u{1b}[0m  {}", escape::line(problem))?;
        }
        for journal in &checks.missing {
            writeln!(out, "  not imported  {}", escape::line(journal))?;
        }
        if !checks.missing.is_empty() {
            writeln!(out, "  `rtf history import` imports them")?;
        }
        Ok(())
    })?;
    Ok(ExitCode::from(if checks.problems.is_empty() { exit::PASSED } else { exit::FAILED }))
}

fn bytes(store: &Store) -> Option<u64> {
    let file = store.location().file()?;
    let mut log = file.as_os_str().to_owned();
    log.push("-wal");
    let size = |path: &std::path::Path| path.metadata().map_or(0, |found| found.len());
    Some(size(file) + size(log.as_ref()))
}
