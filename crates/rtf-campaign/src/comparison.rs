//! Two versions on the same episodes.

use std::collections::BTreeMap;

use rtf_statistics::paired::{PairedComparison, mcnemar, permutation_test};
use serde::Serialize;

/// A measurement: the test, the name and the unit.
pub type MeasurementKey = (String, String, String);

/// The result of an episode, and what it measured. Of several values of a measurement, the first
/// one counts.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EpisodeValues {
    /// `None` without a result.
    pub passed: Option<bool>,
    /// Finite values.
    pub values: BTreeMap<MeasurementKey, f64>,
}

/// How two versions differ on the same episodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Comparison {
    /// Episodes with a result in both versions.
    pub pairs: u64,
    pub both_passed: u64,
    /// Episodes that passed in the first version only.
    pub only_first: u64,
    /// Episodes that passed in the second version only.
    pub only_second: u64,
    pub none_passed: u64,
    /// Episodes without a result in one of the versions.
    pub without_pair: u64,
    /// McNemar's exact test of the results.
    pub results: PairedComparison,
    pub measurements: Vec<MeasurementComparison>,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeasurementComparison {
    pub test: String,
    pub name: String,
    pub unit: String,
    /// Episodes with a value in both versions.
    pub pairs: u64,
    /// The mean of these values in the first version.
    pub first: f64,
    /// The mean of these values in the second version.
    pub second: f64,
    /// The paired permutation test.
    pub difference: PairedComparison,
}

impl Comparison {
    /// Whether the second version passes less often, and chance explains it with a probability
    /// of at most `alpha`.
    #[must_use]
    pub fn is_worse(&self, alpha: f64) -> bool {
        self.only_first > self.only_second && self.results.p_value <= alpha
    }
}

/// Compares the results of the same episodes, in the same order. `seed` selects the permutations.
#[must_use]
pub fn compare(first: &[EpisodeValues], second: &[EpisodeValues], seed: u64) -> Comparison {
    let count = |wanted: (Option<bool>, Option<bool>)| {
        let pairs = first.iter().zip(second);
        pairs.filter(|(a, b)| (a.passed, b.passed) == wanted).count() as u64
    };
    let (yes, no) = (Some(true), Some(false));
    let (both_passed, none_passed) = (count((yes, yes)), count((no, no)));
    let (only_first, only_second) = (count((yes, no)), count((no, yes)));
    let pairs = both_passed + none_passed + only_first + only_second;
    Comparison {
        pairs,
        both_passed,
        only_first,
        only_second,
        none_passed,
        without_pair: first.len() as u64 - pairs,
        results: mcnemar(only_first, only_second),
        measurements: measurements(first, second, seed),
    }
}

#[expect(clippy::cast_precision_loss, reason = "numbers of episodes are far below 2^53")]
fn measurements(
    first: &[EpisodeValues],
    second: &[EpisodeValues],
    seed: u64,
) -> Vec<MeasurementComparison> {
    let mut pairs: BTreeMap<&MeasurementKey, Vec<(f64, f64)>> = BTreeMap::new();
    for (a, b) in first.iter().zip(second) {
        for (key, value) in &a.values {
            if let Some(other) = b.values.get(key) {
                pairs.entry(key).or_default().push((*value, *other));
            }
        }
    }
    let compared = pairs.into_iter().map(|((test, name, unit), values)| {
        let mean = |side: fn(&(f64, f64)) -> f64| {
            values.iter().map(side).sum::<f64>() / values.len() as f64
        };
        let differences: Vec<f64> = values.iter().map(|(a, b)| b - a).collect();
        MeasurementComparison {
            test: test.clone(),
            name: name.clone(),
            unit: unit.clone(),
            pairs: values.len() as u64,
            first: mean(|(a, _)| *a),
            second: mean(|(_, b)| *b),
            difference: permutation_test(&differences, seed),
        }
    });
    compared.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn episode(passed: Option<bool>, value: f64) -> EpisodeValues {
        let key = ("Carry".to_owned(), "error".to_owned(), "rad".to_owned());
        EpisodeValues { passed, values: BTreeMap::from([(key, value)]) }
    }

    #[test]
    fn episodes_are_compared_in_pairs() {
        let first: Vec<_> = (0..20).map(|id| episode(Some(true), f64::from(id))).collect();
        let mut second: Vec<_> =
            (0..20).map(|id| episode(Some(id >= 8), f64::from(id) + 0.5)).collect();
        second[19].passed = None;
        let found = compare(&first, &second, 1);
        let counts = (found.pairs, found.both_passed, found.only_first, found.only_second);
        assert_eq!((counts, found.without_pair), ((19, 11, 8, 0), 1));
        // Eight of eight pairs that differ: 2 · 0.5⁸.
        assert!((found.results.p_value - 2.0 * 0.5_f64.powi(8)).abs() < 1e-12);
        assert!(found.is_worse(0.05) && !found.is_worse(0.001));
        let error = &found.measurements[0];
        assert_eq!((error.pairs, error.second - error.first), (20, 0.5));
        assert!(error.difference.p_value < 0.001, "{error:?}");
    }

    #[test]
    fn equal_versions_are_not_worse() {
        let all: Vec<_> = (0..10).map(|id| episode(Some(id > 5), 1.0)).collect();
        let found = compare(&all, &all, 1);
        assert_eq!((found.results.different, found.is_worse(0.99)), (0, false));
        assert_eq!(found.measurements[0].difference.different, 0);
    }
}
