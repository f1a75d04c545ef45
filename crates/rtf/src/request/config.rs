//! Fills in the arguments that neither the command line nor a variable sets, from
//! `rtf.toml`. Its settings of suites are the planner's, [`rtf_plan::config`].

use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{ArgMatches, ValueEnum};
use rtf_plan::config::{self, ConfigFiles, ConfigRequest, RunConfig, RunValue};
use rtf_plan::suite::parse_duration;
use rtf_run::diagnostics;
use rtf_run::error::Failure;
use rtf_run::formats::{ReportFormat, ReportTarget, parse_report};

use crate::cli::{
    Annotations, CampaignRunArgs, FlakyResult, HistoryFileArgs, InputArgs, OrderOption,
    ProfileArgs, ResultsArgs, RunArgs, parse_fork_mode,
};

/// The profile and the parameters to use.
pub fn request(args: &ProfileArgs) -> ConfigRequest {
    ConfigRequest { profile: args.profile.clone(), params: args.set.clone() }
}

/// Fills in the arguments of `rtf run`.
pub fn fill_run(args: &mut RunArgs, matches: &ArgMatches) -> Result<(), Failure> {
    let defaults = ConfigDefaults::of_inputs(&args.input, matches)?.accepted()?;
    defaults.fill_results(&mut args.input.results);
    defaults
        .fill("annotations", &mut args.annotations, |text| Annotations::from_str(text, false).ok());
    defaults.fill("fork", &mut args.fork, |text| Some(parse_fork_mode(text)));
    defaults.fill("shutdown-timeout", &mut args.shutdown_timeout, |text| parse_duration(text).ok());
    defaults.fill("jobs", &mut args.jobs, |text| text.parse().ok());
    let duration = |text: &str| parse_duration(text).ok().map(Some);
    defaults.fill("lock-timeout", &mut args.lock_timeout, duration);
    let repeat = &mut args.input.repeat;
    defaults.fill("retries", &mut repeat.retries, |text| text.parse().ok().map(Some));
    defaults.fill("max-fail", &mut repeat.max_fail, |text| text.parse().ok().map(Some));
    let result = |text: &str| FlakyResult::from_str(text, false).ok().map(Some);
    defaults.fill("flaky-result", &mut repeat.flaky_result, result);
    // Each worker of a campaign would write the same files.
    if args.episodes.is_none() {
        args.reports.extend(defaults.reports());
    }
    defaults.fill_history(&mut args.input.history);
    if let Some(value) = defaults.value("history.enabled", "no_history") {
        args.no_history = text(value) == "false";
    }
    let select = &mut args.input.select;
    let names_test = |input: &PathBuf| input.to_string_lossy().contains("::");
    if select.rerun.is_empty() && !args.input.inputs.iter().any(names_test) {
        let order = |text: &str| OrderOption::from_str(text, false).ok().map(Some);
        if select.shuffle.is_none() {
            defaults.fill("order", &mut select.order, order);
        }
        defaults.fill("filter", &mut select.filters, |text| Some(vec![text.to_owned()]));
    }
    Ok(())
}

/// Fills in the results directory and the database of a verb that plans tests.
pub fn fill_results(args: &mut InputArgs, matches: &ArgMatches) -> Result<(), Failure> {
    let defaults = ConfigDefaults::of_inputs(args, matches)?.accepted()?;
    defaults.fill_results(&mut args.results);
    defaults.fill_history(&mut args.history);
    Ok(())
}

/// Fills in the results directory and the history of a campaign.
pub fn fill_campaign(args: &mut CampaignRunArgs, matches: &ArgMatches) -> Result<(), Failure> {
    let defaults = past_defaults(matches)?;
    defaults.fill_results(&mut args.results);
    defaults.fill_history(&mut args.history);
    if let Some(value) = defaults.value("history.enabled", "no_history") {
        args.no_history = text(value) == "false";
    }
    Ok(())
}

/// Fills in the results directory of `rtf watch`, unless `rtf.toml` has errors: each
/// run reports them.
pub fn fill_watched_results(args: &mut InputArgs, matches: &ArgMatches) -> Result<(), Failure> {
    let defaults = ConfigDefaults::of_inputs(args, matches)?;
    if defaults.config.problems.is_empty() {
        defaults.fill_results(&mut args.results);
    }
    Ok(())
}

/// Fills in the results directory of a verb that reads past runs.
pub fn fill_past_results(results: &mut ResultsArgs, matches: &ArgMatches) -> Result<(), Failure> {
    past_defaults(matches)?.fill_results(results);
    Ok(())
}

fn past_defaults(matches: &ArgMatches) -> Result<ConfigDefaults<'_>, Failure> {
    let profile = std::env::var("RTF_PROFILE").ok().filter(|name| !name.is_empty());
    let mut defaults =
        ConfigDefaults::find(&[], &ConfigRequest { profile, ..Default::default() }, matches)?;
    // Problems of the run's settings concern only new runs.
    defaults.config.problems.clone_from(&defaults.files.problems);
    defaults.accepted()
}

/// Fills in the results directory and the database of `rtf history`.
pub fn fill_history(
    results: &mut ResultsArgs,
    history: &mut HistoryFileArgs,
    matches: &ArgMatches,
) -> Result<(), Failure> {
    let defaults = past_defaults(matches)?;
    defaults.fill_results(results);
    defaults.fill_history(history);
    Ok(())
}

/// The values of `rtf.toml` for options.
struct ConfigDefaults<'a> {
    matches: &'a ArgMatches,
    current_dir: PathBuf,
    config: RunConfig,
    files: ConfigFiles,
}

impl<'a> ConfigDefaults<'a> {
    fn of_inputs(args: &InputArgs, matches: &'a ArgMatches) -> Result<Self, Failure> {
        // With `--rerun`, the input is a run.
        let inputs = if args.select.rerun.is_empty() { args.inputs.as_slice() } else { &[] };
        Self::find(inputs, &request(&args.profile), matches)
    }

    fn find(
        inputs: &[PathBuf],
        request: &ConfigRequest,
        matches: &'a ArgMatches,
    ) -> Result<Self, Failure> {
        let current_dir = std::env::current_dir().map_err(Failure::internal)?;
        let mut files = ConfigFiles::new(&current_dir);
        let mut dirs: Vec<PathBuf> =
            inputs.iter().map(|path| config::input_dir(&absolute(&current_dir, path))).collect();
        if dirs.is_empty() {
            dirs.push(current_dir.clone());
        }
        let config = RunConfig::collect(dirs.iter().map(PathBuf::as_path), request, &mut files);
        Ok(Self { matches, current_dir, config, files })
    }

    /// Reports problems of the files.
    fn accepted(self) -> Result<Self, Failure> {
        if self.config.problems.is_empty() {
            return Ok(self);
        }
        Err(diagnostics::refuse(&self.config.problems, &self.files.sources()))
    }

    /// The value for an option, unless the command line or a variable sets it.
    fn value(&self, key: &str, option: &str) -> Option<&RunValue> {
        let source = self.matches.value_source(option);
        let is_set = matches!(source, Some(ValueSource::CommandLine | ValueSource::EnvVariable));
        self.config.get(key).filter(|_| !is_set)
    }

    fn fill<T>(&self, key: &str, target: &mut T, parse: impl Fn(&str) -> Option<T>) {
        let option = if key == "filter" { "filters" } else { &key.replace('-', "_") };
        if let Some(value) = self.value(key, option).and_then(|value| parse(text(value))) {
            *target = value;
        }
    }

    fn fill_results(&self, args: &mut ResultsArgs) {
        if let Some(value) = self.value("results", "results") {
            args.results = self.path(value, Path::new(text(value)));
        }
    }

    fn fill_history(&self, args: &mut HistoryFileArgs) {
        let Some(value) = self.value("history.url", "history") else { return };
        let url = text(value);
        let path = url.strip_prefix("file:").unwrap_or(url);
        args.history = Some(match url.contains("://") {
            true => url.to_owned(),
            false => self.path(value, Path::new(path)).to_string_lossy().into_owned(),
        });
    }

    /// The reports, which are written in addition to those of the command line.
    fn reports(&self) -> impl Iterator<Item = (ReportFormat, ReportTarget)> {
        let values = self.config.get("reports").into_iter();
        let texts =
            values.flat_map(|value| value.entry.values.iter().map(move |text| (value, text)));
        texts.filter_map(|(value, text)| {
            let (format, target) = parse_report(&text.value).ok()?;
            let target = match target {
                ReportTarget::File(path) => ReportTarget::File(self.path(value, &path)),
                ReportTarget::Collector(_) => target,
            };
            Some((format, target))
        })
    }

    /// A path relative to the directory of its file.
    fn path(&self, value: &RunValue, path: &Path) -> PathBuf {
        let path = value.file.path.parent().unwrap_or(&self.current_dir).join(path);
        path.strip_prefix(&self.current_dir).map(Path::to_owned).unwrap_or(path)
    }
}

fn text(value: &RunValue) -> &str {
    value.entry.text().unwrap_or_default()
}

/// Makes a path absolute and removes `.` components.
pub fn absolute(current_dir: &Path, path: &Path) -> PathBuf {
    current_dir.join(path).components().collect()
}
