//! A rate with its Wilson score interval.
//!
//! Source: E. B. Wilson, "Probable inference, the law of succession, and statistical inference",
//! Journal of the American Statistical Association 22 (1927), 209–212, without continuity
//! correction. It keeps its confidence for few trials and for rates near 0 and 1: L. D. Brown,
//! T. T. Cai, A. DasGupta, "Interval estimation for a binomial proportion", Statistical Science 16
//! (2001), 101–133.

use serde::{Deserialize, Serialize};
use statrs::function::erf::erf_inv;
use utoipa::ToSchema;

/// The usual confidence of an interval.
pub const CONFIDENCE: f64 = 0.95;

/// A rate and its confidence interval. All fields are between 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Rate {
    /// Successes per trial.
    pub value: f64,
    /// The lower end of the interval.
    pub low: f64,
    /// The upper end of the interval.
    pub high: f64,
}

/// The rate of `successes` in `trials` with its interval, for a `confidence` between 0 and 1.
///
/// `None` if there are no trials, more successes than trials, or another confidence. The interval
/// is for a number of trials that was fixed in advance: do not stop a series of trials when it
/// reaches a value.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "counts of results are far below 2^53")]
pub fn rate(successes: u64, trials: u64, confidence: f64) -> Option<Rate> {
    let valid = trials > 0 && successes <= trials && confidence > 0.0 && confidence < 1.0;
    if !valid {
        return None;
    }
    // The quantile of the normal distribution at (1 + confidence) / 2.
    let z = std::f64::consts::SQRT_2 * erf_inv(confidence);
    let n = trials as f64;
    let value = successes as f64 / n;
    let centre = value + z * z / (2.0 * n);
    let half = z * (value * (1.0 - value) / n + z * z / (4.0 * n * n)).sqrt();
    let scale = 1.0 + z * z / n;
    // At both ends, rounding errors would exclude the value itself.
    let low = if successes == 0 { 0.0 } else { (centre - half) / scale };
    let high = if successes == trials { 1.0 } else { (centre + half) / scale };
    Some(Rate { value, low, high })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn intervals_equal_those_of_scipy() {
        // scipy.stats.binomtest(k, n).proportion_ci(confidence, "wilson") of SciPy 1.17.1
        let cases = [
            (0, 10, 0.95, 0.0, 0.277_532_799_862_889_26),
            (10, 10, 0.95, 0.722_467_200_137_110_7, 1.0),
            (5, 10, 0.95, 0.236_593_090_512_564, 0.763_406_909_487_436_1),
            (1, 1, 0.95, 0.206_549_314_377_237_45, 1.0),
            (81, 263, 0.95, 0.255_288_519_878_274_2, 0.366_209_576_982_800_04),
            (98, 100, 0.99, 0.904_183_017_022_907_6, 0.996_085_122_769_902_5),
            (3, 1_000_000, 0.95, 1.020_271_240_968_122_3e-6, 8.821_149_774_312_435e-6),
        ];
        for (successes, trials, confidence, low, high) in cases {
            let rate = rate(successes, trials, confidence).expect("valid");
            assert!((rate.low - low).abs() <= 1e-9 * low, "{rate:?} != {low}");
            assert!((rate.high - high).abs() <= 1e-9 * high, "{rate:?} != {high}");
        }
    }

    #[test]
    fn invalid_arguments_have_no_rate() {
        assert_eq!(rate(0, 0, 0.95), None);
        assert_eq!(rate(2, 1, 0.95), None);
        for confidence in [0.0, 1.0, -1.0, f64::NAN] {
            assert_eq!(rate(1, 2, confidence), None);
        }
    }

    proptest! {
        #[test]
        fn interval_has_the_value_and_is_in_the_unit_interval(
            (trials, successes) in (1_u64..10_000).prop_flat_map(|n| (Just(n), 0..=n)),
            confidence in 0.01..0.999_f64,
        ) {
            let found = rate(successes, trials, confidence).expect("valid");
            prop_assert!(0.0 <= found.low && found.low <= found.value);
            prop_assert!(found.value <= found.high && found.high <= 1.0);
        }

        #[test]
        fn more_trials_of_one_rate_narrow_the_interval(successes in 0_u64..50, others in 0_u64..50) {
            prop_assume!(successes + others > 0);
            let width = |factor: u64| {
                let rate = rate(factor * successes, factor * (successes + others), CONFIDENCE);
                rate.map(|rate| rate.high - rate.low)
            };
            prop_assert!(width(4) < width(1));
        }

        #[test]
        fn failures_have_the_mirrored_interval(successes in 0_u64..100, others in 1_u64..100) {
            let trials = successes + others;
            let a = rate(successes, trials, CONFIDENCE).expect("valid");
            let b = rate(others, trials, CONFIDENCE).expect("valid");
            prop_assert!((a.low + b.high - 1.0).abs() < 1e-12);
        }
    }
}
