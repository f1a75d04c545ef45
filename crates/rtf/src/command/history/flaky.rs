//! `rtf history flaky`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::TestAttributes;
use rtf_history::answers::FlakyTest;
use rtf_history::statistics::Rate;
use rtf_report::format_count;

use super::{failure, open, print, select, show, text};
use crate::cli::HistoryTestsArgs;
use crate::command::VerbResult;

/// Lists flaky tests.
pub fn run(mut args: HistoryTestsArgs, matches: &ArgMatches) -> VerbResult {
    let (runs, filter) = select::results(&args.select)?;
    let store = open(&mut args.history, matches)?;
    let is_meant = |test: &TestAttributes| {
        (args.cases || test.identity.case.is_empty()) && filter.matches(test)
    };
    let mut flaky = store.flaky(&runs, &is_meant).map_err(failure)?;
    flaky.truncate(args.limit.unwrap_or(usize::MAX));
    let uncommitted = store.runs(&runs).map_err(failure)?;
    let uncommitted = uncommitted.iter().map(|run| u64::from(!run.is_committed())).sum();
    print(args.history.format, "tests", &flaky, |out| {
        write(out, &flaky)?;
        write_uncommitted(out, uncommitted)
    })
}

/// Says what was not compared, because that can be why a test is missing.
fn write_uncommitted(out: &mut dyn Write, runs: u64) -> io::Result<()> {
    if runs == 0 {
        return Ok(());
    }
    let runs = format_count(runs, "run");
    writeln!(
        out,
        "not compared with other runs, without a commit or with uncommitted changes: {runs}"
    )
}

fn write(out: &mut dyn Write, tests: &[FlakyTest]) -> io::Result<()> {
    if tests.is_empty() {
        return writeln!(out, "no flaky tests");
    }
    tests.iter().try_for_each(|test| {
        let flips = &test.flips;
        let pairs = format_count(flips.pairs, "pair");
        writeln!(out, "{}", text::name(&test.identity))?;
        let flip = format_count(flips.flips, "flip");
        writeln!(out, "  {flip} in {pairs} of comparable results{}", rate(flips.flip_rate))?;
        writeln!(out, "  {} passed, {} failed{}", flips.passed, flips.failed, bench(test))?;
        test.last_problem.as_ref().map_or(Ok(()), |result| show::write_problem(out, result))
    })
}

fn bench(test: &FlakyTest) -> String {
    match test.flips.bench {
        0 => String::new(),
        bench => format!(
            ", {bench} without a result because of the bench{}",
            rate(test.flips.bench_rate)
        ),
    }
}

fn rate(rate: Option<Rate>) -> String {
    rate.map_or(String::new(), |Rate { value, low, high }| {
        format!(": {} ({} … {})", text::percent(value), text::percent(low), text::percent(high))
    })
}
