//! Campaigns, their rates over commits, and since which campaign a rate is different.

use std::collections::BTreeMap;

use jiff::Timestamp;
use rtf_statistics::Rate;
use serde::{Serialize, Serializer};
use utoipa::ToSchema;

use crate::entry::{CampaignInfo, EpisodeEntry, interval};
use crate::statistics::Counts;
use crate::statistics::rate_changes::{LEVEL, find_rate_changes};
use crate::{RunSelection, Store, StoreError};

/// Campaigns that are comparable: the same file, name, parameters, constraints, profile and
/// parameters of the command line.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignSeries {
    /// The name of the campaign.
    pub name: String,
    /// The campaign file, relative to the root of its repository.
    pub file: String,
    /// The profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The parameters of the command line, as `NAME=VALUE`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// A hash of the parameters and constraints.
    pub space: String,
    /// The campaigns, the oldest first.
    pub points: Vec<RatePoint>,
}

/// The rate of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct RatePoint {
    /// The campaign.
    pub campaign: String,
    /// The name of its directory.
    pub directory: String,
    /// When it started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// The commit of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The branch of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<String>,
    /// Whether the sources differed from the commit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dirty: Option<bool>,
    /// How many episodes passed.
    pub passed: u64,
    /// How many failed.
    pub failed: u64,
    /// How many have no result.
    pub without_result: u64,
    /// The rate with its interval at 95 % confidence, which is valid for the stopping rule.
    /// `None` if no episode has a result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<Rate>,
    /// The claimed rate.
    pub claim: f64,
    /// The verdict.
    pub verdict: String,
}

/// A change of the rate of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignChange {
    /// The name of the campaign.
    pub name: String,
    /// The campaign file, relative to the root of its repository.
    pub file: String,
    /// The profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The first campaign after the change.
    pub campaign: String,
    /// The name of its directory.
    pub directory: String,
    /// When it started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// The commit of its sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The commit of the last campaign before the change.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit_before: Option<String>,
    /// Since the previous change.
    pub before: RateSegment,
    /// Until the next change.
    pub after: RateSegment,
    /// The probability of such a difference by chance.
    pub p_value: f64,
}

/// Campaigns between two changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct RateSegment {
    /// How many campaigns.
    pub campaigns: usize,
    /// How many of their episodes passed.
    pub passed: u64,
    /// How many failed.
    pub failed: u64,
    /// The rate with its interval at 95 % confidence.
    pub rate: Rate,
}

/// An episode of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EpisodeLine {
    /// The campaign.
    pub campaign: String,
    /// Its name.
    pub name: String,
    /// When it started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// The commit of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The number of the episode.
    pub episode: u64,
    /// The seed of the episode.
    pub seed: u32,
    /// The last result.
    pub outcome: String,
    /// The first reason why it did not pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// From its start to its end, in seconds.
    pub duration: f64,
    /// The parameters.
    #[serde(serialize_with = "as_map")]
    #[schema(value_type = HashMap<String, String>)]
    pub parameters: Vec<(String, String)>,
}

impl Store {
    /// The selected campaigns, the newest first; `name`: only those with this name.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn campaigns(
        &self,
        selection: &RunSelection,
        name: Option<&str>,
    ) -> Result<Vec<CampaignInfo>, StoreError> {
        let all = self.selected_campaigns(selection, name)?;
        Ok(all.into_iter().rev().map(|(_, campaign)| campaign).collect())
    }

    fn selected_campaigns(
        &self,
        selection: &RunSelection,
        name: Option<&str>,
    ) -> Result<Vec<(i64, CampaignInfo)>, StoreError> {
        let mut all = self.all_campaigns()?;
        all.retain(|(_, it)| {
            selection.matches_campaign(it) && name.is_none_or(|name| it.name == name)
        });
        let surplus = all.len().saturating_sub(selection.last.unwrap_or(usize::MAX));
        Ok(all.split_off(surplus))
    }

    /// The rates of campaigns over time, by series.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn campaign_rates(
        &self,
        selection: &RunSelection,
        name: Option<&str>,
    ) -> Result<Vec<CampaignSeries>, StoreError> {
        let all = series(self.selected_campaigns(selection, name)?);
        let rates = all.into_iter().map(|((file, name, profile, set, space), campaigns)| {
            let points = campaigns.iter().map(RatePoint::new).collect();
            CampaignSeries { name, file, profile, set, space, points }
        });
        Ok(rates.collect())
    }

    /// The changes of the rates of campaigns, the newest first.
    ///
    /// # Errors
    /// The database cannot be read.
    pub fn campaign_changes(
        &self,
        selection: &RunSelection,
    ) -> Result<Vec<CampaignChange>, StoreError> {
        let mut changes = Vec::new();
        for campaigns in series(self.selected_campaigns(selection, None)?).values() {
            changes.extend(changes_of(campaigns));
        }
        changes.sort_by(|a, b| b.started.cmp(&a.started).then(a.campaign.cmp(&b.campaign)));
        Ok(changes)
    }

    /// Calls `visit` with each episode of the selected campaigns, the oldest campaign first.
    /// Holds the episodes of one campaign at a time.
    ///
    /// # Errors
    /// The database cannot be read; or the first error of `visit`.
    pub fn for_each_episode<E: From<StoreError>>(
        &self,
        selection: &RunSelection,
        mut visit: impl FnMut(EpisodeLine) -> Result<(), E>,
    ) -> Result<(), E> {
        for (id, info) in self.selected_campaigns(selection, None)? {
            let (names, episodes) = self.episodes_of(id)?;
            let lines = episodes.into_iter().map(|it| EpisodeLine::new(&info, &names, it));
            lines.into_iter().try_for_each(&mut visit)?;
        }
        Ok(())
    }
}

fn as_map<S: Serializer>(pairs: &[(String, String)], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(pairs.iter().map(|(name, value)| (name, value)))
}

impl EpisodeLine {
    fn new(campaign: &CampaignInfo, names: &[String], episode: EpisodeEntry) -> Self {
        Self {
            campaign: campaign.id.clone(),
            name: campaign.name.clone(),
            started: campaign.started,
            commit: campaign.commit.clone(),
            episode: episode.id,
            seed: episode.seed,
            outcome: episode.outcome,
            reason: episode.reason,
            duration: episode.duration_us as f64 / 1e6,
            parameters: names.iter().cloned().zip(episode.values).collect(),
        }
    }
}

/// What makes campaigns comparable: file, name, profile, parameters of the command line, space.
type SeriesKey = (String, String, Option<String>, Vec<String>, String);

/// Groups campaigns, which are the oldest first, by what makes them comparable.
fn series(campaigns: Vec<(i64, CampaignInfo)>) -> BTreeMap<SeriesKey, Vec<CampaignInfo>> {
    let mut groups = BTreeMap::<_, Vec<CampaignInfo>>::new();
    for (_, it) in campaigns {
        let CampaignInfo { file, name, profile, set, space, .. } = it.clone();
        groups.entry((file, name, profile, set, space)).or_default().push(it);
    }
    groups
}

impl RatePoint {
    fn new(campaign: &CampaignInfo) -> Self {
        Self {
            campaign: campaign.id.clone(),
            directory: campaign.directory.clone(),
            started: campaign.started,
            commit: campaign.commit.clone(),
            branch: campaign.branch.clone(),
            dirty: campaign.dirty,
            passed: campaign.passed,
            failed: campaign.failed,
            without_result: campaign.without_result,
            rate: campaign.usual_rate(),
            claim: campaign.claim,
            verdict: campaign.verdict.clone(),
        }
    }
}

fn changes_of(campaigns: &[CampaignInfo]) -> Vec<CampaignChange> {
    let with_results = campaigns.iter().filter(|it| it.counts().trials() > 0);
    let campaigns: Vec<_> = with_results.collect();
    let counts: Vec<_> = campaigns.iter().map(|it| it.counts()).collect();
    let changes = find_rate_changes(&counts, LEVEL);
    let starts: Vec<_> = changes.iter().map(|change| change.index).collect();
    let segment = |from: usize, to: usize| segment(&campaigns[from..to]);
    let change = |(position, change): (usize, &crate::statistics::RateChange)| {
        let from = position.checked_sub(1).map_or(0, |previous| starts[previous]);
        let to = starts.get(position + 1).copied().unwrap_or(counts.len());
        let (before, first) =
            (campaigns.get(change.index.checked_sub(1)?)?, campaigns[change.index]);
        Some(CampaignChange {
            name: first.name.clone(),
            file: first.file.clone(),
            profile: first.profile.clone(),
            campaign: first.id.clone(),
            directory: first.directory.clone(),
            started: first.started,
            commit: first.commit.clone(),
            commit_before: before.commit.clone(),
            before: segment(from, change.index)?,
            after: segment(change.index, to)?,
            p_value: change.p_value,
        })
    };
    changes.iter().enumerate().filter_map(change).collect()
}

/// The episodes of several campaigns together. `None` if none has a result.
fn segment(campaigns: &[&CampaignInfo]) -> Option<RateSegment> {
    let counts: Vec<_> = campaigns.iter().map(|it| it.counts()).collect();
    let Counts { passed, failed } = Counts::sum(&counts);
    let without_result = campaigns.iter().map(|it| it.without_result).sum();
    // One sequential rule makes the number of all episodes depend on the results.
    let sequential = campaigns.iter().find(|it| it.rule != "fixed");
    let rule = sequential.map_or("fixed", |it| &it.rule);
    let rate = interval(rule, Counts { passed, failed }, without_result)?;
    Some(RateSegment { campaigns: campaigns.len(), passed, failed, rate })
}
