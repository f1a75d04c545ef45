//! Trials of versions: which of them are hidden, and the comparison.

use std::fs;
use std::path::Path;

use jiff::Timestamp;
use rtf_campaign::comparison::{Comparison, Options, UnknownParameter, compare};
use rtf_campaign::file::Versions;
use rtf_campaign::{Judgement, Ledger, Verdict};
use rtf_model::Episode;
use serde::{Deserialize, Serialize};

use super::directory::{self, CampaignDir};
use super::version::{self, LoadedVersion, VersionSource};
use crate::error::Failure;
use crate::operator;

/// Who has seen the versions before all trials had results.
const UNBLINDED: &str = "unblinded.json";
/// The probability of any wrong claim.
const ALPHA: f64 = 0.05;

/// The versions of a campaign, in its description.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct TrialVersions {
    /// The parameter whose value is the version.
    pub parameter: String,
    /// The first one is the baseline.
    pub values: Vec<String>,
    /// Whether they are hidden until all trials have results.
    pub blinded: bool,
}

impl From<&Versions> for TrialVersions {
    fn from(versions: &Versions) -> Self {
        Self {
            parameter: versions.parameter.value.clone(),
            values: versions.values.clone(),
            blinded: versions.blinded,
        }
    }
}

/// When the versions of blinded trials were shown, and to whom.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Unblinded {
    pub at: Timestamp,
    /// The user.
    pub by: String,
    /// How many trials had results.
    pub trials: usize,
    /// The number of all trials.
    pub of: usize,
}

impl CampaignDir {
    /// The versions, if the campaign compares some.
    pub fn versions(&self) -> Option<&TrialVersions> {
        self.description.versions.as_ref()
    }

    /// Whether the versions must not be shown.
    pub fn hides_versions(&self, ledger: &Ledger) -> bool {
        self.versions().is_some_and(|versions| versions.blinded)
            && ledger.complete() < ledger.episodes().len()
            && self.unblinded().is_none()
    }

    /// Who has seen the versions early.
    pub fn unblinded(&self) -> Option<Unblinded> {
        let text = fs::read_to_string(self.path.join(UNBLINDED)).ok()?;
        serde_json::from_str(&text).ok()
    }

    /// Records that the versions are shown early. Only the first time counts.
    pub fn unblind(&self, ledger: &Ledger) -> Result<(), Failure> {
        if !self.hides_versions(ledger) {
            return Ok(());
        }
        let trials = ledger.episodes().iter().filter(|it| it.result.is_some()).count();
        let of = ledger.episodes().len();
        let unblinded = Unblinded { at: Timestamp::now(), by: operator::user_name(), trials, of };
        let json = serde_json::to_string_pretty(&unblinded).map_err(Failure::internal)?;
        directory::write(&self.path.join(UNBLINDED), &(json + "\n"))
    }

    /// The episodes as they may be shown: without the versions, if these are hidden.
    pub fn shown_episodes(&self, mut episodes: Vec<Episode>, is_hidden: bool) -> Vec<Episode> {
        let hidden = self.versions().filter(|_| is_hidden);
        for (episode, versions) in episodes.iter_mut().zip(std::iter::repeat(hidden)) {
            episode.parameters.retain(|it| versions.is_none_or(|hide| hide.parameter != it.name));
        }
        episodes
    }
}

/// The versions of a campaign, and how they differ from the first one.
#[derive(Debug)]
pub struct ComparedTrials {
    pub versions: Vec<LoadedVersion>,
    pub comparison: Comparison,
    /// Who has seen the versions early.
    pub unblinded: Option<Unblinded>,
}

impl ComparedTrials {
    /// Compares the versions of a campaign; `None` if it has none, or hides them. If all trials have
    /// results, the comparison decides about the verdict.
    pub fn judge(
        dir: &CampaignDir,
        ledger: &Ledger,
        judgement: &mut Judgement,
    ) -> Result<Option<Self>, Failure> {
        if dir.versions().is_none() || dir.hides_versions(ledger) {
            return Ok(None);
        }
        let options = Options { alpha: ALPHA, by: None, seed: 0 };
        let (versions, compared) = compare_versions(dir, &options)?;
        let comparison = compared.map_err(|_| Failure::internal("there are no conditions"))?;
        let is_compared = comparison.comparisons.iter().all(|it| it.results.difference.is_some());
        judgement.verdict = match comparison.any_worse() {
            _ if !judgement.is_final || !is_compared => Verdict::Undecided,
            true => Verdict::Failed,
            false => Verdict::Passed,
        };
        Ok(Some(Self { versions, comparison, unblinded: dir.unblinded() }))
    }
}

/// Reads the results of each version, and compares them. A version has the episodes of blocks, so
/// that a block is a pair.
pub fn compare_versions(
    dir: &CampaignDir,
    options: &Options<'_>,
) -> Result<(Vec<LoadedVersion>, Result<Comparison, UnknownParameter>), Failure> {
    let Some(TrialVersions { parameter, values, .. }) = dir.versions() else {
        return Err(no_versions(&dir.path));
    };
    let count = values.len() as u64;
    let mut versions: Vec<_> = values.iter().map(|value| of_version(dir, value)).collect();
    let mut episodes = vec![Vec::new(); versions.len()];
    for mut episode in version::episodes_of(dir)? {
        episode.id = episode.id.saturating_sub(1) / count.max(1) + 1;
        let is_version = |it: &rtf_model::Parameter| it.name == *parameter;
        let Some(place) = episode.parameters.iter().position(is_version) else { continue };
        let value = episode.parameters.remove(place).value;
        if let Some(index) = values.iter().position(|known| *known == value) {
            episodes[index].push(episode);
        }
    }
    let compared = compare(&episodes, options);
    for (version, episodes) in versions.iter_mut().zip(episodes) {
        version.episodes = episodes;
    }
    Ok((versions, compared))
}

fn of_version(dir: &CampaignDir, value: &str) -> LoadedVersion {
    LoadedVersion {
        path: dir.path.clone(),
        name: Some(value.to_owned()),
        source: VersionSource::Campaign,
        is_sequential: false,
        episodes: Vec::new(),
    }
}

fn no_versions(path: &Path) -> Failure {
    let error = format!("`{}` is one version: there is nothing to compare it with", path.display());
    let hint = "add the results of another one, or a campaign with `<versions>`";
    Failure::input(error).hint(hint)
}

/// Refuses the directory of a campaign with versions where results of one version are needed.
pub fn refuse_versions(dir: &CampaignDir) -> Result<(), Failure> {
    if dir.versions().is_none() {
        return Ok(());
    }
    let error = format!("`{}` has the results of several versions", dir.path.display());
    Err(Failure::input(error).hint("compare them by `rtf campaign compare` with it alone"))
}

/// Why versions cannot be compared yet.
pub fn hidden(dir: &CampaignDir, ledger: &Ledger) -> Failure {
    let (all, done) = (ledger.episodes().len(), ledger.complete());
    let path = dir.path.to_string_lossy();
    let path = shell_words::quote(&path).into_owned();
    let error = format!("the versions in {path} are hidden until all trials have results");
    let hint = format!("`rtf campaign show --unblind {path}` shows them earlier, and records that");
    Failure::input(format!("{error}: {done} of {all}")).hint(hint)
}
