//! How many episodes a comparison of versions needs to find a difference.

use rtf_statistics::sample_size::{independent_power, paired_power, sufficient_trials};
use serde::Serialize;
use thiserror::Error;

/// Rates and differences are equal if they differ by less: rounding errors.
const RESOLUTION: f64 = 1e-9;

/// The difference that a comparison is to find.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wanted {
    /// The rate of the first version.
    pub rate: f64,
    /// The difference of the rates, in either direction.
    pub detect: f64,
    /// The probability that it is found.
    pub power: f64,
    /// The probability of any wrong claim.
    pub alpha: f64,
    /// The number of versions, with the first one.
    pub versions: u32,
    /// The share of episodes that only one of two versions passes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub discordant: Option<f64>,
}

/// What a number of episodes assumes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Assumption {
    /// In pairs: the better version passes all episodes that the worse one passes.
    Nested,
    /// In pairs: the results of an episode are independent.
    IndependentResults,
    /// In pairs: the given share of episodes is passed by one version only.
    Discordant,
    /// The versions run different episodes.
    IndependentEpisodes,
}

/// The episodes of each version.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlannedEpisodes {
    pub assumption: Assumption,
    /// `None` if these are more than 100 000.
    pub episodes: Option<u64>,
    /// The probability that the difference is found with this number.
    pub power: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum PlanError {
    #[error("no rate is {} % above or below {} %", percent(*.detect), percent(*.rate))]
    NoSuchRate { rate: f64, detect: f64 },
    #[error(
        "only one version passes between {} % and {} % of the episodes, with this rate and difference",
        percent(*.least),
        percent(*.most)
    )]
    Discordant { least: f64, most: f64 },
}

/// A share in percent, without rounding errors.
#[must_use]
pub fn percent(share: f64) -> f64 {
    (share * 1e6).round() / 1e4
}

/// The numbers of episodes for each assumption.
///
/// # Errors
/// There is no such difference.
pub fn plan(wanted: &Wanted) -> Result<Vec<PlannedEpisodes>, PlanError> {
    let Wanted { rate, detect, .. } = *wanted;
    let others = [rate - detect, rate + detect].map(|other| other.clamp(0.0, 1.0));
    let exists = |other: &f64| ((other - rate).abs() - detect).abs() < RESOLUTION;
    let pairs: Vec<RatePair> =
        others.into_iter().filter(exists).map(|other| RatePair::new(rate, other)).collect();
    if pairs.is_empty() {
        return Err(PlanError::NoSuchRate { rate, detect });
    }
    let assumptions = match wanted.discordant {
        Some(share) => {
            let most = pairs.iter().map(RatePair::most_discordant).fold(0.0, f64::max);
            if share < detect - RESOLUTION || share > most + RESOLUTION {
                return Err(PlanError::Discordant { least: detect, most });
            }
            vec![Assumption::Discordant, Assumption::IndependentEpisodes]
        }
        None => vec![
            Assumption::Nested,
            Assumption::IndependentResults,
            Assumption::IndependentEpisodes,
        ],
    };
    let number = |assumption| {
        // The direction that needs more episodes counts.
        let numbers: Option<Vec<_>> =
            pairs.iter().map(|pair| pair.episodes(assumption, wanted)).collect();
        let most = numbers.and_then(|it| it.into_iter().max_by_key(|(episodes, _)| *episodes));
        let (episodes, power) = most.unzip();
        PlannedEpisodes { assumption, episodes, power }
    };
    Ok(assumptions.into_iter().map(number).collect())
}

struct RatePair {
    better: f64,
    worse: f64,
}

impl RatePair {
    fn new(first: f64, second: f64) -> Self {
        Self { better: first.max(second), worse: first.min(second) }
    }

    /// The largest share of episodes that only one of both passes.
    fn most_discordant(&self) -> f64 {
        (self.better + self.worse).min(2.0 - self.better - self.worse)
    }

    /// A sufficient number, and its power.
    fn episodes(&self, assumption: Assumption, wanted: &Wanted) -> Option<(u64, f64)> {
        let Self { better, worse } = *self;
        // At least as strict as Holm's method for the smallest p value.
        let alpha = wanted.alpha / f64::from(wanted.versions.saturating_sub(1).max(1));
        let only_worse = match assumption {
            Assumption::IndependentEpisodes => {
                let power = |trials| independent_power(trials, better, worse, alpha);
                return sufficient_trials(wanted.power, power);
            }
            Assumption::Nested => 0.0,
            Assumption::IndependentResults => worse * (1.0 - better),
            Assumption::Discordant => {
                let share = wanted.discordant.unwrap_or_default();
                ((share - (better - worse)) / 2.0).max(0.0)
            }
        };
        let only_better = only_worse + better - worse;
        sufficient_trials(wanted.power, |pairs| paired_power(pairs, only_better, only_worse, alpha))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const WANTED: Wanted =
        Wanted { rate: 0.9, detect: 0.1, power: 0.8, alpha: 0.05, versions: 2, discordant: None };

    fn numbers(wanted: &Wanted) -> Vec<u64> {
        let planned = plan(wanted).unwrap();
        assert!(planned.iter().all(|it| it.power.unwrap() >= wanted.power), "{planned:?}");
        planned.iter().map(|it| it.episodes.unwrap()).collect()
    }

    #[test]
    fn fewer_discordant_episodes_need_fewer_pairs() {
        let found = numbers(&WANTED);
        // Independent results say as much in pairs as in different episodes.
        assert!(found[0] < found[1] && found[1].abs_diff(found[2]) < 5, "{found:?}");
        let half = numbers(&Wanted { discordant: Some(0.18), ..WANTED });
        assert!(found[0] < half[0] && half[0] < found[1] && half[1] == found[2], "{half:?}");
        let least = numbers(&Wanted { discordant: Some(0.1), ..WANTED });
        assert_eq!(least[0], found[0]);
    }

    #[test]
    fn more_versions_power_and_confidence_need_more_episodes() {
        let found = numbers(&WANTED);
        let strict = Wanted { alpha: 0.01, ..WANTED };
        let powerful = Wanted { power: 0.95, ..WANTED };
        let versions = Wanted { versions: 4, ..WANTED };
        for other in [strict, powerful, versions] {
            assert!(numbers(&other).iter().zip(&found).all(|(a, b)| a > b), "{other:?}");
        }
    }

    #[test]
    fn both_directions_count() {
        let up = numbers(&Wanted { rate: 0.3, ..WANTED });
        assert_eq!(up, numbers(&Wanted { rate: 0.7, ..WANTED }), "0.4 and 0.6 are harder");
        assert_eq!(numbers(&Wanted { rate: 1.0, ..WANTED }).len(), 3, "only a lower one");
    }

    #[test]
    fn impossible_differences() {
        let found = plan(&Wanted { rate: 0.5, detect: 0.6, ..WANTED }).unwrap_err();
        assert_eq!(found.to_string(), "no rate is 60 % above or below 50 %");
        let found = plan(&Wanted { discordant: Some(0.05), ..WANTED }).unwrap_err();
        let least = "only one version passes between 10 % and 30 % of the episodes";
        assert!(found.to_string().starts_with(least), "{found}");
    }

    #[test]
    fn a_small_difference_needs_too_many() {
        let found = plan(&Wanted { rate: 0.5, detect: 0.002, ..WANTED }).unwrap();
        assert_eq!(found[2].episodes, None);
    }
}
