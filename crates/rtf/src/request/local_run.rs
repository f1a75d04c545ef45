//! A run on this machine.

use std::io;
use std::os::fd::AsFd as _;
use std::path::Path;

use rtf_engine::guard::Lifeline;
use rtf_engine::locks::LockOptions;
use rtf_plan::plan::CaseListing;
use rtf_run::campaign::directory::CampaignDir;
use rtf_run::campaign::{self, EpisodeStream};
use rtf_run::debug::DebugRequest;
use rtf_run::error::Failure;
use rtf_run::finish::ResultTargets;
use rtf_run::history;
use rtf_run::operator::Attendance;
use rtf_run::pipeline::Invocation;
use rtf_run::request::{OutputRequest, RunRequest, TestsRequest, WebRequest};
use rtf_run::revision::RevisionQuery;

use super::inputs;
use crate::cli::{DebugArgs, RunArgs, StdoutFormat};

/// A run on this machine.
pub struct LocalRun {
    /// What is known before the guard forks the runner.
    pub invocation: Invocation,
    /// Whether the tests are only listed.
    pub is_dry_run: bool,
    /// From which the runner's process makes the request: the guard stays small.
    pub source: RunSource,
}

/// The arguments of a run, in which [`super::config`] has been filled in.
pub struct RunSource {
    args: RunArgs,
    debug: Option<DebugRequest>,
}

impl LocalRun {
    /// A run, from arguments in which [`super::config`] has been filled in.
    pub fn new(
        args: RunArgs,
        debug: Option<DebugRequest>,
        (output, targets): (OutputRequest, ResultTargets),
    ) -> Result<Self, Failure> {
        let lifeline = lifeline(&args).map_err(Failure::internal)?;
        let patience = args.shutdown_timeout;
        Ok(Self {
            invocation: Invocation { output, targets, lifeline, patience },
            is_dry_run: args.dry_run,
            source: RunSource { args, debug },
        })
    }
}

/// Standard input, if the run ends with it.
fn lifeline(args: &RunArgs) -> io::Result<Option<Lifeline>> {
    let stdin = || io::stdin().as_fd().try_clone_to_owned();
    Ok(match (args.operator_on_stdin, args.end_with_stdin) {
        (true, _) => Some(Lifeline::Socket(stdin()?)),
        (false, true) => Some(Lifeline::Input(stdin()?)),
        (false, false) => None,
    })
}

impl RunSource {
    /// Reads past runs and standard input, and asks Git for the revision.
    pub fn resolve(self) -> Result<RunRequest, Failure> {
        let Self { mut args, debug } = self;
        if let (Some(_), [dir]) = (args.episode, args.input.inputs.as_slice())
            && dir.is_dir()
        {
            // The episode runs again as in its campaign.
            let description = CampaignDir::open(dir)?.description;
            args.input.profile.add_options(&description.options);
        }
        if let Some(option) = args.web.option_without_effect() {
            let error = format!("`{option}` has no effect without `--web`");
            return Err(Failure::input(error).hint("add `--web`"));
        }
        let mut tests = inputs::tests(&args.input)?;
        if tests.manifest.filters.is_empty() && !args.dry_run {
            tests.options.case_listing = CaseListing::IfNeeded;
        }
        set_episodes(&mut tests, &args)?;
        let revision = RevisionQuery::start(&tests.options.runner.current_dir);
        Ok(RunRequest {
            tests,
            results: args.input.results.results.clone(),
            results_option: "`--results DIR`",
            symlink: args.symlink.clone(),
            web: args.web.web.map(|address| WebRequest {
                settings: super::web_settings(address, &args.web.access),
                hint: None,
                linger: args.web.web_linger,
            }),
            fork_mode: args.fork,
            max_fail: args.input.repeat.max_fail(),
            locks: LockOptions { dir: super::locks_dir(), limit: args.lock_timeout },
            jobs: args.jobs,
            shutdown_timeout: args.shutdown_timeout,
            debug,
            attendance: attendance(&args),
            database: history::resolve(
                args.input.history.history.as_deref(),
                &args.input.results.results,
            )?,
            revision,
        })
    }
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
    if args.operator_on_stdin {
        return Attendance::of_campaign();
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
    (tests.slots, tests.is_checked) = (args.slots, args.checked);
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
