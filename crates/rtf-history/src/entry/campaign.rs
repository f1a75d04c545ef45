//! The results of a campaign, as they are stored.

use jiff::Timestamp;
use rtf_statistics::{ConfidenceSequence, Rate, rate};
use serde::Serialize;
use utoipa::ToSchema;

use crate::statistics::Counts;

/// Everything that the store keeps of a campaign.
#[derive(Clone, Debug, PartialEq)]
pub struct CampaignEntry {
    /// The campaign.
    pub info: CampaignInfo,
    /// The names of the parameters of its episodes.
    pub parameters: Vec<String>,
    /// The episodes that have run.
    pub episodes: Vec<EpisodeEntry>,
}

/// An episode that has run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EpisodeEntry {
    /// Its number.
    pub id: u64,
    /// Its seed.
    pub seed: u32,
    /// The last result: `passed`, `failed`, `error` or `collapsed`.
    pub outcome: String,
    /// The first reason why it did not pass.
    pub reason: Option<String>,
    /// From its start to its end, in microseconds.
    pub duration_us: i64,
    /// The values of the parameters, in the order of [`CampaignEntry::parameters`].
    pub values: Vec<String>,
}

/// A campaign.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[schema(as = HistoryCampaign)]
pub struct CampaignInfo {
    /// The identity: a UUID.
    pub id: String,
    /// The name of its directory.
    pub directory: String,
    /// The name of the campaign.
    pub name: String,
    /// The campaign file, relative to the root of its repository.
    pub file: String,
    /// The suite file, relative to the root of its repository.
    pub suite_file: String,
    /// When it started.
    #[schema(value_type = String, format = DateTime)]
    pub started: Timestamp,
    /// When it ended, or was resumed and ended.
    #[schema(value_type = String, format = DateTime)]
    pub ended: Timestamp,
    /// How it ended.
    pub end: CampaignEnd,
    /// The commit of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub commit: Option<String>,
    /// The branch of the sources.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub branch: Option<String>,
    /// Whether the sources differed from the commit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dirty: Option<bool>,
    /// The author time of the commit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub author_time: Option<String>,
    /// The address of the CI job.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ci_job: Option<String>,
    /// The machine.
    pub host: String,
    /// The profile.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub profile: Option<String>,
    /// The parameters of the command line, as `NAME=VALUE`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub set: Vec<String>,
    /// The version of the runner.
    pub rtf: String,
    /// The seed of the list of episodes.
    pub seed: u64,
    /// A hash of the parameters and constraints: campaigns are comparable if it is equal.
    pub space: String,
    /// The claimed rate.
    pub claim: f64,
    /// The stopping rule.
    pub rule: String,
    /// The confidence of the interval.
    pub confidence: f64,
    /// The verdict: `passed`, `failed` or `undecided`.
    pub verdict: String,
    /// The number of planned episodes.
    pub planned: u64,
    /// The number of episodes that have run.
    pub run: u64,
    /// Of the episodes that were judged: how many passed.
    pub passed: u64,
    /// How many failed.
    pub failed: u64,
    /// How many have no result.
    pub without_result: u64,
    /// The rate of passed episodes with its interval, as the campaign was judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rate: Option<Rate>,
}

/// How a campaign ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, serde::Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum CampaignEnd {
    /// All episodes have run, or the claim was decided.
    Finished,
    /// By a signal.
    Interrupted,
    /// Its budget has passed.
    OverBudget,
    /// A hook failed.
    HookFailed,
    /// Only results that are the bench's.
    BenchBroken,
    /// It was killed.
    Unfinished,
}

impl CampaignEnd {
    /// The word, as in the store and in JSON.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Interrupted => "interrupted",
            Self::OverBudget => "over-budget",
            Self::HookFailed => "hook-failed",
            Self::BenchBroken => "bench-broken",
            Self::Unfinished => "unfinished",
        }
    }
}

impl CampaignInfo {
    /// The results that count for the rate.
    #[must_use]
    pub fn counts(&self) -> Counts {
        Counts { passed: self.passed, failed: self.failed }
    }

    /// The rate with an interval of the usual confidence, 95 %, that is valid for the stopping
    /// rule: see [`interval`].
    #[must_use]
    pub fn usual_rate(&self) -> Option<Rate> {
        interval(&self.rule, self.counts(), self.without_result)
    }
}

/// A rate with an interval at 95 % confidence: a Wilson interval for a fixed number of episodes, a
/// confidence sequence for a sequential stopping rule. The interval reaches from the case that
/// all episodes without a result failed to the case that all passed.
#[must_use]
pub fn interval(rule: &str, counts: Counts, without_result: u64) -> Option<Rate> {
    let sequence = ConfidenceSequence::new(rtf_statistics::CONFIDENCE)?;
    let of = |passed, trials| match rule {
        "fixed" => rate(passed, trials, rtf_statistics::CONFIDENCE),
        _ => sequence.rate(passed, trials),
    };
    let (passed, known) = (counts.passed, counts.trials());
    let all = known + without_result;
    let value = of(passed, known)?.value;
    Some(Rate { value, low: of(passed, all)?.low, high: of(passed + without_result, all)?.high })
}
