//! `rtf history flaky`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::TestAttributes;
use rtf_history::answers::{ComparedRuns, FlakyTest, FlakyTests};
use rtf_history::statistics::Rate;
use rtf_report::format_count;

use super::{failure, open, print_both, select, show, text};
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
    flaky.tests.truncate(args.limit.unwrap_or(usize::MAX));
    let FlakyTests { tests, compared } = &flaky;
    print_both(args.history.format, ("tests", tests), ("compared", compared), |out| {
        write(out, tests)?;
        write_compared(out, compared)
    })
}

/// Prints how runs without a clean commit were compared, because that can be why a test is listed
/// or missing.
fn write_compared(out: &mut dyn Write, compared: &ComparedRuns) -> io::Result<()> {
    let runs = |count| format_count(count, "run");
    let without = "without a commit or with uncommitted changes";
    if compared.by_sources > 0 {
        let count = runs(compared.by_sources);
        writeln!(
            out,
            "compared if the sources of a test are equal (suite, plug-ins, their modules), {without}: {count}"
        )?;
    }
    if compared.neither > 0 {
        let count = runs(compared.neither);
        writeln!(out, "not compared with other runs, {without}: {count}")?;
    }
    Ok(())
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
        let by_sources = match flips.pairs_by_sources {
            0 => String::new(),
            all if all == flips.pairs => " with equal sources".to_owned(),
            some => format!(" ({some} with equal sources)"),
        };
        writeln!(
            out,
            "  {flip} in {pairs} of comparable results{by_sources}{}",
            rate(flips.flip_rate)
        )?;
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
