//! Two versions on different trials: which one is better?

use statrs::distribution::{Discrete, Hypergeometric};

use crate::difference::Counts;
use crate::random::index_below;
use crate::{RandomStream, paired};

/// Statistics are equal if they differ by less than this part: rounding errors.
const RESOLUTION: f64 = 1e-9;

/// The two-sided p value of the exact test of R. A. Fisher, "The logic of inductive inference",
/// Journal of the Royal Statistical Society 98 (1935), 39–82: given how many trials of both
/// versions succeeded, each division among them is as probable as by drawing.
///
/// It is twice the smaller tail, so that a version is found to be worse with half the probability
/// of an error. `statrs` has the other definition, which sums all improbable tables; its
/// probabilities overflow from about 1000 trials on.
#[must_use]
#[expect(clippy::cast_precision_loss, reason = "counts of results are far below 2^53")]
pub fn fisher(first: Counts, second: Counts) -> f64 {
    let rate = |it: &Counts| it.successes as f64 / it.trials as f64;
    let worse = if rate(&first) <= rate(&second) { first } else { second };
    let all = first.trials + second.trials;
    let succeeded = first.successes + second.successes;
    let tail = lower_tail(worse, succeeded, all);
    tail.map_or(1.0, |tail| (2.0 * tail).min(1.0))
}

/// The probability of at most these successes if `succeeded` of `all` trials succeeded.
#[expect(clippy::cast_precision_loss, reason = "counts of results are far below 2^53")]
fn lower_tail(drawn: Counts, succeeded: u64, all: u64) -> Option<f64> {
    let distribution = Hypergeometric::new(all, succeeded, drawn.trials).ok()?;
    let mut term = distribution.ln_pmf(drawn.successes).exp();
    let mut sum = term;
    let [all, succeeded, trials] = [all, succeeded, drawn.trials].map(|count| count as f64);
    for successes in (1..=drawn.successes).rev() {
        let k = successes as f64;
        // The probability of k − 1 successes, divided by that of k.
        term *= k * (all - succeeded - trials + k) / ((succeeded - k + 1.0) * (trials - k + 1.0));
        sum += term;
        if term <= sum * f64::EPSILON {
            break;
        }
    }
    Some(sum)
}

/// The two-sided p value of a permutation test of two samples, with Welch's t as the statistic:
/// if both versions are equal, each value could be of the other version. 1 with fewer than two
/// values in one of them, NaN if a value is not finite.
///
/// Source: R. A. Fisher, "The Design of Experiments" (1935); with Welch's t, it is also valid for
/// many values with equal means and different variances: A. Janssen, "Studentized permutation
/// tests for non-i.i.d. hypotheses and the generalized Behrens–Fisher problem", Statistics &
/// Probability Letters 36 (1997), 9–21. With up to 16 values, all permutations are tried.
#[must_use]
pub fn permutation_test(first: &[f64], second: &[f64], seed: u64) -> f64 {
    let count = first.len();
    if count.min(second.len()) < 2 {
        return 1.0;
    }
    let mut values = [first, second].concat();
    if values.iter().any(|value| !value.is_finite()) {
        return f64::NAN;
    }
    let pooled = Pooled::new(&mut values);
    let limit = pooled.square_of_t(values[..count].iter(), count) * (1.0 - RESOLUTION);
    match values.len() <= paired::MAX_EXACT {
        true => pooled.among_all(&values, count, limit),
        false => pooled.among_random(values, count, limit, seed),
    }
}

/// All values of both samples, around their mean.
struct Pooled {
    count: usize,
    sum: f64,
    squares: f64,
}

impl Pooled {
    #[expect(clippy::cast_precision_loss, reason = "counts of values are far below 2^53")]
    fn new(values: &mut [f64]) -> Self {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        values.iter_mut().for_each(|value| *value -= mean);
        let squares = values.iter().map(|value| value * value).sum();
        Self { count: values.len(), sum: values.iter().sum(), squares }
    }

    /// The share of all divisions whose square of t is at least `limit`.
    fn among_all(&self, values: &[f64], count: usize, limit: f64) -> f64 {
        let (mut tried, mut as_large) = (0_u32, 0_u32);
        for set in (0..1_u32 << values.len()).filter(|set| set.count_ones() as usize == count) {
            let chosen = values.iter().enumerate().filter(|(at, _)| set >> at & 1 == 1);
            tried += 1;
            as_large += u32::from(self.square_of_t(chosen.map(|(_, it)| it), count) >= limit);
        }
        f64::from(as_large) / f64::from(tried)
    }

    /// The share of random divisions, which is never too small.
    fn among_random(&self, mut values: Vec<f64>, count: usize, limit: f64, seed: u64) -> f64 {
        let mut bits = RandomStream::new(seed, "permutation-test", "independent").sequence();
        let mut as_large = 0_u32;
        for _ in 0..paired::RESAMPLES {
            for at in 0..count {
                let other = at + index_below(bits.next().unwrap_or_default(), values.len() - at);
                values.swap(at, other);
            }
            as_large += u32::from(self.square_of_t(values[..count].iter(), count) >= limit);
        }
        f64::from(1 + as_large) / f64::from(1 + paired::RESAMPLES)
    }

    /// The square of Welch's t if these `count` values are the first sample.
    #[expect(clippy::cast_precision_loss, reason = "counts of values are far below 2^53")]
    fn square_of_t<'a>(&self, first: impl Iterator<Item = &'a f64>, count: usize) -> f64 {
        let (mut sum, mut squares) = (0.0, 0.0);
        for value in first {
            sum += value;
            squares += value * value;
        }
        let moments = |sum: f64, squares: f64, count: f64| {
            let variance = (squares - sum * sum / count).max(0.0) / (count - 1.0);
            (sum / count, variance / count)
        };
        let (first, error) = moments(sum, squares, count as f64);
        let rest = (self.count - count) as f64;
        let (second, other_error) = moments(self.sum - sum, self.squares - squares, rest);
        let square = (second - first).powi(2);
        if square == 0.0 { 0.0 } else { square / (error + other_error) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(successes: u64, trials: u64) -> Counts {
        Counts { successes, trials }
    }

    #[test]
    fn equal_rates_and_no_trials() {
        assert_eq!(fisher(counts(3, 10), counts(3, 10)), 1.0);
        assert_eq!(fisher(counts(0, 0), counts(3, 10)), 1.0);
        assert_eq!(fisher(counts(0, 5), counts(0, 7)), 1.0);
        assert_eq!(fisher(counts(5, 5), counts(7, 7)), 1.0);
    }

    #[test]
    fn both_versions_are_treated_alike() {
        let (a, b) = (counts(17, 40), counts(39, 55));
        assert_eq!(fisher(a, b), fisher(b, a));
        let failed = |it: Counts| counts(it.trials - it.successes, it.trials);
        assert!((fisher(a, b) - fisher(failed(a), failed(b))).abs() < 1e-12);
        let (x, y) = ([1.0, 2.5, 3.0], [2.0, 4.5, 7.0, 3.5]);
        assert_eq!(permutation_test(&x, &y, 1), permutation_test(&y, &x, 1));
    }

    #[test]
    fn many_trials() {
        // Twice scipy.stats.fisher_exact([[4500, 500], [4600, 400]], 'less').
        let found = fisher(counts(4500, 5000), counts(4600, 5000));
        assert!((found / 0.000_535_650_527_062 - 1.0).abs() < 1e-9, "{found}");
    }

    #[test]
    fn random_divisions_agree_with_all() {
        let mut values: Vec<f64> = (1..=14).map(|n| f64::from(n * 7 % 18 - 6)).collect();
        let pooled = Pooled::new(&mut values);
        let limit = pooled.square_of_t(values[..6].iter(), 6);
        let (all, random) =
            (pooled.among_all(&values, 6, limit), pooled.among_random(values, 6, limit, 3));
        assert!((all - random).abs() < 0.02 && all < 1.0, "{all} != {random}");
        let same: Vec<f64> = (0..30).map(f64::from).collect();
        assert_eq!(permutation_test(&same, &same, 1), 1.0);
    }

    #[test]
    fn few_values_or_none_of_use() {
        assert_eq!(permutation_test(&[1.0], &[2.0, 3.0], 1), 1.0);
        assert!(permutation_test(&[1.0, f64::NAN], &[2.0, 3.0], 1).is_nan());
        assert_eq!(permutation_test(&[1.0; 4], &[1.0; 4], 1), 1.0);
        // 2 of 70 divisions separate them.
        assert_eq!(permutation_test(&[1.0; 4], &[2.0; 4], 1), 2.0 / 70.0);
    }
}
