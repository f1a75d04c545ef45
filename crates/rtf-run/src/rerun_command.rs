//! The command that reruns a failed test or case, or replays its recording, for the summary of
//! a run.

use std::path::Path;
use std::sync::OnceLock;

use rtf_model::{Record, TestId};
use rtf_plan::suite::replay_suite;
use rtf_report::console::{ReplayCommand, RerunCommand, TestCommands, rerun_suite};

/// The parameter of a suite that replays: the path of the recording.
const RECORDING: &str = "recording";

/// Both commands.
pub fn for_tests() -> TestCommands {
    TestCommands { rerun: for_run(), replay: for_replay() }
}

/// A command that names the suite or the plug-in, with the options without which it
/// would be another test.
pub fn for_run() -> RerunCommand {
    let options = OnceLock::new();
    Box::new(move |record, test, case| {
        if case.is_some() && runs_episodes(record, test) {
            // Another run would give the episode another id and seed.
            return None;
        }
        let mut command = rerun_suite(record, test, case)?;
        // The same for all tests of a run.
        let (plugin_options, config_options) =
            options.get_or_init(|| (plugin_options(record), config_options(record)));
        if is_direct_plugin(record, test) {
            command += plugin_options;
        }
        command += config_options;
        Some(command)
    })
}

/// A command that runs the test in the suite `SUITE.replay.xml`, if that exists next to the
/// test's suite.
pub fn for_replay() -> ReplayCommand {
    Box::new(|record, test, recording| {
        let test = record.tests.get(test.index())?;
        let file = &record.suites.get(test.plan.suite.index())?.plan.file;
        let suite = (!file.is_empty()).then(|| replay_suite(Path::new(file)))?;
        if !suite.is_file() {
            return None;
        }
        let what = format!("{}::{}", suite.display(), test.plan.name);
        let recording = format!("{RECORDING}={}", recording.display());
        let options = config_options(record) + &join([("--set", &recording)].into_iter());
        Some(format!("rtf run {}{options}", shell_words::quote(&what)))
    })
}

/// Whether the cases of a test are episodes.
fn runs_episodes(record: &Record, test: TestId) -> bool {
    let attempts = record.tests.get(test.index()).map(|test| &test.attempts);
    let mut cases = attempts.into_iter().flatten().flat_map(|attempt| attempt.cases.kept());
    cases.next().is_some_and(|case| case.start.episode.is_some())
}

fn is_direct_plugin(record: &Record, test: TestId) -> bool {
    let suite = record.tests.get(test.index()).map(|test| test.plan.suite.index());
    suite.and_then(|suite| record.suites.get(suite)).is_some_and(|suite| suite.plan.file.is_empty())
}

fn plugin_options(record: &Record) -> String {
    let Some(run) = &record.run else { return String::new() };
    let param = run.manifest.param.iter().map(|value| ("--param", value));
    join(param.chain(run.manifest.environment.iter().map(|value| ("--environment", value))))
}

fn config_options(record: &Record) -> String {
    let Some(run) = &record.run else { return String::new() };
    let profile = run.manifest.profile.iter().map(|profile| ("--profile", profile));
    join(profile.chain(run.manifest.set.iter().map(|setting| ("--set", setting))))
}

fn join<'r>(options: impl Iterator<Item = (&'static str, &'r String)>) -> String {
    options.map(|(name, value)| format!(" {name} {}", shell_words::quote(value))).collect()
}
