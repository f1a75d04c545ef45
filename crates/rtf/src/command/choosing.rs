//! From the command line to what was asked for: inputs, and which of their tests.
//!
//! With `--rerun` that is what a past run was asked for, and of its tests those
//! that are to be run again.

use std::collections::HashMap;
use std::hash::{BuildHasher, Hasher, RandomState};
use std::path::PathBuf;
use std::sync::Arc;

use rtf_model::{Diagnostic, Manifest, Record, TestId, Verdict};
use rtf_plan::select::{self, Filter, Selection, Shard, ShardBy};
use rtf_plan::suite::{SourceMap, SourceText};
use rtf_report::journal;

use super::show;
use crate::cli::{FlakyResult, InputArgs, Rerun, ResultsArgs};
use crate::error::Failure;

/// What was asked for.
pub struct Asked {
    /// It in words, as the run's first event tells it.
    pub manifest: Manifest,
    /// The folder to which the inputs are relative; `None`: the current one.
    pub folder: Option<PathBuf>,
    shard: Option<Shard>,
}

/// Reads the command line, and the past run that it names.
pub fn ask(args: &InputArgs, results: &ResultsArgs) -> Result<Asked, Failure> {
    let shard = args.select.shard.clone();
    let shard = shard.map(|shard| divided(shard, &args.select.shard_by, results)).transpose()?;
    let (mut manifest, folder) =
        if args.select.rerun.is_empty() { (given(args), None) } else { again(args, results)? };
    manifest.filters.clone_from(&args.select.filters);
    if let Some(seed) = args.select.shuffle {
        manifest.shuffle = Some(seed.unwrap_or_else(some_seed));
    }
    let repeat = &args.repeat;
    manifest.repeat = repeat.repeat.or(manifest.repeat);
    let for_ms = repeat.time.map(|time| u64::try_from(time.as_millis()).unwrap_or(u64::MAX));
    manifest.for_ms = for_ms.or(manifest.for_ms);
    manifest.retries = repeat.retries.or(manifest.retries);
    if let Some(result) = repeat.flaky_result {
        manifest.flaky_fails = result == FlakyResult::Fail;
    }
    manifest.shard = shard.as_ref().map(|shard| format!("{}/{}", shard.index, shard.count));
    Ok(Asked { manifest, folder, shard })
}

fn given(args: &InputArgs) -> Manifest {
    let named = |path: &PathBuf| path.to_string_lossy().into_owned();
    Manifest {
        inputs: args.inputs.iter().map(named).collect(),
        recursive: args.recursive,
        param: args.param.clone(),
        environment: args.environment.clone(),
        repetition: args.repetition,
        profile: args.profile.profile.clone(),
        set: settings(args),
        ..Manifest::default()
    }
}

fn settings(args: &InputArgs) -> Vec<String> {
    args.profile.set.iter().map(|(name, value)| format!("{name}={value}")).collect()
}

/// What the past run was asked for, restricted to the tests to be run again.
fn again(args: &InputArgs, results: &ResultsArgs) -> Result<(Manifest, Option<PathBuf>), Failure> {
    let run = match args.inputs.as_slice() {
        [] => "latest".to_owned(),
        [run] => run.to_string_lossy().into_owned(),
        [_, second, ..] => {
            let what = format!("`--rerun` takes one run, `{}` is too many", second.display());
            return Err(Failure::input(what));
        }
    };
    let record = record(results, &run).map_err(|failure| match PathBuf::from(&run).is_file() {
        true => failure.hint("with `--rerun`, FILE is a past run, or its journal".to_owned()),
        false => failure,
    })?;
    let Some(started) = &record.run else {
        return Err(Failure::input(format!("the journal of `{run}` has no beginning")));
    };
    if started.manifest.inputs.is_empty() {
        let what = format!("`{run}` does not say what it was asked for");
        let hint = "an older rtf made it, or `robottestingframework-testrunner`, or `rtf merge` \
                    of runs that were asked for different things";
        return Err(Failure::input(what).hint(hint.to_owned()));
    }
    let wanted = |verdict| args.select.rerun.iter().any(|which| which.is(verdict));
    let tests = (0..).map(TestId).zip(&record.tests);
    let chosen = tests.filter(|(id, _)| wanted(record.final_verdict(*id)));
    let names = chosen.filter_map(|(_, test)| {
        let suite = record.suites.get(test.plan.suite.index())?;
        Some((suite.plan.name.clone(), test.plan.name.clone()))
    });
    let only: Vec<_> = names.collect();
    if only.is_empty() {
        let which: Vec<_> = args.select.rerun.iter().map(|which| which.word()).collect();
        let what = format!("no test of `{run}` {}: nothing to run again", which.join(" or "));
        return Err(Failure::input(what));
    }
    let mut manifest = Manifest { only: Some(only), ..(*started.manifest).clone() };
    if let Some(profile) = &args.profile.profile {
        manifest.profile = Some(profile.clone());
    }
    manifest.set.extend(settings(args));
    Ok((manifest, Some(PathBuf::from(&started.working_dir))))
}

impl Rerun {
    fn is(self, verdict: Verdict) -> bool {
        let interrupted = matches!(verdict, Verdict::Interrupted | Verdict::Skipped);
        match self {
            Self::Failed => !verdict.is_green() && !interrupted,
            Self::Interrupted => interrupted,
        }
    }

    fn word(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Interrupted => "was interrupted or skipped",
        }
    }
}

/// The part with what decides over it.
fn divided(shard: Shard, by: &str, results: &ResultsArgs) -> Result<Shard, Failure> {
    let by = match by.split_once('=') {
        None if by == "hash" => ShardBy::Hash,
        None if by == "count" => ShardBy::Count,
        Some(("duration", run)) => ShardBy::Duration(durations(&record(results, run)?)),
        _ => {
            let what = format!("`--shard-by {by}`: expected `hash`, `count` or `duration=RUN`");
            return Err(Failure::input(what));
        }
    };
    Ok(Shard { by, ..shard })
}

fn durations(record: &Record) -> HashMap<(String, String), std::time::Duration> {
    let timed = record.tests.iter().filter_map(|test| {
        let suite = record.suites.get(test.plan.suite.index())?;
        Some(((suite.plan.name.clone(), test.plan.name.clone()), test.duration()))
    });
    timed.collect()
}

fn record(results: &ResultsArgs, run: &str) -> Result<Record, Failure> {
    let stored = journal::read(&show::find(results, run)?).map_err(show::unreadable)?;
    // Which of its tests have to be run is not certain.
    show::refuse_damaged(run, &stored.record)?;
    Ok(stored.record)
}

/// A number that is easy to type again.
fn some_seed() -> u64 {
    RandomState::new().build_hasher().finish() % 1_000_000
}

impl Asked {
    /// The selection; every mistake in a filter is added to the problems.
    pub fn selection(&self, problems: &mut Vec<Diagnostic>, sources: &mut SourceMap) -> Selection {
        let only = self.manifest.only.as_ref().map(|only| only.iter().cloned().collect());
        let filters = self.filters(problems, sources);
        Selection { filters, only, shuffle: self.manifest.shuffle, shard: self.shard.clone() }
    }

    fn filters(&self, problems: &mut Vec<Diagnostic>, sources: &mut SourceMap) -> Vec<Filter> {
        let mut filters = Vec::new();
        for (number, text) in (1..).zip(&self.manifest.filters) {
            let name = match self.manifest.filters.len() {
                1 => "--filter".to_owned(),
                _ => format!("--filter ({number})"),
            };
            let source = SourceText::new(name, text);
            match select::parse(&source) {
                Ok(filter) => filters.push(filter),
                Err(problem) => problems.push(*problem),
            }
            sources.add(Arc::new(source));
        }
        filters
    }
}
