//! Two versions on the same trials: which one is better?

use serde::Serialize;
use statrs::function::beta::checked_beta_reg;

use crate::RandomStream;

/// Up to this number of differences other than zero, all signs are tried.
pub(crate) const MAX_EXACT: usize = 16;

/// The number of random signs otherwise.
pub(crate) const RESAMPLES: u32 = 9999;

/// Sums are equal if they differ by less than this part: rounding errors.
const RESOLUTION: f64 = 1e-13;

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PairedComparison {
    /// The number of pairs that differ. The others do not say which version is better.
    pub different: u64,
    /// The two-sided p value: the probability of a difference of this size or larger if both
    /// versions are equal. 1 without differences.
    pub p_value: f64,
}

/// Compares how often only the first and only the second version passed.
///
/// The exact test of Q. McNemar, "Note on the sampling error of the difference between correlated
/// proportions or percentages", Psychometrika 12 (1947), 153–157: if both are equal, each of the
/// pairs that differ is for either version with probability ½.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "counts of results are far below 2^53")]
pub fn mcnemar(only_first: u64, only_second: u64) -> PairedComparison {
    let different = only_first + only_second;
    let fewer = only_first.min(only_second);
    if fewer * 2 == different {
        return PairedComparison { different, p_value: 1.0 };
    }
    // P(X ≤ k) of a binomial distribution is a regularised incomplete beta function.
    let tail = checked_beta_reg((different - fewer) as f64, (fewer + 1) as f64, 0.5);
    PairedComparison { different, p_value: tail.map_or(f64::NAN, |tail| (2.0 * tail).min(1.0)) }
}

/// Compares a measurement: `differences` has the second value minus the first for each pair.
///
/// The paired permutation test of R. A. Fisher, The Design of Experiments (1935), §21: if both
/// versions are equal, each difference could have the other sign. With more than 16 differences,
/// 9999 random signs are tried, and p is (1 + as large)/(1 + tried), which is never too small: B.
/// Phipson, G. K. Smyth, "Permutation p-values should never be zero", Statistical Applications in
/// Genetics and Molecular Biology 9 (2010), 39. Differences that are not finite make p NaN.
#[must_use]
pub fn permutation_test(differences: &[f64], seed: u64) -> PairedComparison {
    let nonzero: Vec<f64> = differences.iter().copied().filter(|d| *d != 0.0).collect();
    let different = nonzero.len() as u64;
    let observed = nonzero.iter().sum::<f64>().abs();
    if nonzero.iter().any(|d| !d.is_finite()) {
        return PairedComparison { different, p_value: f64::NAN };
    }
    let limit = observed * (1.0 - RESOLUTION);
    let p_value = if nonzero.len() <= MAX_EXACT {
        let all = 1_u32 << nonzero.len();
        let as_large = (0..all)
            .filter(|signs| signed_sum(&nonzero, |index| signs >> index & 1 == 1).abs() >= limit);
        f64::from(u32::try_from(as_large.count()).unwrap_or(all)) / f64::from(all)
    } else {
        let mut bits = RandomStream::new(seed, "permutation-test", "").sequence();
        let mut words = vec![0; nonzero.len().div_ceil(64)];
        let mut as_large = 0_u32;
        for _ in 0..RESAMPLES {
            words.iter_mut().zip(&mut bits).for_each(|(word, random)| *word = random);
            let sum = signed_sum(&nonzero, |index| words[index / 64] >> (index % 64) & 1 == 1);
            as_large += u32::from(sum.abs() >= limit);
        }
        f64::from(1 + as_large) / f64::from(1 + RESAMPLES)
    };
    PairedComparison { different, p_value }
}

fn signed_sum(values: &[f64], is_negative: impl Fn(usize) -> bool) -> f64 {
    let signed = |(index, value): (usize, &f64)| if is_negative(index) { -value } else { *value };
    values.iter().enumerate().map(signed).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn equal_versions() {
        assert_eq!(mcnemar(0, 0), PairedComparison { different: 0, p_value: 1.0 });
        assert_eq!(mcnemar(4, 4), PairedComparison { different: 8, p_value: 1.0 });
        let equal = permutation_test(&[0.0; 40], 1);
        assert_eq!(equal, PairedComparison { different: 0, p_value: 1.0 });
    }

    #[test]
    fn both_versions_are_treated_alike() {
        assert_eq!(mcnemar(3, 11).p_value, mcnemar(11, 3).p_value);
        let values = [0.5, -0.25, 0.75, 0.125, 1.0];
        let mirrored = values.map(|value| -value);
        assert_eq!(permutation_test(&values, 1).p_value, permutation_test(&mirrored, 1).p_value);
    }

    #[test]
    fn a_difference_in_all_pairs() {
        assert!((mcnemar(0, 10).p_value - 2.0 / 1024.0).abs() < 1e-15);
        assert_eq!(permutation_test(&[1.0; 10], 1).p_value, 2.0 / 1024.0);
        // No random sign reaches the sum of 40 equal differences.
        assert_eq!(permutation_test(&[1.0; 40], 1).p_value, 1.0 / 10_000.0);
    }

    #[test]
    fn random_signs_agree_with_all_signs() {
        // 17 differences, so the signs are random; the exact value is from all 2^17.
        let values: Vec<f64> = (1..=17).map(|n| f64::from(n * 7 % 18 - 6)).collect();
        let nonzero: Vec<f64> = values.iter().copied().filter(|value| *value != 0.0).collect();
        let observed = nonzero.iter().sum::<f64>().abs();
        let all = 1_u32 << nonzero.len();
        let as_large = (0..all)
            .filter(|signs| signed_sum(&nonzero, |i| signs >> i & 1 == 1).abs() >= observed)
            .count();
        let exact = as_large as f64 / f64::from(all);
        let more: Vec<f64> = values.iter().copied().chain([1e-9]).collect();
        let found = permutation_test(&more, 3).p_value;
        assert!((found - exact).abs() < 0.02, "{found} != {exact}");
    }

    #[test]
    fn no_comparison_of_values_that_are_not_finite() {
        assert!(permutation_test(&[1.0, f64::NAN], 1).p_value.is_nan());
        assert!(permutation_test(&[1.0, f64::INFINITY], 1).p_value.is_nan());
    }
}
