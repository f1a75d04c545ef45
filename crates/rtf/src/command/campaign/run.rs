//! `rtf campaign run`: a campaign is checked, run by a [`Coordinator`] with a pool of workers, and
//! its claim is judged.

use std::collections::BTreeSet;
use std::fs::File;
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::time::{Duration, Instant};

use clap::ArgMatches;
use jiff::Timestamp;
use rtf_campaign::Ledger;
use rtf_campaign::file::{Goal, Versions};
use rtf_coordinator::coordinator::{CampaignEnd, Coordinator, episodes_of};
use rtf_coordinator::pool::{ClusterPool, LocalPool};
use rtf_coordinator::summary::{self, EarlyEnd};
use rtf_coordinator::worker::Answers;
use rtf_engine::signal::SignalListener;
use rtf_history::entry;
use rtf_plan::plan::Plan;
use rtf_report::escape;
use rtf_run::campaign::directory::{CampaignDir, CampaignJobs, Description};
use rtf_run::campaign::judged::Judged;
use rtf_run::campaign::start::CampaignStart;
use rtf_run::campaign::trials::{ComparedTrials, TrialVersions};
use rtf_run::campaign::{self, LoadedCampaign};
use rtf_run::diagnostics::count;
use rtf_run::error::Failure;
use rtf_run::history::campaigns;
use rtf_run::operator::Attendance;
use rtf_run::{plan, terminal};

use super::trials;
use crate::cli::{CampaignRunArgs, Executor, ProfileArgs};
use crate::command::VerbResult;
use crate::request::{self, config};

/// How often the end of the workers of a killed campaign is checked.
const POLL: Duration = Duration::from_millis(20);

/// A campaign that is to be run.
struct Started {
    loaded: LoadedCampaign,
    dir: CampaignDir,
    /// Locked while this process runs the campaign.
    lock: File,
    is_resumed: bool,
}

/// Runs a campaign, or continues one.
pub fn run(mut args: CampaignRunArgs, matches: &ArgMatches) -> VerbResult {
    config::fill_campaign(&mut args, matches)?;
    let target = request::target(args.no_history, &args.history, &args.results)?;
    let started = match &args.resume {
        Some(path) => reopen(path, &args)?,
        None => begin(&args)?,
    };
    let Started { loaded, dir, .. } = &started;
    if args.cluster.kubernetes.print {
        return print_job(&started, &args);
    }
    dir.write_judgement(None)?;
    let workers = match &dir.description.jobs {
        Some(jobs) => format!("up to {}", count(jobs.shards as usize, "task")),
        None => count(local_workers(&args), "worker"),
    };
    print_start(loaded, &workers)?;
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
    let end = runtime.map_err(Failure::internal)?.block_on(coordinate(&started, &args))?;
    let CampaignEnd { ledger, mut judgement, early_end } = end;
    dir.write_results(&summary::result_lines(&ledger, dir.recorded()))?;
    let end = history_end(early_end.as_ref());
    let compared = ComparedTrials::judge(dir, &ledger, &mut judgement)?;
    dir.write_judgement(Some(&Judged { ended_at: Timestamp::now(), end, judgement }))?;
    summary::print(&loaded.campaign, (&ledger, &judgement), early_end.as_ref(), &dir.path)?;
    trials::print(dir, compared.as_ref(), judgement.verdict)?;
    if let Some(target) = target.filter(|_| dir.versions().is_none()) {
        campaigns::import_ended(&target, dir);
    }
    Ok(ExitCode::from(summary::exit_code(&judgement, early_end.as_ref())))
}

fn print_start(loaded: &LoadedCampaign, workers: &str) -> Result<(), Failure> {
    let LoadedCampaign { name, campaign, episodes, .. } = loaded;
    let episodes = count(episodes.episodes.len(), campaign.noun());
    let goal = match &campaign.goal {
        Goal::Claim(claim) => format!("claim rate >= {}", claim.rate),
        Goal::Versions(Versions { values, blinded, .. }) => {
            let blinded = if *blinded { " (blinded)" } else { "" };
            format!("{}{blinded}", count(values.len(), "version"))
        }
    };
    let name = escape::line(name);
    terminal::stdout(|out| writeln!(out, "campaign {name}: {episodes}, {workers}, {goal}"))
}

/// Prints the manifest of the first job, which the user submits.
fn print_job(started: &Started, args: &CampaignRunArgs) -> VerbResult {
    let Started { loaded, dir, lock, .. } = started;
    let Some(settings) = &dir.description.jobs else {
        return Err(Failure::internal("there is no cluster"));
    };
    let episodes = &loaded.episodes.episodes;
    let mut ledger = Ledger::new(episodes.len(), loaded.campaign.repeats);
    let lists = episodes_of(&ledger.take(settings.shards as usize), episodes);
    ClusterPool::new(dir, lock, settings, args.shutdown_timeout).print(&lists)?;
    let dir = dir.path.to_string_lossy();
    let dir = shell_words::quote(&dir);
    let hint = "submit it with `kubectl create -f`, then follow it";
    terminal::notice(format!("hint: {hint}: `rtf campaign run --resume {dir}`"));
    Ok(ExitCode::SUCCESS)
}

/// How a campaign ended, for the history.
fn history_end(early_end: Option<&EarlyEnd>) -> entry::CampaignEnd {
    match early_end {
        None => entry::CampaignEnd::Finished,
        Some(EarlyEnd::HookFailed) => entry::CampaignEnd::HookFailed,
        Some(EarlyEnd::BenchBroken) => entry::CampaignEnd::BenchBroken,
        Some(EarlyEnd::Budget) => entry::CampaignEnd::OverBudget,
        Some(EarlyEnd::Signal(_)) => entry::CampaignEnd::Interrupted,
    }
}

fn local_workers(args: &CampaignRunArgs) -> usize {
    args.workers.map_or(1, |workers| usize::from(workers.get()))
}

/// Who answers the questions of workers on this machine.
fn answers(args: &CampaignRunArgs) -> Answers {
    match args.no_input {
        true => Answers::NoInput,
        false if Attendance::find(false, None).console => Answers::Operator,
        false => Answers::Nobody,
    }
}

/// Runs the episodes that have no result in a pool of workers.
async fn coordinate(started: &Started, args: &CampaignRunArgs) -> Result<CampaignEnd, Failure> {
    let Started { loaded, dir, lock, is_resumed } = started;
    let signals = SignalListener::install().map_err(Failure::internal)?;
    let read = |is_read: &dyn Fn(u32) -> bool| match is_resumed {
        true => {
            let mut ledger = campaign::read_ledger(loaded, dir, is_read);
            ledger.resume();
            ledger
        }
        false => Ledger::new(loaded.episodes.episodes.len(), loaded.campaign.repeats),
    };
    let (campaign, episodes) = (&loaded.campaign, &loaded.episodes.episodes);
    let Some(settings) = &dir.description.jobs else {
        let answers = answers(args);
        let pool = LocalPool::new(dir, local_workers(args), (args.shutdown_timeout, answers));
        let pool = if *is_resumed { pool } else { pool.checked() };
        let mut coordinator = Coordinator::new(campaign, episodes, read(&|_| true), pool)?;
        if answers == Answers::Operator {
            coordinator = coordinator.with_operator()?;
        }
        return coordinator.run(signals).await;
    };
    let pool = ClusterPool::open(dir, lock, settings, args.shutdown_timeout).await?;
    let followed: BTreeSet<u32> = pool.assignments().map(|it| it.worker).collect();
    let mut ledger = read(&|worker| !followed.contains(&worker));
    pool.assignments().for_each(|it| ledger.assign(it.left.iter().copied()));
    Coordinator::new(campaign, episodes, ledger, pool)?.run(signals).await
}

/// Opens the directory of an earlier campaign.
fn reopen(path: &Path, args: &CampaignRunArgs) -> Result<Started, Failure> {
    let dir = CampaignDir::open_judged(path)?;
    if let Some(jobs) = &dir.description.jobs {
        refuse_workers(args, jobs.cluster.name())?;
    }
    let lock = dir.lock()?;
    if dir.description.jobs.is_none() {
        wait_for_workers(&dir, args.shutdown_timeout)?;
    }
    Ok(Started { loaded: campaign::reload(&dir)?, dir, lock, is_resumed: true })
}

/// Waits until the workers of a campaign that was killed have torn down.
fn wait_for_workers(dir: &CampaignDir, limit: Duration) -> Result<(), Failure> {
    let begin = Instant::now();
    while dir.any_worker_runs() {
        if begin.elapsed() >= limit {
            let error = format!("workers of `{}` are still running", dir.path.display());
            return Err(Failure::input(error).hint("they end by themselves; try again later"));
        }
        std::thread::sleep(POLL);
    }
    Ok(())
}

/// Checks a new campaign, and creates its directory.
fn begin(args: &CampaignRunArgs) -> Result<Started, Failure> {
    let file = args.file.as_deref().unwrap_or(Path::new(""));
    let loaded = campaign::load(file)?;
    loaded.print_warnings()?;
    let (mut description, plan) = describe(&loaded, file, &args.profile, args.slots)?;
    description.jobs = jobs(args, &plan)?;
    description.start = Some(CampaignStart::find(&loaded, file, &description.working_dir));
    let parent = args.results.results.join("campaigns");
    let dir = CampaignDir::create(&parent, description, Some(&loaded.episodes))?;
    let lock = dir.lock()?;
    Ok(Started { loaded, dir, lock, is_resumed: false })
}

/// Checks the suite of a campaign, and describes a search, whose workers run on this machine.
pub fn describe_search(
    loaded: &LoadedCampaign,
    file: &Path,
    profile: &ProfileArgs,
) -> Result<Description, Failure> {
    let (description, _) = describe(loaded, file, profile, None)?;
    Ok(Description { is_search: true, ..description })
}

/// Checks the suite of a campaign, and describes what its workers run. Returns the plan, too.
pub fn describe(
    loaded: &LoadedCampaign,
    file: &Path,
    profile: &ProfileArgs,
    slots: Option<u32>,
) -> Result<(Description, Arc<Plan>), Failure> {
    let mut request = request::tests_of_suite(&loaded.suite, profile)?;
    request.set_episodes(loaded.suite.clone(), loaded.episodes.episodes.clone());
    request.slots = slots;
    let planned = plan::plan(&request)?;
    planned.print_warnings()?;
    let working_dir = request.options.runner.current_dir;
    let mut options = profile.to_options();
    options.extend(slots.map(|slots| format!("--slots={slots}")));
    let description = Description {
        name: loaded.name.clone(),
        file: working_dir.join(file),
        suite: working_dir.join(&loaded.suite),
        working_dir,
        repeats: loaded.campaign.repeats,
        options,
        variables: Vec::new(),
        is_search: false,
        jobs: None,
        versions: loaded.campaign.versions().map(TrialVersions::from),
        start: None,
    };
    Ok((description, planned.plan))
}

/// The jobs, if the episodes are to run in a cluster.
fn jobs(args: &CampaignRunArgs, plan: &Plan) -> Result<Option<CampaignJobs>, Failure> {
    request::cluster::refuse_unused(&args.cluster)?;
    if args.cluster.executor == Executor::Local {
        return Ok(None);
    }
    refuse_workers(args, &args.cluster.executor.to_string())?;
    let results = &args.results.results;
    let options = request::cluster::options(&args.cluster, results, args.shutdown_timeout)?;
    let resources = options.resources(plan);
    Ok(Some(CampaignJobs { shards: options.shards, resources, cluster: options.cluster }))
}

fn refuse_workers(args: &CampaignRunArgs, executor: &str) -> Result<(), Failure> {
    match args.workers {
        Some(_) => {
            let error = format!("`--workers` has no effect with `--executor {executor}`");
            Err(Failure::input(error).hint("`--shards N` is the number of tasks"))
        }
        None => Ok(()),
    }
}
