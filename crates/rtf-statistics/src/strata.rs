//! Rates by bins of a parameter.

use serde::Serialize;

use crate::{Rate, rate};

/// The results with values in a bin.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Stratum {
    pub low: f64,
    /// The highest value: excluded, except in the last bin.
    pub high: f64,
    pub trials: u64,
    pub successes: u64,
    /// The rate with its Wilson interval; `None` for an empty bin. Each interval has the
    /// confidence for itself; that all hold at once is less certain.
    pub rate: Option<Rate>,
}

/// Divides the range of the values into `bins` of equal width, and counts the results, each a
/// value and whether it passed. Values that are not finite are left out. Equal values are in one
/// bin. Empty without values or bins.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "numbers of bins are far below 2^53")]
pub fn strata(results: &[(f64, bool)], bins: usize, confidence: f64) -> Vec<Stratum> {
    let values = || results.iter().map(|(value, _)| *value).filter(|value| value.is_finite());
    let lowest = values().fold(f64::INFINITY, f64::min);
    let highest = values().fold(f64::NEG_INFINITY, f64::max);
    if lowest > highest {
        return Vec::new();
    }
    let bins = if lowest == highest { bins.min(1) } else { bins };
    // Not `lowest + part * (highest - lowest)`: the difference of two large values overflows.
    let end = |bin: usize| {
        let part = bin as f64 / bins as f64;
        if bin == bins { highest } else { lowest * (1.0 - part) + highest * part }
    };
    let mut strata: Vec<Stratum> = (0..bins)
        .map(|bin| Stratum {
            low: end(bin),
            high: end(bin + 1),
            trials: 0,
            successes: 0,
            rate: None,
        })
        .collect();
    for (value, passed) in results.iter().filter(|(value, _)| value.is_finite()) {
        let after = strata.partition_point(|stratum| stratum.low <= *value);
        if let Some(stratum) = strata.get_mut(after.saturating_sub(1)) {
            stratum.trials += 1;
            stratum.successes += u64::from(*passed);
        }
    }
    for stratum in &mut strata {
        stratum.rate = rate(stratum.successes, stratum.trials, confidence);
    }
    strata
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ends_belong_to_one_bin() {
        let results = [(0.0, true), (1.0, false), (2.0, true), (4.0, true), (f64::NAN, true)];
        let found = strata(&results, 2, 0.95);
        let counts: Vec<_> = found.iter().map(|s| (s.low, s.high, s.trials, s.successes)).collect();
        assert_eq!(counts, [(0.0, 2.0, 2, 1), (2.0, 4.0, 2, 2)]);
        assert_eq!(found[1].rate, rate(2, 2, 0.95));
    }

    #[test]
    fn few_values() {
        assert_eq!(strata(&[], 3, 0.95), []);
        assert_eq!(strata(&[(1.0, true)], 0, 0.95), []);
        let one = strata(&[(1.0, true), (1.0, false)], 3, 0.95);
        assert_eq!((one.len(), one[0].trials, one[0].successes), (1, 2, 1));
    }

    proptest! {
        #[test]
        fn each_result_is_in_the_bin_of_its_value(
            results in prop::collection::vec((-1e308..1e308_f64, any::<bool>()), 1..50),
            bins in 1_usize..9,
        ) {
            let found = strata(&results, bins, 0.95);
            prop_assert_eq!(found.iter().map(|s| s.trials).sum::<u64>(), results.len() as u64);
            for (index, stratum) in found.iter().enumerate() {
                let is_last = index + 1 == found.len();
                let inside = |value: f64| {
                    value >= stratum.low && (value < stratum.high || is_last)
                };
                let expected = results.iter().filter(|(value, _)| inside(*value)).count();
                prop_assert_eq!(stratum.trials, expected as u64);
            }
        }
    }
}
