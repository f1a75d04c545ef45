//! The results of a campaign, as the page shows them, and where they come from. The program that
//! contains the server implements [`CampaignSource`].

use std::collections::BTreeMap;

use jiff::Timestamp;
use rtf_statistics::Rate;
use serde::Serialize;
use utoipa::ToSchema;

/// The campaigns that a server shows.
pub trait CampaignSource: Send + Sync {
    /// The results of a campaign, by the name of its directory. `None`: there is no such campaign.
    ///
    /// # Errors
    /// It cannot be read.
    fn report(&self, directory: &str) -> Result<Option<CampaignReport>, String>;
}

/// The results of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignReport {
    /// The name of its directory.
    pub directory: String,
    /// The name of the campaign.
    pub name: String,
    /// The campaign file.
    pub file: String,
    /// When it started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// Whether it is still running.
    pub running: bool,
    /// The commit of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The claimed rate. Missing if versions are compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub claim: Option<f64>,
    /// The versions that are tried and compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub versions: Option<CampaignVersions>,
    /// The stopping rule.
    pub rule: String,
    /// The confidence of the intervals of the claim.
    pub confidence: f64,
    /// The verdict: `passed`, `failed` or `undecided`.
    pub verdict: String,
    /// The number of planned episodes.
    pub planned: usize,
    /// Of the episodes that were judged: how many passed.
    pub passed: u64,
    /// How many failed.
    pub failed: u64,
    /// How many have no result.
    pub without_result: u64,
    /// The rate with the interval of the claim. `None` if no episode has a result.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<Rate>,
    /// If it is undecided: about how many more episodes decide it at the present rate. Missing also
    /// if these are more than 50 000.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub more_episodes: Option<u64>,
    /// The same as a sentence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forecast: Option<String>,
    /// The rate after some of the first episodes.
    pub progress: Vec<CampaignProgress>,
    /// The rates by parameter, the one with the largest effect first.
    pub parameters: Vec<CampaignParameter>,
    /// The rates by two parameters, of the parameters with the largest effects.
    pub maps: Vec<CampaignMap>,
    /// The worst episodes and the best ones, by duration and by measurements. Empty if fewer than
    /// two episodes have a result.
    pub rankings: Vec<EpisodeRanking>,
    /// The first episodes whose last result is not `passed`.
    pub problems: Vec<EpisodeProblem>,
    /// The number of all these episodes.
    pub problem_count: usize,
}

/// The versions of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignVersions {
    /// How many there are.
    pub count: usize,
    /// Whether they are hidden until all trials have results. Then the report has no version.
    pub hidden: bool,
    /// The rate of each version, the baseline first.
    pub rates: Vec<CampaignVersionRate>,
    /// How each further version differs from the baseline, as a sentence.
    pub findings: Vec<String>,
}

/// How often a version passed.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignVersionRate {
    /// The version.
    pub version: String,
    /// The number of trials with a result.
    pub episodes: u64,
    /// How many passed.
    pub passed: u64,
    /// The rate with its Wilson interval at 95 % confidence. Missing without results.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<Rate>,
}

/// The rate after some episodes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignProgress {
    /// The number of episodes.
    pub episodes: usize,
    /// The rate with the interval of the claim.
    pub rate: Rate,
}

/// The rates by the values of a parameter.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignParameter {
    /// The name.
    pub name: String,
    /// Pearson's X² of the results by value.
    pub chi_square: f64,
    /// The probability of this X² or a larger one by chance.
    pub p_value: f64,
    /// The rates, in the order of the values.
    pub cells: Vec<CampaignCell>,
}

/// The rate of the episodes with some values.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignCell {
    /// The value, or the range of values.
    pub values: String,
    /// The number of episodes.
    pub episodes: u64,
    /// How many passed.
    pub passed: u64,
    /// The rate with its Wilson interval at 95 % confidence. Missing without episodes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<Rate>,
}

/// The rates by the values of two parameters.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignMap {
    /// The parameter of the columns.
    pub x: String,
    /// The parameter of the rows.
    pub y: String,
    /// The values of the rows, each with its cells in the order of the columns.
    pub rows: Vec<CampaignMapRow>,
}

/// A row of a map.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct CampaignMapRow {
    /// The value, or the range of values.
    pub values: String,
    /// The rates, whose `values` are those of the columns.
    pub cells: Vec<CampaignCell>,
}

/// An episode that did not pass.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EpisodeProblem {
    /// The number of the episode.
    pub episode: u64,
    /// The last result: `failed`, `error` or `collapsed`.
    pub outcome: String,
    /// The first reason.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// The parameters.
    pub parameters: BTreeMap<String, String>,
    /// The command that repeats it.
    pub command: String,
    /// Where its messages, plots and attachments are.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub run: Option<EpisodeRun>,
}

/// The worst episodes and the best ones: failed episodes are worse than passed ones, and equal
/// results are ordered by a value.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct EpisodeRanking {
    /// `duration`, or the test and the name of a measurement.
    pub by: String,
    /// The unit of the values.
    pub unit: String,
    /// Whether a higher value is worse.
    pub higher_is_worse: bool,
    /// The worst episode first.
    pub worst: Vec<RankedEpisode>,
    /// The best episode first.
    pub best: Vec<RankedEpisode>,
}

/// An episode with a result.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
pub struct RankedEpisode {
    /// The number of the episode.
    pub episode: u64,
    /// The result: `passed` or `failed`.
    pub outcome: String,
    /// The value by which it is ordered.
    pub value: f64,
    /// The parameters.
    pub parameters: BTreeMap<String, String>,
    /// Where its messages, plots and attachments are.
    pub run: EpisodeRun,
}

/// The run of a worker in which an episode ran.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct EpisodeRun {
    /// The run, as in the routes of runs.
    pub run: String,
    /// The test that did not pass, or, if all passed, the first one that measured something, or else
    /// the first one. Missing if no test is the reason, and in results of earlier versions.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub test: Option<u32>,
    /// Its attempt in the run.
    #[serde(flatten)]
    #[schema(value_type = EpisodeAttempt)]
    pub attempt: Option<EpisodeAttempt>,
}

/// The attempt of a test in which an episode ran.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, ToSchema)]
pub struct EpisodeAttempt {
    /// The attempt, from 1.
    // An episode without an attempt has no field of this.
    #[schema(required = false)]
    pub attempt: u32,
    /// The case of this attempt that the episode is, of a test that runs many.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub case: Option<u32>,
}
