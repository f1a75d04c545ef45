//! `rtf history compare`.

use std::io::{self, Write};

use clap::ArgMatches;
use rtf_history::answers::{Comparison, NumberChange, TestComparison};
use rtf_history::{TestAttributes, TestIdentity};
use rtf_report::{escape, format_count};
use rtf_run::error::Failure;

use super::{failure, open, print, select, text};
use crate::cli::HistoryCompareArgs;
use crate::command::VerbResult;

/// A smaller difference of durations or numbers is not printed as text.
const THRESHOLD: f64 = 0.1;

/// How long a test must take for its duration to be compared, in seconds.
const SHORTEST: f64 = 0.1;

/// Compares two sets of runs.
pub fn run(mut args: HistoryCompareArgs, matches: &ArgMatches) -> VerbResult {
    let (base, filter) = select::results(&args.select)?;
    let store = open(&mut args.history, matches)?;
    let side = |name: &str| store.comparison_side(name, &base).map_err(failure);
    let (a, b) = (side(&args.a)?, side(&args.b)?);
    let is_meant = |test: &TestAttributes| filter.matches(test);
    let comparison = store.compare((&a, &b), &is_meant).map_err(failure)?;
    for (name, runs) in [(&args.a, comparison.runs_a), (&args.b, comparison.runs_b)] {
        if runs == 0 {
            let error = format!("no run of the history matches `{name}`");
            return Err(Failure::input(error).hint("`rtf history runs` lists the runs"));
        }
    }
    print(args.history.format, "comparison", &comparison, |out| write(out, &args, &comparison))
}

fn write(out: &mut dyn Write, args: &HistoryCompareArgs, found: &Comparison) -> io::Result<()> {
    let runs = |runs: usize| format_count(runs as u64, "run");
    let (a, b) = (escape::line(&args.a), escape::line(&args.b));
    writeln!(out, "A  {a} ({})", runs(found.runs_a))?;
    writeln!(out, "B  {b} ({})", runs(found.runs_b))?;
    let mut differences = 0;
    for test in &found.tests {
        let lines = differences_of(test);
        if !lines.is_empty() {
            writeln!(out, "{}", text::name(&test.identity))?;
            lines.iter().try_for_each(|line| writeln!(out, "  {line}"))?;
            differences += 1;
        }
    }
    let tests = format_count(found.tests.len() as u64, "test");
    writeln!(out, "{differences} of {tests} differ")?;
    write_missing(out, "only in A", &found.only_a)?;
    write_missing(out, "only in B", &found.only_b)
}

fn write_missing(out: &mut dyn Write, title: &str, tests: &[TestIdentity]) -> io::Result<()> {
    tests.iter().try_for_each(|test| writeln!(out, "{title}: {}", text::name(test)))
}

fn differences_of(test: &TestComparison) -> Vec<String> {
    let mut lines = Vec::new();
    if test.last_a != test.last_b || shares(test).0 != shares(test).1 {
        let (a, b) = (text::counts(&test.verdicts_a), text::counts(&test.verdicts_b));
        lines.push(format!("verdicts  {a} → {b}"));
    }
    if let (Some(a), Some(b)) = (test.duration_a, test.duration_b)
        && a.max(b) >= SHORTEST
        && change(a, b).abs() >= THRESHOLD
    {
        let (from, to) = (text::seconds(a), text::seconds(b));
        lines.push(format!("duration  {from} → {to} ({})", signed_percent(change(a, b))));
    }
    lines.extend(test.numbers.iter().filter_map(number_line));
    lines
}

/// The shares of passed results, in thousandths.
fn shares(test: &TestComparison) -> (u32, u32) {
    let share = |counts: &rtf_history::answers::RunCounts| {
        counts.of(rtf_model::Verdict::Passed) * 1000 / counts.total().max(1)
    };
    (share(&test.verdicts_a), share(&test.verdicts_b))
}

fn number_line(number: &NumberChange) -> Option<String> {
    let (a, b) = (number.a?, number.b?);
    let is_large = change(a, b).abs() >= THRESHOLD || number.outside_a != number.outside_b;
    let unit = &number.series.unit;
    let (from, to) = (text::number(a, unit), text::number(b, unit));
    let name = escape::line(&number.series.name);
    is_large.then(|| format!("{name}  {from} → {to}{}", share(change(a, b))))
}

fn share(change: f64) -> String {
    if change.is_finite() { format!(" ({})", signed_percent(change)) } else { String::new() }
}

/// The relative change; infinite if `a` is zero and `b` is not.
fn change(a: f64, b: f64) -> f64 {
    if a == b { 0.0 } else { (b - a) / a.abs() }
}

fn signed_percent(change: f64) -> String {
    format!("{:+.0} %", change * 100.0)
}
