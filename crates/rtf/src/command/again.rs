//! The command that runs a failed test again.

use std::sync::OnceLock;

use rtf_model::{Record, TestId};
use rtf_report::console::{RerunCommand, rerun_suite};

/// Names the suite or the plug-in; a plug-in with what it was given on the
/// command line, without which it would be another test.
pub fn command() -> RerunCommand {
    let options = OnceLock::new();
    Box::new(move |record, test| {
        let mut command = rerun_suite(record, test)?;
        // The same for all tests of a run.
        let (single, all) = options.get_or_init(|| (options_of(record), settings_of(record)));
        if is_single(record, test) {
            command += single;
        }
        command += all;
        Some(command)
    })
}

fn is_single(record: &Record, test: TestId) -> bool {
    let suite = record.tests.get(test.index()).map(|test| test.plan.suite.index());
    suite.and_then(|suite| record.suites.get(suite)).is_some_and(|suite| suite.plan.file.is_empty())
}

/// What single plug-ins were given. It comes from the record, so that `rtf show`
/// knows it too.
fn options_of(record: &Record) -> String {
    let Some(run) = &record.run else { return String::new() };
    let given = [("--param", &run.manifest.param), ("--environment", &run.manifest.environment)];
    let given = given.into_iter().filter_map(|(name, value)| Some((name, value.as_ref()?)));
    given.map(|(name, value)| format!(" {name} {}", shell_words::quote(value))).collect()
}

/// The profile and the parameters.
fn settings_of(record: &Record) -> String {
    let Some(run) = &record.run else { return String::new() };
    let profile = run.manifest.profile.iter().map(|profile| ("--profile", profile));
    let set = run.manifest.set.iter().map(|setting| ("--set", setting));
    let given = profile.chain(set);
    given.map(|(name, value)| format!(" {name} {}", shell_words::quote(value))).collect()
}
