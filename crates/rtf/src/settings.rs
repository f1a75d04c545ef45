//! What `rtf.toml` says about a run, put where the command line says nothing.
//!
//! What it says about suites is the planner's, [`rtf_plan::config`].

use std::path::{Path, PathBuf};

use clap::parser::ValueSource;
use clap::{ArgMatches, ValueEnum};
use rtf_plan::config::{self, ConfigFiles, ConfigRequest, RunConfig, RunValue};
use rtf_plan::suite::parse_duration;

use crate::cli::{
    Annotations, Command, FlakyResult, InputArgs, ProfileArgs, RunArgs, forks, parse_report,
};
use crate::command::planning;
use crate::error::Failure;

/// Fills in what was not typed.
pub fn settle(command: &mut Command, matches: &ArgMatches) -> Result<(), Failure> {
    let Some((_, matches)) = matches.subcommand() else { return Ok(()) };
    let current = std::env::current_dir().map_err(Failure::own)?;
    let settled = Settled { matches, current };
    match command {
        Command::Run(args) => settled.run(args),
        Command::Watch(args) => {
            settled.watch(args);
            Ok(())
        }
        Command::Check(args) => {
            let found = settled.of_inputs(&args.input)?;
            settled.results(&found, &mut args.results.results);
            Ok(())
        }
        Command::List(args) => {
            let found = settled.of_inputs(&args.input)?;
            settled.results(&found, &mut args.results.results);
            Ok(())
        }
        Command::Show(args) => settled.past(&mut args.results.results),
        Command::Report(args) => settled.past(&mut args.results.results),
        Command::Merge(args) => settled.past(&mut args.results.results),
        _ => Ok(()),
    }
}

/// What the profile arguments ask for.
pub fn asked(args: &ProfileArgs) -> ConfigRequest {
    ConfigRequest { profile: args.profile.clone(), params: args.set.clone() }
}

struct Settled<'a> {
    matches: &'a ArgMatches,
    current: PathBuf,
}

impl Settled<'_> {
    /// Whether neither the command line nor a variable says it.
    fn is_open(&self, id: &str) -> bool {
        !matches!(
            self.matches.value_source(id),
            Some(ValueSource::CommandLine | ValueSource::EnvVariable)
        )
    }

    fn find(&self, inputs: &[PathBuf], asked: &ConfigRequest) -> (RunConfig, ConfigFiles) {
        let mut files = ConfigFiles::new(&self.current);
        let folders: Vec<PathBuf> = match inputs {
            [] => vec![self.current.clone()],
            inputs => inputs
                .iter()
                .map(|path| config::input_dir(&absolute(&self.current, path)))
                .collect(),
        };
        let run = RunConfig::collect(folders.iter().map(PathBuf::as_path), asked, &mut files);
        (run, files)
    }

    /// The planner tells what is wrong with the files; only it knows all of them.
    fn of_inputs(&self, input: &InputArgs) -> Result<RunConfig, Failure> {
        // With `--rerun` the input is a run.
        let inputs = if input.select.rerun.is_empty() { input.inputs.as_slice() } else { &[] };
        let (run, files) = self.find(inputs, &asked(&input.profile));
        if run.problems.is_empty() {
            return Ok(run);
        }
        Err(planning::refused(&run.problems, &files.sources())?)
    }

    /// Each round tells what is wrong with the files.
    fn watch(&self, args: &mut RunArgs) {
        let inputs = if args.input.select.rerun.is_empty() { &*args.input.inputs } else { &[] };
        let (run, _) = self.find(inputs, &asked(&args.input.profile));
        if run.problems.is_empty() {
            self.results(&run, &mut args.results.results);
        }
    }

    fn past(&self, results: &mut PathBuf) -> Result<(), Failure> {
        let profile = std::env::var("RTF_PROFILE").ok().filter(|name| !name.is_empty());
        let asked = ConfigRequest { profile, ..ConfigRequest::default() };
        let (run, files) = self.find(&[], &asked);
        if !files.problems.is_empty() {
            return Err(planning::refused(&files.problems, &files.sources())?);
        }
        self.results(&run, results);
        Ok(())
    }

    fn results(&self, run: &RunConfig, results: &mut PathBuf) {
        if let Some(value) = run.get("results").filter(|_| self.is_open("results")) {
            *results = self.path(value, text(value));
        }
    }

    fn run(&self, args: &mut RunArgs) -> Result<(), Failure> {
        let run = self.of_inputs(&args.input)?;
        self.results(&run, &mut args.results.results);
        let open = |key: &str, id: &str| run.get(key).filter(|_| self.is_open(id)).map(text);
        if let Some(word) = open("annotations", "annotations") {
            args.annotations = Annotations::from_str(word, false).unwrap_or_default();
        }
        if let Some(word) = open("fork", "fork") {
            args.fork = forks(word);
        }
        if let Some(limit) = open("shutdown-timeout", "shutdown_timeout") {
            args.shutdown_timeout = parse_duration(limit).unwrap_or(args.shutdown_timeout);
        }
        if let Some(jobs) = open("jobs", "jobs") {
            args.jobs = jobs.parse().unwrap_or(args.jobs);
        }
        if let Some(limit) = open("lock-timeout", "lock_timeout") {
            args.lock_timeout = parse_duration(limit).ok();
        }
        let repeat = &mut args.input.repeat;
        if let Some(retries) = open("retries", "retries") {
            repeat.retries = retries.parse().ok();
        }
        if let Some(result) = open("flaky-result", "flaky_result") {
            repeat.flaky_result = FlakyResult::from_str(result, false).ok();
        }
        if let Some(most) = open("max-fail", "max_fail").filter(|_| !repeat.until_fail) {
            repeat.max_fail = most.parse().ok();
        }
        if let Some(value) = run.get("reports") {
            let texts = value.entry.values.iter();
            let reports = texts.filter_map(|text| parse_report(&text.value).ok());
            args.reports.extend(reports.map(|(format, path)| {
                let path = self.path(value, &path.to_string_lossy());
                (format, path)
            }));
        }
        let names_tests =
            args.input.inputs.iter().any(|input| input.to_string_lossy().contains("::"));
        let chosen = names_tests || !args.input.select.rerun.is_empty();
        if let Some(filter) = open("filter", "filters").filter(|_| !chosen) {
            args.input.select.filters.push(filter.to_owned());
        }
        Ok(())
    }

    /// A path that begins in the folder of the file that names it.
    fn path(&self, value: &RunValue, path: &str) -> PathBuf {
        let folder = value.file.path.parent().unwrap_or(&self.current);
        let path = folder.join(path);
        path.strip_prefix(&self.current).map(Path::to_owned).unwrap_or(path)
    }
}

fn text(value: &RunValue) -> &str {
    value.entry.text().unwrap_or_default()
}

fn absolute(current: &Path, path: &Path) -> PathBuf {
    current.join(path).components().collect()
}
