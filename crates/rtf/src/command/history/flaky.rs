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
    print(args.history.format, "tests", &flaky, |out| write(out, &flaky))
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
        writeln!(out, "  {flip} in {pairs} of results of one commit{}", rate(flips.flip_rate))?;
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
