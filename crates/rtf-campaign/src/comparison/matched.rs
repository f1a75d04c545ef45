//! Two versions, in pairs or as independent samples.

use std::collections::BTreeMap;

use rtf_statistics::difference::{of_means, of_paired_means, of_paired_rates, of_rates};
use rtf_statistics::{CONFIDENCE, Counts, PairCounts, independent, paired};

use super::{
    ComparedEpisode, MeasurementComparison, MeasurementKey, Pairing, ResultComparison, VersionRate,
};

/// The episodes of the first and of a further version.
pub(super) enum Matched<'a> {
    Pairs(Vec<(&'a ComparedEpisode, &'a ComparedEpisode)>),
    Independent(Vec<&'a ComparedEpisode>, Vec<&'a ComparedEpisode>),
}

impl<'a> Matched<'a> {
    /// Pairs the episodes if both versions have the same ids and seeds.
    pub fn new(first: &'a [ComparedEpisode], second: &'a [ComparedEpisode]) -> (Pairing, Self) {
        let pairing = match (by_identity(first), by_identity(second)) {
            (Some(a), Some(b)) if a.len() == first.len() && b.len() == second.len() => {
                if a.keys().eq(b.keys()) {
                    let pairs = a.into_values().zip(b.into_values()).collect();
                    return (Pairing::Pairs, Self::Pairs(pairs));
                }
                Pairing::OtherEpisodes
            }
            (Some(_), Some(_)) => Pairing::OtherEpisodes,
            _ => Pairing::WithoutSeeds,
        };
        (pairing, Self::Independent(first.iter().collect(), second.iter().collect()))
    }

    pub fn is_paired(&self) -> bool {
        matches!(self, Self::Pairs(_))
    }

    /// The episodes that meet a condition; in pairs, those of the first version decide.
    pub fn within(&self, is_met: impl Fn(&ComparedEpisode) -> bool) -> Self {
        match self {
            Self::Pairs(pairs) => {
                Self::Pairs(pairs.iter().copied().filter(|(first, _)| is_met(first)).collect())
            }
            Self::Independent(first, second) => {
                let met = |episodes: &[&'a ComparedEpisode]| {
                    episodes.iter().copied().filter(|episode| is_met(episode)).collect()
                };
                Self::Independent(met(first), met(second))
            }
        }
    }

    /// How often each version passed.
    pub fn rates(&self) -> [VersionRate; 2] {
        match self {
            Self::Pairs(pairs) => [
                VersionRate::of(pairs.iter().map(|(first, _)| *first)),
                VersionRate::of(pairs.iter().map(|(_, second)| *second)),
            ],
            Self::Independent(first, second) => {
                [first, second].map(|episodes| VersionRate::of(episodes.iter().copied()))
            }
        }
    }

    /// Compares the results.
    pub fn results(&self) -> ResultComparison {
        let Self::Pairs(pairs) = self else {
            let [first, second] = self.rates().map(|VersionRate { passed, failed, .. }| Counts {
                successes: passed,
                trials: passed + failed,
            });
            return ResultComparison {
                pairs: None,
                without_pair: 0,
                difference: of_rates(first, second, CONFIDENCE),
                significance: independent::fisher(first, second).into(),
            };
        };
        let mut counts = PairCounts::default();
        let mut without_pair = 0;
        for (first, second) in pairs {
            match (first.passed, second.passed) {
                (Some(true), Some(true)) => counts.both_passed += 1,
                (Some(true), Some(false)) => counts.only_first += 1,
                (Some(false), Some(true)) => counts.only_second += 1,
                (Some(false), Some(false)) => counts.none_passed += 1,
                _ => without_pair += 1,
            }
        }
        ResultComparison {
            pairs: Some(counts),
            without_pair,
            difference: of_paired_rates(&counts, CONFIDENCE),
            significance: paired::mcnemar(counts.only_first, counts.only_second).p_value.into(),
        }
    }

    /// Compares the measurements that both versions have.
    pub fn measurements(&self, seed: u64) -> Vec<MeasurementComparison> {
        let compared =
            self.values().into_iter().filter(|(_, [a, b])| !a.is_empty() && !b.is_empty());
        let compared = compared.map(|((test, name, unit), [first, second])| {
            let (difference, p_value) = match self.is_paired() {
                true => {
                    let differences: Vec<f64> =
                        first.iter().zip(&second).map(|(a, b)| b - a).collect();
                    let p_value = paired::permutation_test(&differences, seed).p_value;
                    (of_paired_means(&differences, CONFIDENCE), p_value)
                }
                false => (
                    of_means(&first, &second, CONFIDENCE),
                    independent::permutation_test(&first, &second, seed),
                ),
            };
            MeasurementComparison {
                test: test.clone(),
                name: name.clone(),
                unit: unit.clone(),
                counts: [first.len() as u64, second.len() as u64],
                first: mean(&first),
                second: mean(&second),
                difference,
                significance: p_value.into(),
            }
        });
        compared.collect()
    }

    /// The values of each measurement, in pairs those of the same episodes.
    fn values(&self) -> BTreeMap<&'a MeasurementKey, [Vec<f64>; 2]> {
        let mut values: BTreeMap<&MeasurementKey, [Vec<f64>; 2]> = BTreeMap::new();
        match self {
            Self::Pairs(pairs) => {
                for (first, second) in pairs {
                    for (key, value) in &first.values {
                        if let Some(other) = second.values.get(key) {
                            let [a, b] = values.entry(key).or_default();
                            a.push(*value);
                            b.push(*other);
                        }
                    }
                }
            }
            Self::Independent(first, second) => {
                for (side, episodes) in [first, second].into_iter().enumerate() {
                    for (key, value) in episodes.iter().flat_map(|episode| &episode.values) {
                        values.entry(key).or_default()[side].push(*value);
                    }
                }
            }
        }
        values
    }
}

/// The episodes by id and seed. `None` if one has no seed.
fn by_identity(episodes: &[ComparedEpisode]) -> Option<BTreeMap<(u64, u64), &ComparedEpisode>> {
    episodes.iter().map(|episode| Some(((episode.id, episode.seed?), episode))).collect()
}

#[expect(clippy::cast_precision_loss, reason = "numbers of episodes are far below 2^53")]
fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}
