//! The sequential probability ratio test of a rate.
//!
//! Source: A. Wald, "Sequential tests of statistical hypotheses", Annals of Mathematical
//! Statistics 16 (1945), 117–186. Wald's thresholds, (1 − β)/α and β/(1 − α), bound only the sum
//! of both error rates. The thresholds here, 1/α and β, bound each of them, by the inequality of
//! Ville (1939) for the likelihood ratio, which is a martingale. The expected number of trials
//! increases by a few per cent.

use crate::is_probability;

/// The rate that a test accepts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Accepted {
    Low,
    High,
}

/// A sequential test of two rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sprt {
    /// The change of the logarithm of the likelihood ratio by a success, above zero.
    success: f64,
    /// The change by a failure, below zero.
    failure: f64,
    /// From here on, the higher rate is accepted.
    upper: f64,
    /// From here on, the lower rate is accepted.
    lower: f64,
}

impl Sprt {
    /// A test that accepts the higher rate with a probability of at most `alpha` if the rate is at
    /// most `low`, and the lower rate with a probability of at most `beta` if the rate is at least
    /// `high`.
    ///
    /// `None` if a number is not between 0 and 1, or `low` is not less than `high`.
    #[must_use]
    pub fn new(low: f64, high: f64, alpha: f64, beta: f64) -> Option<Self> {
        let valid = [low, high, alpha, beta].into_iter().all(is_probability) && low < high;
        valid.then(|| Self {
            success: libm::log(high / low),
            failure: libm::log((1.0 - high) / (1.0 - low)),
            upper: -libm::log(alpha),
            lower: libm::log(beta),
        })
    }

    /// The rate that is accepted after these trials; `None` to continue. The first answer counts:
    /// ask after each trial.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts of results are far below 2^53")]
    pub fn accepted(&self, successes: u64, failures: u64) -> Option<Accepted> {
        let log_ratio = successes as f64 * self.success + failures as f64 * self.failure;
        if log_ratio >= self.upper {
            Some(Accepted::High)
        } else if log_ratio <= self.lower {
            Some(Accepted::Low)
        } else {
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_test_without_failures() {
        // ln(20)/ln(0.97/0.9) = 39.99…: 40 successes in sequence are enough.
        let test = Sprt::new(0.9, 0.97, 0.05, 0.05).expect("valid");
        assert_eq!(test.accepted(39, 0), None);
        assert_eq!(test.accepted(40, 0), Some(Accepted::High));
        assert_eq!(test.accepted(0, 2), None);
        assert_eq!(test.accepted(0, 3), Some(Accepted::Low));
    }

    #[test]
    fn invalid_tests() {
        assert_eq!(Sprt::new(0.9, 0.9, 0.05, 0.05), None);
        assert_eq!(Sprt::new(0.9, 1.0, 0.05, 0.05), None);
        assert_eq!(Sprt::new(0.0, 0.9, 0.05, 0.05), None);
        assert_eq!(Sprt::new(0.8, 0.9, 0.0, 0.05), None);
        assert_eq!(Sprt::new(0.8, 0.9, 0.05, f64::NAN), None);
    }
}
