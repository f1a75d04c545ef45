//! `rtf history runs`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::answers::RunInfo;
use rtf_report::escape;
use rtf_run::history::time;

use super::{failure, open, print, select, text};
use crate::cli::HistoryRunsArgs;
use crate::command::VerbResult;

/// Lists runs.
pub fn run(mut args: HistoryRunsArgs, matches: &ArgMatches) -> VerbResult {
    let selection = select::runs(&args.runs)?;
    let runs = open(&mut args.history, matches)?.runs(&selection).map_err(failure)?;
    print(args.history.format, "runs", &runs, |out| write(out, &runs))
}

/// Writes a line for each run.
pub fn write(out: &mut dyn Write, runs: &[RunInfo]) -> io::Result<()> {
    if runs.is_empty() {
        return writeln!(out, "no runs");
    }
    runs.iter().try_for_each(|run| {
        let (colour, word) = match run.green {
            true => ("\u{1b}[32m", "green"),
            false => ("\u{1b}[31m", "red"),
        };
        let sources = [
            run.branch.as_deref().map(|branch| escape::line(branch).into_owned()),
            Some(text::commit(run.commit.as_deref(), run.dirty)),
            run.host.as_deref().map(|host| escape::line(host).into_owned()),
            run.profile.as_deref().map(|profile| format!("profile {}", escape::line(profile))),
        ];
        let sources: Vec<_> = sources.into_iter().flatten().filter(|it| !it.is_empty()).collect();
        writeln!(
            out,
            "{}  {colour}{word:<5}\u{1b}[0m  {}  {}  {}  {}",
            time::minute(run.started),
            escape::line(&run.name),
            text::counts(&run.counts),
            text::seconds(run.duration),
            sources.join(", "),
        )
    })
}
