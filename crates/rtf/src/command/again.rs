//! The command that runs a failed test again.

use std::sync::OnceLock;

use clap::Parser;
use rtf_model::{Record, TestId};
use rtf_report::console::{Rerun, rerun_suite};

use crate::cli::{Cli, Command, InputArgs};

/// Names the suite or the plug-in; a plug-in with what it was given on the
/// command line, without which it would be another test.
pub fn command() -> Rerun {
    let options = OnceLock::new();
    Box::new(move |record, test| {
        let mut command = rerun_suite(record, test)?;
        if is_single(record, test) {
            // The same for all tests of a run.
            command += options.get_or_init(|| options_of(record));
        }
        Some(command)
    })
}

fn is_single(record: &Record, test: TestId) -> bool {
    let suite = record.tests.get(test.index()).map(|test| test.plan.suite.index());
    suite.and_then(|suite| record.suites.get(suite)).is_some_and(|suite| suite.plan.file.is_empty())
}

/// The options of the run's own command that single plug-ins take. They come
/// from the record, so that `rtf show` knows them too.
fn options_of(record: &Record) -> String {
    let command = record.run.as_ref().map(|run| run.command.as_slice()).unwrap_or_default();
    match Cli::try_parse_from(command).map(|cli| cli.command) {
        Ok(Command::Run(args)) => written(&args.input),
        _ => String::new(),
    }
}

fn written(input: &InputArgs) -> String {
    let options = [("--param", &input.param), ("--environment", &input.environment)];
    let given = options.into_iter().filter_map(|(name, value)| Some((name, value.as_ref()?)));
    given.map(|(name, value)| format!(" {name} {}", shell_words::quote(value))).collect()
}
