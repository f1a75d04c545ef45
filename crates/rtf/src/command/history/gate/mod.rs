//! `rtf history gate`: is a run worse than the runs before it?

mod markdown;
mod words;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::ArgMatches;
use rtf_history::answers::RunInfo;
use rtf_history::answers::gate::{GateLimits, GateReport, GateRuns};
use rtf_history::{RunSelection, Store, TestAttributes};
use rtf_report::escape;
use rtf_run::error::Failure;
use rtf_run::history::{self, TestFilter};
use rtf_run::{exit, terminal};

use super::{failure, resolve, write_json};
use crate::cli::{GateFormat, HistoryGateArgs};
use crate::command::VerbResult;

/// How many names a hint lists.
const NAMES: usize = 10;

/// Judges a run.
pub fn run(mut args: HistoryGateArgs, matches: &ArgMatches) -> VerbResult {
    let filter = TestFilter::parse(&args.filters)?;
    let path = resolve(&mut args.results, &mut args.file, matches)?;
    let store = Store::open_existing(&path).map_err(failure)?;
    let runs = runs(&store, &args)?;
    refuse_unknown_names(&store, &args)?;
    let limits = GateLimits {
        max_new_failures: args.max_new_failures,
        max_flaky: args.max_flaky,
        no_regression: args.no_regression,
    };
    let is_meant = |test: &TestAttributes| filter.matches(test);
    let report = store.gate(&runs, &limits, &is_meant).map_err(failure)?;
    match args.format {
        GateFormat::Text => terminal::stdout(|out| write(out, &report))?,
        GateFormat::Json => terminal::raw_stdout(|out| write_json(out, "gate", &report))?,
        GateFormat::Markdown => terminal::raw_stdout(|out| markdown::write(out, &report))?,
    }
    Ok(ExitCode::from(if report.passed { exit::PASSED } else { exit::FAILED }))
}

/// The run, and the runs with which it is compared.
fn runs(store: &Store, args: &HistoryGateArgs) -> Result<GateRuns, Failure> {
    let side = |name: &str| store.comparison_side(name, &RunSelection::default()).map_err(failure);
    let selection = side(&args.run)?;
    let run = store.runs(&selection).map_err(failure)?.into_iter().next().ok_or_else(|| {
        let error = format!("no run of the history matches `{}`", args.run);
        Failure::input(error).hint("`rtf history runs` lists the runs")
    })?;
    let (name, baseline) = match &args.baseline {
        Some(name) => (name.clone(), side(name)?),
        None => default_branch(store)?,
    };
    let last = usize::try_from(args.last).unwrap_or(usize::MAX);
    let runs = GateRuns::new(store, run, &baseline, last).map_err(failure)?;
    if runs.baseline.is_empty() {
        return Err(no_baseline(&runs.run, &name));
    }
    Ok(runs)
}

fn no_baseline(run: &RunInfo, name: &str) -> Failure {
    let profile = match &run.profile {
        Some(profile) => format!("with the profile `{profile}`"),
        None => "without a profile".to_owned(),
    };
    let error = format!("`{name}` has no run {profile} before `{}`", run.name);
    Failure::input(error).hint(
        "run the tests there first, import their results (`rtf history import`), or name another \
         `--baseline`",
    )
}

/// The runs of the default branch.
fn default_branch(store: &Store) -> Result<(String, RunSelection), Failure> {
    let dir = std::env::current_dir().map_err(Failure::internal)?;
    let branch = history::default_branch(store, &dir).map_err(failure)?.ok_or_else(|| {
        Failure::input("the history has no run of the default branch")
            .hint("name the runs to compare with: `--baseline branch:NAME`")
    })?;
    let name = format!("branch:{branch}");
    Ok((name, RunSelection { branch: Some(branch), ..RunSelection::default() }))
}

/// A misspelt name would pass its gate.
fn refuse_unknown_names(store: &Store, args: &HistoryGateArgs) -> Result<(), Failure> {
    let names = store.series_names().map_err(failure)?;
    let unknown = args.no_regression.iter().find(|limit| !names.contains(&limit.name));
    let Some(unknown) = unknown else { return Ok(()) };
    let listed: Vec<_> = names.iter().take(NAMES).map(|name| escape::line(name)).collect();
    let error = format!("the history has no measurement or signal `{}`", unknown.name);
    Err(Failure::input(error).hint(match listed.is_empty() {
        true => "no test has reported one".to_owned(),
        false => format!("measurements and signals of the history: {}", listed.join(", ")),
    }))
}

fn write(out: &mut dyn Write, report: &GateReport) -> io::Result<()> {
    writeln!(out, "{}", escape::line(&words::head(report)))?;
    for gate in words::gates(report) {
        let outcome = if gate.passed { "passed" } else { "FAILED" };
        writeln!(out, "{outcome}  {}", escape::line(&gate.title))?;
        for line in gate.lines {
            let details =
                if line.details.is_empty() { String::new() } else { format!("  {}", line.details) };
            writeln!(out, "  {}{}", escape::line(&line.test), escape::line(&details))?;
        }
        gate.notes.iter().try_for_each(|note| writeln!(out, "  {}", escape::line(note)))?;
    }
    Ok(())
}
