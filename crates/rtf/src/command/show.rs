//! `rtf show`: prints a past run, even if its runner was killed.

use std::path::Path;

use clap::ArgMatches;
use rtf_model::{Record, TestRecord};
use rtf_report::console::{Console, ConsoleOptions};
use rtf_report::{journal, text};
use rtf_run::error::Failure;
use rtf_run::outputs::console_options;
use rtf_run::request::past_run;
use rtf_run::{exit, terminal};

use super::VerbResult;
use crate::cli::ShowArgs;
use crate::request::config;

/// How many tests are listed if there is no test of the given name.
const NAMES: usize = 10;

/// Prints a past run.
pub fn run(mut args: ShowArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_past_results(&mut args.results, matches)?;
    let journal = past_run::find_journal(&args.results.results, &args.run)?;
    if args.without_tests || args.single_test.is_some() {
        let record = journal::read(&journal).map_err(past_run::unreadable)?.record;
        return show_part(&record, args.single_test.as_deref());
    }
    let dir = journal.parent().unwrap_or(Path::new("."));
    let options = ConsoleOptions { progress: false, ..console_options(dir, args.verbose) };
    let mut console = Console::stdout(options);
    let stored = journal::replay(&journal, &mut console).map_err(past_run::unreadable)?;
    Ok(exit::of_run(&stored.record))
}

/// Prints one test, or everything except the tests.
fn show_part(record: &Record, test: Option<&str>) -> VerbResult {
    let Some(name) = test else {
        terminal::raw_stdout(|out| text::write_without_tests(out, record))?;
        return Ok(exit::without_tests(record));
    };
    let is_named = |test: &&TestRecord| record.full_name(test.plan.test) == name;
    let Some(test) = record.tests.iter().find(is_named) else {
        let error = format!("the run has no test `{name}`");
        let names = record.tests.iter().map(|test| record.full_name(test.plan.test));
        let names = names.take(NAMES).collect::<Vec<_>>().join(", ");
        return Err(Failure::input(error).hint(format!("tests of the run: {names}")));
    };
    terminal::raw_stdout(|out| text::write_test(out, record, test))?;
    Ok(exit::of_test(record, test))
}
