//! `rtf history show`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::answers::{TestHistory, TestResult};
use rtf_history::entry::NumberKind;
use rtf_history::{RunSelection, Store, TestAttributes};
use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::history::time;

use super::{failure, open, print, select, text};
use crate::cli::HistoryShowArgs;
use crate::command::VerbResult;

/// How many names a hint lists.
const NAMES: usize = 10;

/// Shows the history of a test.
pub fn run(mut args: HistoryShowArgs, matches: &ArgMatches) -> VerbResult {
    let (runs, filter) = select::results(&args.select)?;
    let store = open(&mut args.history, matches)?;
    let is_meant =
        |test: &TestAttributes| test.identity.to_string() == args.test && filter.matches(test);
    let histories = store.test_histories(&runs, &is_meant).map_err(failure)?;
    if histories.is_empty() {
        return Err(unknown(&store, &args.test, &runs)?);
    }
    print(args.history.format, "tests", &histories, |out| {
        histories.iter().try_for_each(|history| write(out, history))
    })
}

fn unknown(store: &Store, name: &str, runs: &RunSelection) -> Result<Failure, Failure> {
    let names: Vec<_> =
        store.identities().map_err(failure)?.iter().map(ToString::to_string).collect();
    if names.iter().any(|known| known == name) {
        let runs = store.runs(runs).map_err(failure)?.len();
        let error = format!("the test `{name}` has no result in the {runs} selected runs");
        return Ok(Failure::input(error).hint("remove options that select runs or tests"));
    }
    let word = name.rsplit('/').next().unwrap_or(name);
    let mut similar: Vec<_> = names.iter().filter(|known| known.contains(word)).collect();
    if similar.is_empty() {
        similar = names.iter().collect();
    }
    let listed: Vec<_> = similar.into_iter().take(NAMES).map(text::name).collect();
    Ok(Failure::input(format!("the history has no test `{name}`"))
        .hint(format!("tests of the history: {}", listed.join(", "))))
}

fn write(out: &mut dyn Write, history: &TestHistory) -> io::Result<()> {
    let TestHistory { identity, former_names, results, series, .. } = history;
    write!(out, "{}", text::name(identity))?;
    if !identity.suite_file.is_empty() {
        write!(out, "  ({})", escape::line(&identity.suite_file))?;
    }
    writeln!(out)?;
    if !former_names.is_empty() {
        writeln!(out, "  was        {}", escape::line(&former_names.join(", ")))?;
    }
    let (strip, meanings) = text::strip(results);
    writeln!(out, "  results    {}", text::counts(&history.counts))?;
    writeln!(out, "  verdicts   {strip}  ({meanings}; the newest last)")?;
    write_durations(out, results)?;
    for series in series {
        let values: Vec<_> = series.points.iter().map(|point| point.value).collect();
        let kind = if series.series.kind == NumberKind::Signal { " (signal)" } else { "" };
        writeln!(
            out,
            "  {:<9}  {}  {}",
            format!("{}{kind}", escape::line(&series.series.name)),
            text::sparkline(&values),
            text::series(&series.points, &series.series.unit),
        )?;
    }
    let last_problem = results.iter().rev().find(|result| result.verdict.is_problem());
    last_problem.map_or(Ok(()), |result| write_problem(out, result))
}

fn write_durations(out: &mut dyn Write, results: &[TestResult]) -> io::Result<()> {
    let durations: Vec<_> = results.iter().map(|result| result.duration).collect();
    let known = || durations.iter().flatten().copied();
    let Some(last) = known().next_back() else { return Ok(()) };
    let (low, high) = (known().fold(last, f64::min), known().fold(last, f64::max));
    writeln!(
        out,
        "  duration   {}  {} … {}, last {}",
        text::sparkline(&durations),
        text::seconds(low),
        text::seconds(high),
        text::seconds(last),
    )
}

/// Writes the newest problem of a test.
pub fn write_problem(out: &mut dyn Write, result: &TestResult) -> io::Result<()> {
    let reason = result.reason.as_deref().and_then(|reason| reason.lines().next());
    let reason = reason.map_or(String::new(), |reason| format!(": {}", escape::line(reason)));
    writeln!(
        out,
        "  last problem  {}  {}{reason}  ({})",
        time::minute(result.started),
        text::word(result),
        escape::line(&result.name),
    )
}
