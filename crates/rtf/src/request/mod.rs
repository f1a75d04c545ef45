//! Arguments → request: what the user asks for, with the values of `rtf.toml` and of
//! past runs filled in. Everything after this stage reads the request only.

pub mod cluster;
pub mod config;
mod inputs;

use std::path::{Path, PathBuf};

use rtf_engine::locks::{self, LockOptions};
use rtf_plan::plan::CaseListing;
use rtf_run::campaign::{self, EpisodeStream};
use rtf_run::collector::Collector;
use rtf_run::debug::DebugRequest;
use rtf_run::error::Failure;
use rtf_run::finish::ResultTargets;
use rtf_run::formats::{self, OutputFormat, ReportFormat, ReportTarget};
use rtf_run::history::{self, HistoryTarget};
use rtf_run::operator::Attendance;
use rtf_run::request::{OutputRequest, RunRequest, TestsRequest, WebRequest};
use rtf_run::revision::RevisionQuery;
use rtf_web::{Limits, Settings};

use crate::cli::{
    Annotations, DebugArgs, HistoryFileArgs, ResultsArgs, RunArgs, StdoutFormat, WebAccessArgs,
};

pub use inputs::{tests, tests_in_shard, tests_of_suite};

/// What `rtf run` prints and writes.
pub fn output(args: &RunArgs) -> OutputRequest {
    OutputRequest {
        format: match args.format {
            StdoutFormat::Console => OutputFormat::Console,
            StdoutFormat::Json => OutputFormat::Json,
            StdoutFormat::Tap => OutputFormat::Tap,
        },
        verbose: args.verbose,
        annotations: annotations(args.annotations),
        reports: args.reports.iter().filter_map(report_file).collect(),
        results: args.input.results.results.clone(),
        progress: true,
    }
}

/// A run, from arguments in which [`config`] has been filled in.
pub fn run(args: &RunArgs) -> Result<RunRequest, Failure> {
    if let Some(option) = args.web.option_without_effect() {
        let error = format!("`{option}` has no effect without `--web`");
        return Err(Failure::input(error).hint("add `--web`"));
    }
    let mut tests = tests(&args.input)?;
    if tests.manifest.filters.is_empty() && !args.dry_run {
        tests.options.case_listing = CaseListing::IfNeeded;
    }
    set_episodes(&mut tests, args)?;
    let revision = RevisionQuery::start(&tests.options.runner.current_dir);
    Ok(RunRequest {
        tests,
        results: args.input.results.results.clone(),
        results_option: "`--results DIR`",
        symlink: args.symlink.clone(),
        web: args.web.web.map(|address| WebRequest {
            settings: web_settings(address, &args.web.access),
            hint: None,
            linger: args.web.web_linger,
        }),
        fork_mode: args.fork,
        max_fail: args.input.repeat.max_fail(),
        locks: LockOptions { dir: locks_dir(), limit: args.lock_timeout },
        jobs: args.jobs,
        shutdown_timeout: args.shutdown_timeout,
        debug: None,
        attendance: attendance(args),
        database: history::resolve(
            args.input.history.history.as_deref(),
            &args.input.results.results,
        )?,
        revision,
    })
}

/// How the only test is debugged; `None` if none is.
pub fn debug(args: &DebugArgs, run: &RunArgs) -> Result<Option<DebugRequest>, Failure> {
    if args.debug_wait {
        return Ok(Some(DebugRequest::waiting()));
    }
    if args.debugger.is_none() && !args.debug {
        return Ok(None);
    }
    if run.format != StdoutFormat::Console {
        let error = "the test's output would be mixed with that of `--format`";
        return Err(Failure::input(error).hint("leave `--format` out"));
    }
    DebugRequest::in_terminal(args.debugger.as_deref()).map(Some)
}

/// Who can answer the questions of tests.
fn attendance(args: &RunArgs) -> Attendance {
    if args.no_input {
        return Attendance::on_page(false, "`--no-input` is set");
    }
    let reads_episodes = args.episodes.as_deref() == Some("-".as_ref());
    let obstacle = if args.format != StdoutFormat::Console {
        Some("standard output has another format")
    } else if args.end_with_stdin || reads_episodes {
        Some("standard input has another use")
    } else {
        None
    };
    Attendance::find(args.web.web.is_some(), obstacle)
}

/// The episodes of a campaign that `args` select.
fn set_episodes(tests: &mut TestsRequest, args: &RunArgs) -> Result<(), Failure> {
    if args.episode.is_none() && args.episodes.is_none() {
        return Ok(());
    }
    let option = if args.episode.is_some() { "--episode" } else { "--episodes" };
    let [input] = args.input.inputs.as_slice() else {
        return Err(Failure::input(format!("`{option}` takes exactly one FILE")));
    };
    if let Some(id) = args.episode {
        let (suite, episode) = campaign::find_episode(input, id)?;
        tests.set_episodes(suite, vec![episode]);
    } else if args.episodes.as_deref() == Some(Path::new("-")) {
        let (first, stream) = EpisodeStream::open()?;
        tests.episode_stream = Some(stream);
        tests.set_episodes(input.clone(), vec![first]);
    } else if let Some(list) = &args.episodes {
        let episodes = campaign::read_list(list)?.episodes;
        if episodes.is_empty() {
            return Err(Failure::input(format!("`{}` has no episode", list.display())));
        }
        tests.set_episodes(input.clone(), episodes);
    }
    Ok(())
}

fn report_file((format, target): &(ReportFormat, ReportTarget)) -> Option<(ReportFormat, PathBuf)> {
    match target {
        ReportTarget::File(path) => Some((*format, path.clone())),
        ReportTarget::Collector(_) => None,
    }
}

/// Where the results of a run go. A session with a debugger says nothing about the test.
pub fn targets(args: &RunArgs, is_debugged: bool) -> Result<ResultTargets, Failure> {
    let addresses = args.reports.iter().filter_map(|(_, target)| match target {
        ReportTarget::File(_) => None,
        ReportTarget::Collector(address) => Some(address),
    });
    let no_history = args.no_history || is_debugged;
    Ok(ResultTargets {
        history: target(no_history, &args.input.history, &args.input.results)?,
        collectors: addresses
            .map(|address| Collector::resolve(address))
            .collect::<Result<_, _>>()?,
    })
}

/// Where runs and campaigns are imported; `None`: they are not.
pub fn target(
    no_history: bool,
    history: &HistoryFileArgs,
    results: &ResultsArgs,
) -> Result<Option<HistoryTarget>, Failure> {
    let resolve = || HistoryTarget::resolve(history.history.as_deref(), &results.results);
    (!no_history).then(resolve).transpose()
}

/// The code host for which annotations are printed, which may be found in the environment.
fn annotations(option: Annotations) -> formats::Annotations {
    let is_true = |name: &str| std::env::var_os(name).is_some_and(|value| value == "true");
    match option {
        Annotations::Github => formats::Annotations::Github,
        Annotations::Gitlab => formats::Annotations::Gitlab,
        Annotations::Auto if is_true("GITHUB_ACTIONS") => formats::Annotations::Github,
        Annotations::Auto if is_true("GITLAB_CI") => formats::Annotations::Gitlab,
        Annotations::Auto | Annotations::None => formats::Annotations::None,
    }
}

/// The settings of a web server.
pub fn web_settings(address: std::net::SocketAddr, args: &WebAccessArgs) -> Settings {
    Settings {
        address,
        allow_remote: args.web_allow_remote,
        token_file: args.web_token_file.clone(),
        tls: args.web_cert.clone().zip(args.web_key.clone()),
        hosts: args.web_hosts.clone(),
        limits: Limits::default(),
    }
}

/// The directory of this machine's locks.
pub fn locks_dir() -> PathBuf {
    let dir = std::env::var_os(locks::DIR_VARIABLE).filter(|dir| !dir.is_empty());
    dir.map_or_else(|| PathBuf::from(locks::DEFAULT_DIR), PathBuf::from)
}
