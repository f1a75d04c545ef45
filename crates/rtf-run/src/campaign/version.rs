//! The versions that `rtf campaign compare` and `plan` read: directories of campaigns, and files of
//! other programs.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use rtf_campaign::comparison::{ComparedEpisode, MeasurementKey};
use rtf_campaign::file::StoppingRule;
use rtf_campaign::results_file::{read_csv, read_lerobot};
use rtf_campaign::{EpisodeResult, Ledger};
use rtf_report::episode_results::EpisodeLine;
use serde::Serialize;

use super::directory::{CampaignDir, DESCRIPTION};
use super::trials::refuse_versions;
use crate::error::Failure;

/// The file of LeRobot in the directory of its results.
const EVAL_INFO: &str = "eval_info.json";

/// What the results of a version were read from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum VersionSource {
    Campaign,
    Csv,
    LeRobot,
}

/// The results of a version.
#[derive(Clone, Debug)]
pub struct LoadedVersion {
    pub path: PathBuf,
    /// Of a campaign with several versions: which one it is.
    pub name: Option<String>,
    pub source: VersionSource,
    /// Whether its results have decided how many episodes ran.
    pub is_sequential: bool,
    pub episodes: Vec<ComparedEpisode>,
}

impl LoadedVersion {
    /// Reads the results: a directory of a campaign or of LeRobot, or a file.
    pub fn read(path: &Path) -> Result<Self, Failure> {
        if path.is_dir() && (path.join(DESCRIPTION).exists() || !path.join(EVAL_INFO).is_file()) {
            return Self::of_campaign(CampaignDir::open_judged(path)?);
        }
        let is_file_of = |extension: &str| path.extension().is_some_and(|it| it == extension);
        let (source, episodes) = if path.is_dir() {
            (VersionSource::LeRobot, read_file(&path.join(EVAL_INFO), read_lerobot)?)
        } else if is_file_of("csv") {
            (VersionSource::Csv, read_file(path, read_csv)?)
        } else if is_file_of("json") {
            (VersionSource::LeRobot, read_file(path, read_lerobot)?)
        } else {
            let error = format!("`{}` has no results", path.display());
            let hint = "the directory of a campaign, a `.csv` file, or LeRobot's `eval_info.json` \
                        is expected";
            return Err(Failure::input(error).hint(hint));
        };
        Ok(Self { path: path.to_owned(), name: None, source, is_sequential: false, episodes })
    }

    fn of_campaign(dir: CampaignDir) -> Result<Self, Failure> {
        refuse_versions(&dir)?;
        let episodes = episodes_of(&dir)?;
        let stop = dir.description.start.as_ref().map_or(StoppingRule::Fixed, |start| start.stop);
        let is_sequential = stop != StoppingRule::Fixed;
        let source = VersionSource::Campaign;
        Ok(Self { path: dir.path, name: None, source, is_sequential, episodes })
    }

    /// What it is called: the version, or the path.
    pub fn title(&self) -> Cow<'_, str> {
        let path = || self.path.to_string_lossy();
        self.name.as_ref().map_or_else(path, |name| name.as_str().into())
    }

    /// Whether both are campaigns, of which one has other episodes.
    pub fn is_other_campaign(&self, other: &Self) -> bool {
        let both = [self, other].iter().all(|it| it.source == VersionSource::Campaign);
        let parts = |it: &Self| {
            let part = |it: &ComparedEpisode| (it.id, it.seed, it.parameters.clone());
            it.episodes.iter().map(part).collect::<Vec<_>>()
        };
        both && parts(self) != parts(other)
    }
}

/// Reads the results in a file.
fn read_file(
    path: &Path,
    read: impl Fn(&str) -> Result<Vec<ComparedEpisode>, rtf_campaign::results_file::ResultsProblem>,
) -> Result<Vec<ComparedEpisode>, Failure> {
    let name = path.display();
    let text = fs::read_to_string(path).map_err(|error| {
        let failure = Failure::input(format!("cannot read `{name}`: {error}"));
        match error.kind() {
            std::io::ErrorKind::InvalidData => failure.hint("the file must be UTF-8"),
            _ => failure,
        }
    })?;
    read(&text).map_err(|problem| {
        Failure::input(format!("{name}:{}: {problem}", problem.line)).hint(problem.kind.hint())
    })
}

/// The results and values of all episodes, in their order.
pub(super) fn episodes_of(dir: &CampaignDir) -> Result<Vec<ComparedEpisode>, Failure> {
    let list = dir.episodes()?.episodes;
    let mut ledger = Ledger::new(list.len(), dir.description.repeats);
    let episode = |episode: rtf_model::Episode| ComparedEpisode {
        id: episode.id,
        seed: Some(episode.seed.into()),
        parameters: episode.parameters,
        ..ComparedEpisode::default()
    };
    let mut all: Vec<_> = list.into_iter().map(episode).collect();
    for line in dir.recorded() {
        let Some(outcome) = line.outcome else { continue };
        ledger.record(line.episode, outcome, None);
        let index = usize::try_from(line.episode).ok().and_then(|id| id.checked_sub(1));
        if let Some(episode) = index.and_then(|index| all.get_mut(index))
            && !outcome.is_of_bench()
            && episode.values.is_empty()
        {
            episode.first_observation.clone_from(&line.first_observation);
            episode.values = measured(line);
        }
    }
    for (episode, executions) in all.iter_mut().zip(ledger.episodes()) {
        episode.passed = match executions.result {
            Some(EpisodeResult::Passed) => Some(true),
            Some(EpisodeResult::Failed) => Some(false),
            Some(EpisodeResult::None) | None => None,
        };
    }
    Ok(all)
}

fn measured(line: EpisodeLine) -> BTreeMap<MeasurementKey, f64> {
    let mut values = BTreeMap::new();
    for it in line.measurements {
        if let Some(value) = it.value.filter(|value| value.is_finite()) {
            values.entry((it.test, it.name, it.unit)).or_insert(value);
        }
    }
    values
}
