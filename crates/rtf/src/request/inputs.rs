//! Which tests to run, and how often. With `--rerun`, both come from a past run.

use std::hash::{BuildHasher, Hasher, RandomState};
use std::path::{Path, PathBuf};

use clap::ValueEnum;
use rtf_model::Manifest;
use rtf_plan::config::ConfigRequest;
use rtf_plan::plan::{InputPath, Options, RunnerEnvironment};
use rtf_plan::select::TestOrder;
use rtf_report::local_time;
use rtf_run::error::Failure;
use rtf_run::request::rerun::{self, RerunVerdict};
use rtf_run::request::{PastQuery, TestsRequest};

use crate::cli::{FlakyResult, InputArgs, OrderOption, ProfileArgs, RepeatArgs, RerunOption};

/// Resolves the arguments, and reads the past runs that they name.
pub fn tests(args: &InputArgs) -> Result<TestsRequest, Failure> {
    let mut runner = RunnerEnvironment::from_current_process().map_err(Failure::internal)?;
    let results = &args.results.results;
    let mut manifest = if args.select.rerun.is_empty() {
        manifest(args)?
    } else {
        let run = past_run(&args.inputs)?;
        let verdicts: Vec<_> = args.select.rerun.iter().map(|verdict| verdict.selected()).collect();
        let (mut manifest, working_dir) = rerun::manifest(results, &run, &verdicts)?;
        if let Some(profile) = &args.profile.profile {
            manifest.profile = Some(profile.clone());
        }
        manifest.set.extend(settings(&args.profile));
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
    let shard = args.select.shard.clone();
    let shard = shard.map(|shard| past.assign(shard, &args.select.shard_by)).transpose()?;
    manifest.shard = shard.as_ref().map(|(it, _)| format!("{}/{}", it.index, it.count));
    let inputs = manifest.inputs.iter().map(|input| InputPath::Any(input.into())).collect();
    let options = plan_options(&manifest, runner);
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
    let options = plan_options(&manifest, runner);
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

/// The run that `--rerun` repeats.
fn past_run(inputs: &[PathBuf]) -> Result<String, Failure> {
    match inputs {
        [] => Ok("latest".to_owned()),
        [run] => Ok(run.to_string_lossy().into_owned()),
        [_, second, ..] => {
            let error = format!("`--rerun` takes one run, `{}` is too many", second.display());
            Err(Failure::input(error))
        }
    }
}

impl RerunOption {
    fn selected(self) -> RerunVerdict {
        match self {
            Self::Failed => RerunVerdict::Failed,
            Self::Interrupted => RerunVerdict::Interrupted,
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

fn plan_options(manifest: &Manifest, runner: RunnerEnvironment) -> Options {
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
