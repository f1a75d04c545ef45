//! Campaigns: files and directories of results, for the verbs that read them.

pub mod arrays;
pub mod directory;
pub mod episodes;
pub mod judged;
mod ranking;
pub mod report;
pub mod start;
mod stream;
pub mod trials;
pub mod version;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use rtf_campaign::episodes::Resolution;
use rtf_campaign::ranges::ranges;
use rtf_campaign::{Campaign, EpisodeList, Ledger, ParameterRange, parse, resolve};
use rtf_model::{Diagnostic, Episode, Severity};
use rtf_plan::suite::{SourceMap, read_source};

use crate::diagnostics;
use crate::error::Failure;
use directory::CampaignDir;
pub use stream::EpisodeStream;

/// A campaign file without errors, and its episodes.
pub struct LoadedCampaign {
    pub name: String,
    /// The suite file.
    pub suite: PathBuf,
    pub campaign: Campaign,
    pub episodes: EpisodeList,
    /// The values that the parameters can have.
    pub ranges: Vec<ParameterRange>,
    pub warnings: Vec<Diagnostic>,
    pub sources: SourceMap,
}

impl LoadedCampaign {
    pub fn print_warnings(&self) -> Result<(), Failure> {
        diagnostics::print(&self.warnings, &self.sources)
    }
}

/// Reads a campaign file; prints all its problems if one of them is an error.
pub fn load(file: &Path) -> Result<LoadedCampaign, Failure> {
    let mut sources = SourceMap::default();
    let source = read_source(file, &file.to_string_lossy()).map_err(|unreadable| {
        let mut sources = SourceMap::default();
        unreadable.source.into_iter().for_each(|source| sources.add(Arc::new(source)));
        diagnostics::refuse(&[unreadable.problem], &sources)
    })?;
    let source = Arc::new(source);
    sources.add(source.clone());
    let mut problems = Vec::new();
    let dir = file.parent().unwrap_or(Path::new(""));
    let campaign = parse(&source, &mut problems);
    let resolved = campaign.and_then(|campaign| {
        let (problems, sources) = (&mut problems, &mut sources);
        let mut resolution = Resolution { dir, source: &source, problems, sources };
        let episodes = resolve(&campaign, &mut resolution)?;
        let ranges = ranges(&campaign, &mut resolution)?;
        Some((campaign, episodes, ranges))
    });
    let has_error = problems.iter().any(|problem| problem.severity == Severity::Error);
    let Some((campaign, episodes, ranges)) = resolved.filter(|_| !has_error) else {
        return Err(diagnostics::refuse(&problems, &sources));
    };
    let stem = || file.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let name = campaign.name.as_ref().map(|name| name.value.clone()).or_else(stem);
    Ok(LoadedCampaign {
        name: name.unwrap_or_default(),
        suite: dir.join(&campaign.suite.value),
        campaign,
        episodes,
        ranges,
        warnings: problems,
        sources,
    })
}

/// Finds one episode: of a campaign file, or of the directory of a campaign's results. Returns the
/// suite, too.
pub fn find_episode(input: &Path, id: u64) -> Result<(PathBuf, Episode), Failure> {
    let (suite, episodes) = if input.is_dir() {
        let dir = CampaignDir::open(input)?;
        (dir.description.suite.clone(), visible_episodes(&dir)?)
    } else {
        let loaded = load(input)?;
        loaded.print_warnings()?;
        (loaded.suite, loaded.episodes)
    };
    let count = episodes.episodes.len();
    match episodes.episodes.into_iter().find(|episode| episode.id == id) {
        Some(episode) => Ok((suite, episode)),
        None => {
            let error = format!("`{}` has no episode {id}", input.display());
            Err(Failure::input(error).hint(format!("its episodes are 1 to {count}")))
        }
    }
}

/// Refuses a campaign with versions where an episode has only parameters.
pub fn refuse_versions(loaded: &LoadedCampaign) -> Result<(), Failure> {
    match loaded.campaign.versions() {
        None => Ok(()),
        Some(_) => {
            let error = format!("`{}` has `<versions>`, whose trials are compared", loaded.name);
            Err(Failure::input(error).hint("use a campaign with a `<claim>`"))
        }
    }
}

/// The episodes of a directory. Versions that are not hidden any more are shown when they run again.
fn visible_episodes(dir: &CampaignDir) -> Result<EpisodeList, Failure> {
    let mut list = dir.episodes()?;
    if dir.versions().is_some() && !dir.hides_versions(&stored_ledger(dir, list.episodes.len())) {
        list.episodes.iter_mut().for_each(|episode| episode.masked.clear());
    }
    Ok(list)
}

/// Opens the directory of an earlier campaign, and reads its results.
pub fn read_results(path: &Path) -> Result<(LoadedCampaign, CampaignDir, Ledger), Failure> {
    let dir = CampaignDir::open_judged(path)?;
    let loaded = reload(&dir)?;
    let ledger = read_ledger(&loaded, &dir, |_| true);
    Ok((loaded, dir, ledger))
}

/// Reads the campaign file of an earlier campaign, whose episodes must be the same.
pub fn reload(dir: &CampaignDir) -> Result<LoadedCampaign, Failure> {
    let loaded = load(&dir.description.file)?;
    if loaded.episodes != dir.episodes()? {
        let file = dir.description.file.display();
        let error = format!("`{file}` has other episodes than when the campaign was started");
        return Err(Failure::input(error).hint("undo its changes, or start a new campaign"));
    }
    Ok(loaded)
}

/// Reads the results of some workers of an earlier campaign.
pub fn read_ledger(
    loaded: &LoadedCampaign,
    dir: &CampaignDir,
    is_read: impl Fn(u32) -> bool,
) -> Ledger {
    let ledger = Ledger::new(loaded.episodes.episodes.len(), loaded.campaign.repeats);
    recorded_ledger(ledger, dir, is_read)
}

/// Reads the results of all workers of a directory with this number of episodes.
pub fn stored_ledger(dir: &CampaignDir, episodes: usize) -> Ledger {
    recorded_ledger(Ledger::new(episodes, dir.description.repeats), dir, |_| true)
}

fn recorded_ledger(mut ledger: Ledger, dir: &CampaignDir, is_read: impl Fn(u32) -> bool) -> Ledger {
    let workers = dir.workers().into_iter().filter(|worker| is_read(*worker));
    for line in workers.flat_map(|worker| dir.recorded_by(worker)) {
        if let Some(outcome) = line.outcome {
            ledger.record(line.episode, outcome, line.reason);
        }
    }
    ledger
}

pub fn read_list(file: &Path) -> Result<EpisodeList, Failure> {
    let name = file.display();
    let text = std::fs::read_to_string(file)
        .map_err(|error| Failure::input(format!("cannot read `{name}`: {error}")))?;
    EpisodeList::from_json_lines(&text).map_err(|(line, error)| {
        let error = format!("{name}:{line}: this is not an episode: {error}");
        Failure::input(error).hint("`rtf campaign episodes FILE` prints a list")
    })
}
