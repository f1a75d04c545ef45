//! Arguments → request: what the user asks for, with the values of `rtf.toml` and of
//! past runs filled in. Everything after this stage reads the request only.

pub mod config;
mod failed_cases;
mod inputs;
pub mod past_run;
mod past_tests;

use std::num::NonZeroU16;
use std::path::{Path, PathBuf};
use std::time::Duration;

use rtf_engine::locks::{self, LockOptions};
use rtf_process::fork_server::ForkMode;
use rtf_web::{Limits, Settings};

use crate::campaign::{self, EpisodeStream};
use crate::cli::{Annotations, ReportFormat, ReportTarget, RunArgs, StdoutFormat, WebAccessArgs};
use crate::collector::Collector;
use crate::debug::DebugRequest;
use crate::error::Failure;
use crate::history::{self, HistoryTarget};
use crate::operator::Attendance;
use crate::revision::RevisionQuery;
use rtf_plan::plan::CaseListing;

pub use inputs::TestsRequest;

/// A run.
pub struct RunRequest {
    pub tests: TestsRequest,
    pub results: PathBuf,
    /// How to choose another results directory, for hints.
    pub results_option: &'static str,
    /// A further symbolic link to the directory of the run.
    pub symlink: Option<PathBuf>,
    pub web: Option<WebRequest>,
    pub fork_mode: ForkMode,
    /// The number of failed tests after which the remaining tests are skipped.
    pub max_fail: Option<u32>,
    pub locks: LockOptions,
    pub jobs: NonZeroU16,
    /// How long the run may take to end after a signal or a request to stop.
    pub shutdown_timeout: Duration,
    /// How the only test is debugged.
    pub debug: Option<DebugRequest>,
    /// Who can answer questions of tests.
    pub attendance: Attendance,
    /// Where the run is imported when it has ended.
    pub history: Option<HistoryTarget>,
    /// Which collectors get the trace of the run when it has ended.
    pub collectors: Vec<Collector>,
    /// The revision of the sources, which Git finds out during the planning.
    pub revision: RevisionQuery,
}

/// What `rtf run` prints, and the reports that it writes.
pub struct OutputRequest {
    pub format: StdoutFormat,
    pub verbose: bool,
    /// Never [`Annotations::Auto`].
    pub annotations: Annotations,
    pub reports: Vec<(ReportFormat, PathBuf)>,
    /// The results directory.
    pub results: PathBuf,
    /// Whether a progress bar may be shown.
    pub progress: bool,
}

/// The web server of a run.
pub struct WebRequest {
    pub settings: Settings,
    /// How to choose another address, for hints.
    pub hint: Option<&'static str>,
    pub linger: Option<Duration>,
}

impl OutputRequest {
    /// Resolves the arguments of `rtf run`, in which [`config`] has been filled in.
    pub fn resolve(args: &RunArgs) -> Self {
        Self {
            format: args.format,
            verbose: args.verbose,
            annotations: detect_host(args.annotations),
            reports: args.reports.iter().filter_map(report_file).collect(),
            results: args.input.results.results.clone(),
            progress: true,
        }
    }
}

impl RunRequest {
    /// Resolves the arguments of `rtf run`, in which [`config`] has been filled in.
    pub fn resolve(args: &RunArgs) -> Result<Self, Failure> {
        if let Some(option) = args.web.option_without_effect() {
            let error = format!("`{option}` has no effect without `--web`");
            return Err(Failure::input(error).hint("add `--web`"));
        }
        let mut tests = TestsRequest::resolve(&args.input)?;
        if tests.manifest.filters.is_empty() && !args.dry_run {
            tests.options.case_listing = CaseListing::IfNeeded;
        }
        set_episodes(&mut tests, args)?;
        let revision = RevisionQuery::start(&tests.options.runner.current_dir);
        Ok(Self {
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
            attendance: Attendance::find(args),
            history: history_target(args)?,
            collectors: collectors(args)?,
            revision,
        })
    }
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

/// Which collectors get the trace of a run when it has ended.
pub fn collectors(args: &RunArgs) -> Result<Vec<Collector>, Failure> {
    let addresses = args.reports.iter().filter_map(|(_, target)| match target {
        ReportTarget::File(_) => None,
        ReportTarget::Collector(address) => Some(address),
    });
    addresses.map(|address| Collector::resolve(address)).collect()
}

/// Where a run is imported when it has ended.
pub fn history_target(args: &RunArgs) -> Result<Option<HistoryTarget>, Failure> {
    history::target(args.no_history, &args.input.history, &args.input.results)
}

/// Resolves [`Annotations::Auto`].
fn detect_host(annotations: Annotations) -> Annotations {
    let is_true = |name: &str| std::env::var_os(name).is_some_and(|value| value == "true");
    match annotations {
        Annotations::Auto if is_true("GITHUB_ACTIONS") => Annotations::Github,
        Annotations::Auto if is_true("GITLAB_CI") => Annotations::Gitlab,
        Annotations::Auto => Annotations::None,
        other => other,
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
