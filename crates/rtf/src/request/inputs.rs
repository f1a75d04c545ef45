//! Which tests to run, and how often. With `--rerun`, both come from a past run.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use rtf_model::{Manifest, Record, Significance, TestRecord, Verdict};
use rtf_plan::config::ConfigRequest;
use rtf_plan::plan::{InputPath, Options, RunnerEnvironment};
use rtf_plan::select::{Shard, TestOrder};
use rtf_report::local_time;
use rtf_run::error::Failure;
use rtf_run::request::{PastQuery, TestsRequest, failed_cases, past_run};

use crate::cli::{FlakyResult, InputArgs, OrderOption, ProfileArgs, RepeatArgs, RerunVerdict};

/// Resolves the arguments, and reads the past runs that they name.
pub fn tests(args: &InputArgs) -> Result<TestsRequest, Failure> {
    tests_in_shard(args, args.select.shard.clone())
}

/// As [`tests`], for a shard that is not in the arguments.
pub fn tests_in_shard(args: &InputArgs, shard: Option<Shard>) -> Result<TestsRequest, Failure> {
    let mut runner = RunnerEnvironment::from_current_process().map_err(Failure::internal)?;
    let results = &args.results.results;
    let mut manifest = if args.select.rerun.is_empty() {
        manifest(args)?
    } else {
        let (manifest, working_dir) = rerun_manifest(args, results)?;
        runner.current_dir = working_dir;
        manifest
    };
    manifest.filters.clone_from(&args.select.filters);
    if let Some(seed) = args.select.shuffle {
        manifest.shuffle = Some(seed.unwrap_or_else(random_seed));
        manifest.order = None;
    }
    set_repetition(&mut manifest, &args.repeat);
    if let Some(order) = args.select.order {
        manifest.order = order.by_history().map(|(_, name)| name.to_owned());
        manifest.shuffle = None;
    }
    let order = manifest.order.as_deref().filter(|_| manifest.shuffle.is_none());
    let order = order.and_then(|name| OrderOption::from_str(name, false).ok()?.by_history());
    let past = PastQuery {
        history: args.history.history.as_deref(),
        results,
        manifest: &manifest,
        dir: &runner.current_dir,
    };
    let mut warnings = Vec::new();
    let order = order.map(|(order, _)| past.order(order, &mut warnings)).transpose()?.flatten();
    let shard = shard.map(|shard| past.assign(shard, &args.select.shard_by)).transpose()?;
    manifest.shard = shard.as_ref().map(|(it, _)| format!("{}/{}", it.index, it.count));
    let inputs = manifest.inputs.iter().map(|input| InputPath::Any(input.into())).collect();
    let options = options(&manifest, runner);
    Ok(TestsRequest { order, shard, warnings, ..TestsRequest::new(inputs, options, manifest) })
}

/// All tests of a suite.
pub fn tests_of_suite(suite: &Path, profile: &ProfileArgs) -> Result<TestsRequest, Failure> {
    let runner = RunnerEnvironment::from_current_process().map_err(Failure::internal)?;
    let manifest = Manifest {
        inputs: vec![suite.to_string_lossy().into_owned()],
        profile: profile.profile.clone(),
        set: settings(profile),
        ..Manifest::default()
    };
    let options = options(&manifest, runner);
    Ok(TestsRequest::new(vec![InputPath::Suite(suite.to_owned())], options, manifest))
}

fn manifest(args: &InputArgs) -> Result<Manifest, Failure> {
    Ok(Manifest {
        inputs: args.inputs.iter().map(|path| utf8(path)).collect::<Result<_, _>>()?,
        recursive: args.recursive,
        param: args.param.clone(),
        environment: args.environment.clone(),
        repetition: args.repetition,
        profile: args.profile.profile.clone(),
        set: settings(&args.profile),
        ..Manifest::default()
    })
}

/// Other paths cannot be in a journal.
fn utf8(path: &Path) -> Result<String, Failure> {
    path.to_str().map(str::to_owned).ok_or_else(|| {
        let error = format!("`{}` cannot be used: its path is not UTF-8", path.display());
        Failure::input(error).hint("rename the file or its directory")
    })
}

fn settings(args: &ProfileArgs) -> Vec<String> {
    args.set.iter().map(|(name, value)| format!("{name}={value}")).collect()
}

/// The manifest of a past run, restricted to the tests to rerun, and its working
/// directory.
fn rerun_manifest(args: &InputArgs, results: &Path) -> Result<(Manifest, PathBuf), Failure> {
    let run = match args.inputs.as_slice() {
        [] => "latest".to_owned(),
        [run] => run.to_string_lossy().into_owned(),
        [_, second, ..] => {
            let error = format!("`--rerun` takes one run, `{}` is too many", second.display());
            return Err(Failure::input(error));
        }
    };
    let record =
        past_run::read(results, &run).map_err(|failure| match Path::new(&run).is_file() {
            true => failure.hint("with `--rerun`, FILE is a past run or its journal"),
            false => failure,
        })?;
    let Some(started) = &record.run else {
        return Err(Failure::input(format!("the journal of `{run}` has no first event")));
    };
    if started.manifest.inputs.is_empty() {
        let error = format!("`{run}` does not record its inputs");
        let hint = "it comes from an older rtf, from `robottestingframework-testrunner`, or from \
                    `rtf merge` of runs with different inputs";
        return Err(Failure::input(error).hint(hint));
    }
    let (only, only_cases) = tests_to_rerun(&record, &run, &args.select.rerun)?;
    let mut manifest = Manifest { only: Some(only), only_cases, ..(*started.manifest).clone() };
    if let Some(profile) = &args.profile.profile {
        manifest.profile = Some(profile.clone());
    }
    manifest.set.extend(settings(&args.profile));
    Ok((manifest, PathBuf::from(&started.working_dir)))
}

/// Suite and test of each test to rerun; and suite, test and paths of failed cases.
type TestsToRerun = (Vec<(String, String)>, Vec<(String, String, Vec<String>)>);

/// The tests to rerun, and the cases of those of which only some cases failed.
fn tests_to_rerun(
    record: &Record,
    run: &str,
    verdicts: &[RerunVerdict],
) -> Result<TestsToRerun, Failure> {
    let (mut names, mut cases) = (Vec::new(), Vec::new());
    for test in &record.tests {
        if !verdicts.iter().any(|wanted| wanted.matches(record, test)) {
            continue;
        }
        let Some((suite, test_name)) = past_run::names(record, test) else { continue };
        if let Some(paths) = failed_cases(test) {
            cases.push((suite.clone(), test_name.clone(), paths));
        }
        names.push((suite, test_name));
    }
    if names.is_empty() {
        let verdicts: Vec<_> = verdicts.iter().map(|wanted| wanted.verb()).collect();
        let error = format!("no test of `{run}` {}: nothing to rerun", verdicts.join(" or "));
        return Err(Failure::input(error));
    }
    Ok((names, cases))
}

impl RerunVerdict {
    fn matches(self, record: &Record, test: &TestRecord) -> bool {
        let skipped_itself = test.significance() == Significance::SkippedItself;
        let interrupted = !skipped_itself
            && matches!(test.final_verdict(), Verdict::Interrupted | Verdict::Skipped);
        match self {
            Self::Failed => !record.is_test_green(test) && !interrupted,
            Self::Interrupted => interrupted,
        }
    }

    fn verb(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Interrupted => "was interrupted or skipped",
        }
    }
}

/// A number that is easy to type.
fn random_seed() -> u64 {
    RandomState::new().build_hasher().finish() % 1_000_000
}

fn set_repetition(manifest: &mut Manifest, args: &RepeatArgs) {
    let for_ms = args.time.map(|time| u64::try_from(time.as_millis()).unwrap_or(u64::MAX));
    manifest.repeat = args.repeat.or(manifest.repeat);
    manifest.for_ms = for_ms.or(manifest.for_ms);
    manifest.retries = args.retries.or(manifest.retries);
    manifest.no_skips |= args.no_skips;
    if let Some(result) = args.flaky_result {
        manifest.flaky_fails = result == FlakyResult::Fail;
    }
}

fn options(manifest: &Manifest, runner: RunnerEnvironment) -> Options {
    let set = manifest.set.iter().filter_map(|text| text.split_once('='));
    let params = set.map(|(name, value)| (name.to_owned(), value.to_owned())).collect();
    Options {
        recursive: manifest.recursive,
        param: manifest.param.clone().unwrap_or_default(),
        environment: manifest.environment.clone().unwrap_or_default(),
        repetitions: manifest.repetition.unwrap_or(1),
        config_request: ConfigRequest { profile: manifest.profile.clone(), params },
        ..Options::new(runner, local_time::now().date())
    }
}

impl OrderOption {
    /// The order and its name in the manifest; `None` for that of the files.
    fn by_history(self) -> Option<(TestOrder, &'static str)> {
        match self {
            Self::File => None,
            Self::FailedFirst => Some((TestOrder::FailedFirst, "failed-first")),
            Self::SlowestFirst => Some((TestOrder::SlowestFirst, "slowest-first")),
        }
    }
}
