//! Finds directories of campaigns and imports them.

use std::collections::{HashMap, HashSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use rtf_campaign::{Judgement, Ledger, Verdict};
use rtf_history::entry::{CampaignEnd, CampaignEntry, CampaignInfo, EpisodeEntry};
use rtf_history::{ImportOutcome, Store, StoreError, SuiteFileBase};
use rtf_model::{Episode, EpisodeOutcome};
use rtf_report::episode_results::EpisodeLine;
use rtf_report::run_dir::LATEST;

use super::{CATCH_UP_LIMIT, HistoryTarget, warning};
use crate::campaign::arrays::CampaignArray;
use crate::campaign::directory::{CampaignDir, DESCRIPTION};
use crate::campaign::judged::Judged;
use crate::campaign::start::CampaignStart;
use crate::error::Failure;
use crate::terminal;

/// The directory of campaigns in a results directory.
const CAMPAIGNS: &str = "campaigns";

/// The result of the import of a campaign.
#[derive(Debug)]
pub enum CampaignImport {
    /// It was read.
    Done(ImportOutcome),
    /// It is still running.
    Active,
    /// It cannot be read.
    Unreadable(String),
    /// It cannot be stored.
    Store(StoreError),
}

/// The directories of campaigns in a results directory that are not `known` by name, the oldest
/// first.
pub fn missing(results: &Path, known: &HashSet<String>) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(results.join(CAMPAIGNS)) else { return Vec::new() };
    let names = entries.filter_map(|entry| entry.ok()?.file_name().into_string().ok());
    let mut names: Vec<_> = names.filter(|name| name != LATEST && !known.contains(name)).collect();
    names.sort_unstable();
    let dirs = names.into_iter().map(|name| results.join(CAMPAIGNS).join(name));
    dirs.filter(|dir| is_campaign(dir)).collect()
}

/// The campaigns of a results directory, or a campaign's directory itself, the oldest first.
pub fn below(path: &Path) -> Vec<PathBuf> {
    if is_campaign(path) { vec![path.to_owned()] } else { missing(path, &HashSet::new()) }
}

/// Whether it is the directory of a campaign with a claim: versions have no rate for the history.
fn is_campaign(dir: &Path) -> bool {
    let has_versions = || CampaignDir::open(dir).is_ok_and(|dir| dir.versions().is_some());
    dir.join(DESCRIPTION).is_file() && !has_versions()
}

/// Imports a campaign.
pub fn import(
    path: &Path,
    import: impl FnOnce(&CampaignEntry) -> Result<ImportOutcome, StoreError>,
) -> CampaignImport {
    let dir = match CampaignDir::open_judged(path) {
        Ok(dir) => dir,
        Err(failure) => return CampaignImport::Unreadable(failure.text()),
    };
    if dir.lock().is_err() || dir.any_worker_runs() || has_job(&dir) {
        return CampaignImport::Active;
    }
    match entry(&dir) {
        Err(failure) => CampaignImport::Unreadable(failure.text()),
        Ok(entry) => import(&entry).map_or_else(CampaignImport::Store, CampaignImport::Done),
    }
}

/// Whether tasks of a cluster may still run, although no process follows them.
fn has_job(dir: &CampaignDir) -> bool {
    CampaignArray::find_active(dir).is_ok_and(|array| array.is_some())
}

/// Imports a campaign that has ended, and earlier ones that are not in the history. Prints one
/// warning if that fails.
pub fn import_ended(target: &HistoryTarget, dir: &CampaignDir) {
    let entry = match entry(dir) {
        Ok(entry) => entry,
        Err(failure) => return warn(&failure.text()),
    };
    let imported = Store::open(&target.database).and_then(|mut store| {
        store.keep_log()?;
        store.import_campaign(&entry)?;
        catch_up(&mut store, target)
    });
    if let Err(error) = imported {
        warn(&warning("campaign", &error));
    }
}

fn warn(text: &str) {
    terminal::notice(format!("warning: {text}"));
}

fn catch_up(store: &mut Store, target: &HistoryTarget) -> Result<(), StoreError> {
    let started = Instant::now();
    let known = store.campaign_directories()?;
    for dir in missing(&target.results, &known) {
        if started.elapsed() > CATCH_UP_LIMIT {
            break;
        }
        let imported = import(&dir, |entry| store.import_campaign(entry));
        if let CampaignImport::Store(error @ (StoreError::Locked { .. } | StoreError::Io { .. })) =
            imported
        {
            return Err(error);
        }
    }
    Ok(())
}

/// What the history stores of a campaign: only its directory is read, so that it can be imported
/// at any time.
fn entry(dir: &CampaignDir) -> Result<CampaignEntry, Failure> {
    let Some(start) = &dir.description.start else {
        let error = format!("the campaign `{}` has no id", dir.path.display());
        return Err(
            Failure::input(error).hint("it is a search, or was run by an earlier version of rtf")
        );
    };
    let Some(claim) = start.claim else {
        return Err(Failure::input("a campaign with versions has no rate for the history"));
    };
    let list = dir.episodes()?.episodes;
    let results = Results::read(dir, start, list.len())?;
    let mut lines: HashMap<u64, EpisodeLine> = HashMap::new();
    lines.extend(results.lines.into_iter().map(|line| (line.episode, line)));
    let ran = list.iter().filter_map(|it| Some(episode(it, lines.get(&it.id)?)));
    let episodes: Vec<_> = ran.flatten().collect();
    let names = list.first().map(|it| it.parameters.iter().map(|it| it.name.clone()).collect());
    Ok(CampaignEntry {
        info: info(dir, (start, claim), (&results.judged, list.len(), episodes.len())),
        parameters: names.unwrap_or_default(),
        episodes,
    })
}

/// The last result of each episode, and the judgement.
struct Results {
    lines: Vec<EpisodeLine>,
    judged: Judged,
}

impl Results {
    fn read(dir: &CampaignDir, start: &CampaignStart, planned: usize) -> Result<Self, Failure> {
        if let Some(judged) = Judged::read(&dir.path) {
            return Ok(Self { lines: dir.results()?, judged });
        }
        // It was killed.
        let judge = start.judge(planned);
        let judge = judge.ok_or_else(|| Failure::input("the claim cannot be judged"))?;
        let mut lines = dir.recorded();
        lines.retain(|line| line.outcome.is_some());
        let mut ledger = Ledger::new(planned, dir.description.repeats);
        for EpisodeLine { episode, outcome, reason, .. } in &lines {
            if let Some(outcome) = outcome {
                ledger.record(*episode, *outcome, reason.clone());
            }
        }
        let judgement = judge.judge(&ledger.results());
        let (ended_at, end) = (start.started_at, CampaignEnd::Unfinished);
        Ok(Self { lines, judged: Judged { ended_at, end, judgement } })
    }
}

fn episode(episode: &Episode, line: &EpisodeLine) -> Option<EpisodeEntry> {
    let outcome = match line.outcome? {
        EpisodeOutcome::Passed => "passed",
        EpisodeOutcome::Failed => "failed",
        EpisodeOutcome::Error => "error",
        EpisodeOutcome::Collapsed => "collapsed",
    };
    Some(EpisodeEntry {
        id: episode.id,
        seed: episode.seed,
        outcome: outcome.to_owned(),
        reason: line.reason.clone(),
        duration_us: i64::try_from(line.duration_us).unwrap_or(i64::MAX),
        values: episode.parameters.iter().map(|parameter| parameter.value.clone()).collect(),
    })
}

fn info(
    dir: &CampaignDir,
    (start, claim): (&CampaignStart, f64),
    (judged, planned, run): (&Judged, usize, usize),
) -> CampaignInfo {
    let description = &dir.description;
    let revision = start.revision.as_ref();
    let inside = revision.and_then(|revision| revision.dir.as_deref()).unwrap_or_default();
    let base = SuiteFileBase::of_dir(&description.working_dir, Path::new(inside));
    let option = |prefix: &'static str| {
        let values = description.options.iter().filter_map(move |it| it.strip_prefix(prefix));
        values.map(str::to_owned)
    };
    let Judgement { verdict, passed, failed, without_result, rate, .. } = judged.judgement;
    // `latest` leads to a directory with another name.
    let path = fs::canonicalize(&dir.path).unwrap_or_else(|_| dir.path.clone());
    CampaignInfo {
        id: start.origin.id.clone(),
        directory: path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        name: description.name.clone(),
        file: base.normalize(&description.file.to_string_lossy()),
        suite_file: base.normalize(&description.suite.to_string_lossy()),
        started: micros(start.started_at),
        ended: micros(judged.ended_at),
        end: judged.end,
        commit: revision.map(|revision| revision.commit.clone()),
        branch: revision.and_then(|revision| revision.branch.clone()),
        dirty: revision.and_then(|revision| revision.dirty),
        author_time: revision.and_then(|revision| revision.author_time.clone()),
        ci_job: start.origin.ci_job.clone(),
        host: start.origin.host.clone(),
        profile: option("--profile=").next(),
        set: option("--set=").collect(),
        rtf: start.rtf.clone(),
        seed: start.seed,
        space: start.space.clone(),
        claim,
        rule: start.rule().to_owned(),
        confidence: start.interval_confidence(),
        verdict: match verdict {
            Verdict::Passed => "passed",
            Verdict::Failed => "failed",
            Verdict::Undecided => "undecided",
        }
        .to_owned(),
        planned: planned as u64,
        run: run as u64,
        passed,
        failed,
        without_result,
        rate,
    }
}

/// The precision of the database.
fn micros(time: jiff::Timestamp) -> jiff::Timestamp {
    jiff::Timestamp::from_microsecond(time.as_microsecond()).unwrap_or(time)
}
