//! `rtf history slow`.

use clap::ArgMatches;
use rtf_history::TestAttributes;
use rtf_report::format_count;

use super::{failure, open, print, select, text};
use crate::cli::{HistoryFormat, HistoryTestsArgs};
use crate::command::VerbResult;

/// How many tests are listed by default as text.
const LIMIT: usize = 20;

/// Lists tests by duration.
pub fn run(mut args: HistoryTestsArgs, matches: &ArgMatches) -> VerbResult {
    let (runs, filter) = select::results(&args.select)?;
    let store = open(&mut args.history, matches)?;
    let is_meant = |test: &TestAttributes| {
        (args.cases || test.identity.case.is_empty()) && filter.matches(test)
    };
    let mut slow = store.slow(&runs, &is_meant).map_err(failure)?;
    let all = args.history.format == HistoryFormat::Json;
    slow.truncate(args.limit.unwrap_or(if all { usize::MAX } else { LIMIT }));
    print(args.history.format, "tests", &slow, |out| {
        if slow.is_empty() {
            return writeln!(out, "no results");
        }
        slow.iter().try_for_each(|test| {
            let [median, max, last] = [test.median, test.max, test.last].map(text::seconds);
            let runs = format_count(test.runs as u64, "run");
            let name = text::name(&test.identity);
            writeln!(out, "{median}  {name}  (longest {max}, last {last}, {runs})")
        })
    })
}
