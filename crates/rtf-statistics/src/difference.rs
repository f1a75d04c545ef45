//! The difference of two rates, or of two means, with its interval: how large an effect is.

use serde::Serialize;
use statrs::distribution::{ContinuousCDF, StudentsT};

use crate::rate;

/// The second version minus the first one.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Difference {
    pub value: f64,
    /// The lower end of the interval.
    pub low: f64,
    /// The upper end of the interval.
    pub high: f64,
}

/// How many of some trials were successes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    pub successes: u64,
    pub trials: u64,
}

/// The results of two versions in the same trials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PairCounts {
    pub both_passed: u64,
    pub only_first: u64,
    pub only_second: u64,
    pub none_passed: u64,
}

impl PairCounts {
    #[must_use]
    pub fn pairs(&self) -> u64 {
        self.both_passed + self.only_first + self.only_second + self.none_passed
    }

    /// The correlation of the results, with the continuity correction of Newcombe's method 10.
    #[expect(clippy::cast_precision_loss, reason = "counts of results are far below 2^53")]
    fn correlation(&self) -> f64 {
        let [both, first, second, none] =
            [self.both_passed, self.only_first, self.only_second, self.none_passed]
                .map(|count| count as f64);
        let margins = (both + first) * (second + none) * (both + second) * (first + none);
        let product = both * none - first * second;
        let corrected = match product > 0.0 {
            true => (product - self.pairs() as f64 / 2.0).max(0.0),
            false => product,
        };
        if margins > 0.0 { corrected / margins.sqrt() } else { 0.0 }
    }
}

/// The difference of two rates of different trials.
///
/// Source: R. G. Newcombe, "Interval estimation for the difference between independent
/// proportions: comparison of eleven methods", Statistics in Medicine 17 (1998), 873–890, method
/// 10. `None` without trials in both, or if the confidence is not between 0 and 1.
#[must_use]
pub fn of_rates(first: Counts, second: Counts, confidence: f64) -> Option<Difference> {
    square_and_add(first, second, 0.0, confidence)
}

/// The difference of two rates of the same trials.
///
/// Source: R. G. Newcombe, "Improved confidence intervals for the difference between binomial
/// proportions based on paired data", Statistics in Medicine 17 (1998), 2635–2650, method 10;
/// recommended by M. W. Fagerland, S. Lydersen, P. Laake, "Recommended tests and confidence
/// intervals for paired binomial proportions", Statistics in Medicine 33 (2014), 2850–2875.
/// `None` without pairs, or if the confidence is not between 0 and 1.
#[must_use]
pub fn of_paired_rates(pairs: &PairCounts, confidence: f64) -> Option<Difference> {
    let counts = |only: u64| Counts { successes: pairs.both_passed + only, trials: pairs.pairs() };
    let (first, second) = (counts(pairs.only_first), counts(pairs.only_second));
    square_and_add(first, second, pairs.correlation(), confidence)
}

/// Combines the distances from both rates to the ends of their Wilson intervals.
fn square_and_add(
    first: Counts,
    second: Counts,
    correlation: f64,
    confidence: f64,
) -> Option<Difference> {
    let first = rate(first.successes, first.trials, confidence)?;
    let second = rate(second.successes, second.trials, confidence)?;
    let add = |a: f64, b: f64| (a * a - 2.0 * correlation * a * b + b * b).max(0.0).sqrt();
    let value = second.value - first.value;
    Some(Difference {
        value,
        low: value - add(second.value - second.low, first.high - first.value),
        high: value + add(second.high - second.value, first.value - first.low),
    })
}

/// The mean of differences in pairs.
///
/// Source: Student (W. S. Gosset), "The probable error of a mean", Biometrika 6 (1908), 1–25. The
/// interval has its confidence if the differences have a normal distribution, and about that for
/// many differences. `None` with fewer than two.
#[must_use]
pub fn of_paired_means(differences: &[f64], confidence: f64) -> Option<Difference> {
    let sample = Sample::of(differences)?;
    interval(sample.mean, sample.error(), sample.count - 1.0, confidence)
}

/// The difference of the means of two samples, whose variances may differ.
///
/// Source: B. L. Welch, "The generalization of 'Student's' problem when several different
/// population variances are involved", Biometrika 34 (1947), 28–35. `None` with fewer than two
/// values in one of them.
#[must_use]
pub fn of_means(first: &[f64], second: &[f64], confidence: f64) -> Option<Difference> {
    let (first, second) = (Sample::of(first)?, Sample::of(second)?);
    let error = first.error() + second.error();
    let part = |sample: &Sample| sample.error().powi(2) / (sample.count - 1.0);
    let freedom = error * error / (part(&first) + part(&second));
    interval(second.mean - first.mean, error, freedom, confidence)
}

struct Sample {
    count: f64,
    mean: f64,
    variance: f64,
}

impl Sample {
    #[expect(clippy::cast_precision_loss, reason = "counts of values are far below 2^53")]
    fn of(values: &[f64]) -> Option<Self> {
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
        (values.len() >= 2).then(|| Self { count, mean, variance: squares / (count - 1.0) })
    }

    /// The variance of the mean.
    fn error(&self) -> f64 {
        self.variance / self.count
    }
}

/// Student's interval for a mean whose variance is `error`.
fn interval(value: f64, error: f64, freedom: f64, confidence: f64) -> Option<Difference> {
    if !crate::is_probability(confidence) || !error.is_finite() {
        return None;
    }
    if error == 0.0 {
        return Some(Difference { value, low: value, high: value });
    }
    let student = StudentsT::new(0.0, 1.0, freedom).ok()?;
    let half = student.inverse_cdf(f64::midpoint(1.0, confidence)) * error.sqrt();
    Some(Difference { value, low: value - half, high: value + half })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(successes: u64, trials: u64) -> Counts {
        Counts { successes, trials }
    }

    #[track_caller]
    fn assert_published(found: Option<Difference>, value: f64, low: f64, high: f64) {
        let found = found.expect("an interval");
        for (found, expected) in [(found.value, value), (found.low, low), (found.high, high)] {
            assert!((found - expected).abs() < 0.000_51, "{found} != {expected}");
        }
    }

    #[test]
    fn published_intervals() {
        // Newcombe (1998), 873–890, table II, method 10; the second proportion is subtracted there.
        for (first, second, value, low, high) in [
            (counts(48, 80), counts(56, 70), 0.2, 0.0524, 0.3339),
            (counts(3, 10), counts(9, 10), 0.6, 0.1705, 0.8090),
            (counts(2, 7), counts(6, 7), 0.5714, 0.0582, 0.8062),
            (counts(0, 29), counts(5, 56), 0.0893, -0.0381, 0.1926),
            (counts(0, 10), counts(10, 10), 1.0, 0.6075, 1.0),
        ] {
            assert_published(of_rates(first, second, 0.95), value, low, high);
        }
        // Fagerland, Lydersen, Laake (2014), the data of Bentur and others (2009).
        let pairs = PairCounts { both_passed: 1, only_first: 1, only_second: 7, none_passed: 12 };
        assert_published(of_paired_rates(&pairs, 0.95), 6.0 / 21.0, 0.026, 0.507);
    }

    #[test]
    fn no_interval_without_values() {
        assert_eq!(of_rates(counts(0, 0), counts(1, 2), 0.95), None);
        assert_eq!(of_paired_rates(&PairCounts::default(), 0.95), None);
        assert_eq!(of_paired_means(&[1.0], 0.95), None);
        assert_eq!(of_means(&[1.0, 2.0], &[1.0], 0.95), None);
        assert_eq!(of_means(&[1.0, 2.0], &[1.0, f64::INFINITY], 0.95), None);
        assert_eq!(of_paired_means(&[1.0, 2.0], 1.0), None);
    }

    #[test]
    fn equal_differences_have_a_point() {
        let point = Difference { value: 2.0, low: 2.0, high: 2.0 };
        assert_eq!(of_paired_means(&[2.0; 5], 0.95), Some(point));
        assert_eq!(of_means(&[1.0; 3], &[3.0; 4], 0.95), Some(point));
    }
}
