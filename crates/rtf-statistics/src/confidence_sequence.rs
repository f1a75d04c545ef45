//! Intervals of a rate that hold at every number of trials, so that a campaign may end at any time.
//!
//! The beta-binomial mixture martingale of H. Robbins, "Statistical methods related to the law of
//! the iterated logarithm", Annals of Mathematical Statistics 41 (1970), 1397–1409, with the
//! mixture Beta(½, ½): with s successes and f failures,
//! M(p) = B(s + ½, f + ½) / B(½, ½) / (pˢ (1 − p)ᶠ). If the rate is p, M(p) exceeds 1/α at any
//! time with a probability of at most α (Ville 1939), so the rates with M(p) < 1/α are a
//! confidence sequence. It is a betting strategy in the sense of I. Waudby-Smith, A. Ramdas,
//! "Estimating means of bounded random variables by betting", Journal of the Royal Statistical
//! Society B 86 (2024), 1–27.

use crate::{Rate, is_probability};

/// ln B(½, ½) = ln π.
const LOG_BETA_HALF: f64 = 1.144_729_885_849_400_2;

/// Halvings of an interval until its ends are neighbouring numbers.
const HALVINGS: u32 = 1100;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConfidenceSequence {
    /// ln(1/α).
    limit: f64,
}

impl ConfidenceSequence {
    /// A sequence whose intervals all contain the rate with a probability of at least
    /// `confidence`. `None` if that is not between 0 and 1.
    #[must_use]
    pub fn new(confidence: f64) -> Option<Self> {
        is_probability(confidence).then(|| Self { limit: -libm::log(1.0 - confidence) })
    }

    /// Whether the interval after these trials excludes a rate between 0 and 1.
    #[must_use]
    pub fn excludes(&self, rate: f64, successes: u64, trials: u64) -> bool {
        successes <= trials && log_martingale(rate, successes, trials - successes) >= self.limit
    }

    /// The rate and its interval after these trials. `None` without trials, or with more
    /// successes than trials.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts of results are far below 2^53")]
    pub fn rate(&self, successes: u64, trials: u64) -> Option<Rate> {
        if trials == 0 || successes > trials {
            return None;
        }
        let value = successes as f64 / trials as f64;
        // The martingale decreases up to the value, and increases from there.
        let low = if successes == 0 { 0.0 } else { self.end(value, 0.0, successes, trials) };
        let high = if successes == trials { 1.0 } else { self.end(value, 1.0, successes, trials) };
        Some(Rate { value, low, high })
    }

    /// The end of the interval between `inside` and `outside`.
    fn end(&self, mut inside: f64, mut outside: f64, successes: u64, trials: u64) -> f64 {
        for _ in 0..HALVINGS {
            let middle = f64::midpoint(inside, outside);
            if middle == inside || middle == outside {
                break;
            }
            if self.excludes(middle, successes, trials) {
                outside = middle;
            } else {
                inside = middle;
            }
        }
        inside
    }
}

/// ln M(p).
#[expect(clippy::cast_precision_loss, reason = "counts of results are far below 2^53")]
fn log_martingale(rate: f64, successes: u64, failures: u64) -> f64 {
    let (s, f) = (successes as f64, failures as f64);
    let log_beta = libm::lgamma(s + 0.5) + libm::lgamma(f + 0.5) - libm::lgamma(s + f + 1.0);
    // Without a trial of a kind, its term is zero, although the logarithm may be infinite.
    let term = |count: f64, log: f64| if count == 0.0 { 0.0 } else { count * log };
    log_beta - LOG_BETA_HALF - term(s, libm::log(rate)) - term(f, libm::log1p(-rate))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn invalid_arguments() {
        assert_eq!(ConfidenceSequence::new(1.0), None);
        assert_eq!(ConfidenceSequence::new(f64::NAN), None);
        let sequence = ConfidenceSequence::new(0.95).expect("valid");
        assert_eq!(sequence.rate(0, 0), None);
        assert_eq!(sequence.rate(2, 1), None);
    }

    proptest! {
        #[test]
        fn the_interval_has_the_value_and_is_what_is_not_excluded(
            (trials, successes) in (1_u64..3000).prop_flat_map(|n| (Just(n), 0..=n)),
            confidence in 0.5..0.999_f64,
            rate in 0.001..0.999_f64,
        ) {
            let sequence = ConfidenceSequence::new(confidence).expect("valid");
            let found = sequence.rate(successes, trials).expect("valid");
            prop_assert!(0.0 <= found.low && found.low <= found.value);
            prop_assert!(found.value <= found.high && found.high <= 1.0);
            let outside = rate < found.low || rate > found.high;
            prop_assert_eq!(sequence.excludes(rate, successes, trials), outside);
        }

        #[test]
        fn it_is_wider_than_an_interval_for_a_fixed_number(
            (trials, successes) in (10_u64..3000).prop_flat_map(|n| (Just(n), 0..=n)),
        ) {
            let any_time = ConfidenceSequence::new(0.95).and_then(|s| s.rate(successes, trials));
            let (any_time, fixed) = (any_time.expect("valid"), crate::rate(successes, trials, 0.95));
            let fixed = fixed.expect("valid");
            prop_assert!(any_time.high - any_time.low > fixed.high - fixed.low);
        }
    }
}
