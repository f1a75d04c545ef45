//! Where the rate of a series of counts changed: since which campaign more or fewer episodes pass.
//!
//! The series is split at the largest likelihood ratio of two rates against one. The p value is
//! that of the largest ratio of all splits, given the total number of failures ([`exact`]), so a
//! long series has no more false changes than a short one. Both parts are split further (binary
//! segmentation); finally, each change is tested again between its neighbours, and moved or
//! removed.
//!
//! Sources: K. J. Worsley, "The power of likelihood ratio and cumulative sum tests for a change in
//! a binomial probability", Biometrika 70 (1983), 455–464; L. Y. Vostrikova, "Detecting
//! 'disorder' in multidimensional random processes", Soviet Mathematics Doklady 24 (1981), 55–59.

mod exact;

use serde::Serialize;

/// The p value below which a difference is a change: the probability that a series without changes
/// has one called.
pub const LEVEL: f64 = 0.001;

/// How often the changes are tested again.
const REVISIONS: usize = 10;

/// The results of a campaign.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Counts {
    /// How many episodes passed.
    pub passed: u64,
    pub failed: u64,
}

impl Counts {
    /// The number of episodes.
    #[must_use]
    pub fn trials(self) -> u64 {
        self.passed + self.failed
    }

    #[must_use]
    pub fn sum(all: &[Self]) -> Self {
        all.iter().fold(Self::default(), |sum, it| Self {
            passed: sum.passed + it.passed,
            failed: sum.failed + it.failed,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RateChange {
    /// The first counts after the change, as an index into the slice that was searched.
    pub index: usize,
    /// The probability of such a difference, or a larger one, anywhere between the neighbouring
    /// changes, if the rate did not change. Below 1e-9, an upper bound of it.
    pub p_value: f64,
}

/// The changes of the rate with a p value below `level`, in the order of the series.
#[must_use]
pub fn find_rate_changes(counts: &[Counts], level: f64) -> Vec<RateChange> {
    let test = |from: usize, to: usize| {
        let found = best_split(&counts[from..to])?;
        let change = RateChange { index: from + found.index, ..found };
        (change.p_value < level).then_some(change)
    };
    let mut changes = Vec::new();
    let mut parts = vec![(0, counts.len())];
    while let Some((from, to)) = parts.pop() {
        if let Some(change) = test(from, to) {
            parts.extend([(from, change.index), (change.index, to)]);
            changes.push(change);
        }
    }
    changes.sort_by_key(|change| change.index);
    for _ in 0..REVISIONS {
        let before = changes.clone();
        let mut position = 0;
        while position < changes.len() {
            let from = position.checked_sub(1).map_or(0, |previous| changes[previous].index);
            let to = changes.get(position + 1).map_or(counts.len(), |next| next.index);
            match test(from, to) {
                Some(change) => {
                    changes[position] = change;
                    position += 1;
                }
                None => drop(changes.remove(position)),
            }
        }
        if changes == before {
            break;
        }
    }
    changes
}

/// The split with the largest likelihood ratio; of equal ones, the first. `None` if there are no
/// two counts, or all episodes have the same result.
fn best_split(counts: &[Counts]) -> Option<RateChange> {
    let series = exact::Series::new(counts)?;
    let mut best: Option<(usize, f64)> = None;
    for index in 1..counts.len() {
        let ratio = series.ratio(index, series.observed(index));
        if best.is_none_or(|(_, highest)| ratio > highest) {
            best = Some((index, ratio));
        }
    }
    let (index, ratio) = best?;
    Some(RateChange { index, p_value: series.p_value(ratio) })
}

#[cfg(test)]
mod tests;
