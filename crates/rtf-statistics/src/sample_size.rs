//! How many trials a comparison of two rates needs, from the probabilities of all results of its
//! exact test.

use std::ops::RangeInclusive;

use statrs::distribution::{Binomial, Discrete, DiscreteCDF};

use crate::difference::Counts;
use crate::independent::fisher;
use crate::paired::mcnemar;

/// The most trials that are searched.
pub const MAX_TRIALS: u64 = 100_000;

/// The probability that McNemar's test of this many pairs finds the better version with p ≤
/// `alpha`. Only the better version passes a pair with the probability `only_better`, only the
/// worse one with `only_worse`.
#[must_use]
pub fn paired_power(pairs: u64, only_better: f64, only_worse: f64, alpha: f64) -> f64 {
    let discordant = only_better + only_worse;
    let Ok(different) = Binomial::new(discordant.min(1.0), pairs) else { return f64::NAN };
    // Against the better version there may be 0 … `found` − 1 pairs, the more, the more differ.
    let (mut power, mut found) = (0.0, 0);
    for count in likely(pairs, discordant) {
        while 2 * found < count && mcnemar(found, count - found).p_value <= alpha {
            found += 1;
        }
        let against = Binomial::new((only_worse / discordant).clamp(0.0, 1.0), count);
        if let (Some(most), Ok(against)) = (found.checked_sub(1), against) {
            power += different.pmf(count) * against.cdf(most);
        }
    }
    power
}

/// The probability that Fisher's test of two versions with this many trials each finds the better
/// one with p ≤ `alpha`.
#[must_use]
pub fn independent_power(trials: u64, better: f64, worse: f64, alpha: f64) -> f64 {
    let distributions = (Binomial::new(better, trials), Binomial::new(worse, trials));
    let (Ok(of_better), Ok(of_worse)) = distributions else { return f64::NAN };
    let p_value = |worse: u64, better: u64| {
        let counts = |successes| Counts { successes, trials };
        fisher(counts(worse), counts(better))
    };
    let (mut power, mut found) = (0.0, 0);
    for successes in likely(trials, better) {
        while found < successes && p_value(found, successes) <= alpha {
            found += 1;
        }
        if let Some(most) = found.checked_sub(1) {
            power += of_better.pmf(successes) * of_worse.cdf(most);
        }
    }
    power
}

/// A number of trials with at least this power, with the power that it has; about the smallest
/// one, because the power of an exact test falls a little whenever one more failure is necessary.
/// `None` above [`MAX_TRIALS`].
pub fn sufficient_trials(power: f64, power_of: impl Fn(u64) -> f64) -> Option<(u64, f64)> {
    let (mut few, mut enough) = (0, 1);
    let mut reached = power_of(enough);
    while reached < power {
        if enough == MAX_TRIALS {
            return None;
        }
        (few, enough) = (enough, (2 * enough).min(MAX_TRIALS));
        reached = power_of(enough);
    }
    while enough - few > 1 {
        let middle = u64::midpoint(few, enough);
        let of_middle = power_of(middle);
        if of_middle >= power {
            (enough, reached) = (middle, of_middle);
        } else {
            few = middle;
        }
    }
    Some((enough, reached))
}

/// The numbers of successes that are not negligible: the others have a probability below 1e-12,
/// and count as not found.
#[expect(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "counts of trials are far below 2^53"
)]
fn likely(trials: u64, rate: f64) -> RangeInclusive<u64> {
    let mean = trials as f64 * rate;
    let reach = 8.0 * (mean * (1.0 - rate)).max(0.0).sqrt() + 16.0;
    ((mean - reach).max(0.0) as u64)..=((mean + reach) as u64).min(trials)
}
