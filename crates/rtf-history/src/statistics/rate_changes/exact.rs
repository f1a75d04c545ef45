//! The distribution of the largest likelihood ratio of all splits of a series of counts, given the
//! total number of failures.
//!
//! If the rate does not change, each arrangement of the failures among the episodes has the same
//! probability. The numbers of failures up to each split are then a Markov chain: its paths on
//! which no ratio reaches the observed one are summed split by split (Worsley 1983, section 3).

use statrs::function::factorial::ln_binomial;

use super::Counts;

/// Below this probability, a bound replaces the sum.
const BOUND: f64 = 1e-9;
/// Terms below this have no effect on the sum.
const NEGLIGIBLE: f64 = 1e-20;
/// Ratios that differ by less are equal: rounding errors.
const RESOLUTION: f64 = 1e-9;

/// A series of counts. The rarer result, failed or passed, is counted.
pub(super) struct Series {
    /// Up to each split, from 0 to the whole series: trials, and how many have the rarer result.
    sums: Vec<(u64, u64)>,
    /// The share of the rarer result.
    share: f64,
}

impl Series {
    /// `None` if there are not two counts, or all trials have the same result.
    pub fn new(counts: &[Counts]) -> Option<Self> {
        let total = Counts::sum(counts);
        let of = |it: &Counts| if total.failed <= total.passed { it.failed } else { it.passed };
        let mut sums = vec![(0, 0)];
        let (mut trials, mut rare) = (0, 0);
        for count in counts {
            trials += count.trials();
            rare += of(count);
            sums.push((trials, rare));
        }
        let is_valid = counts.len() > 1 && rare > 0;
        is_valid.then(|| Self { sums, share: real(rare) / real(trials) })
    }

    /// How many rarer results there are before a split.
    pub fn observed(&self, split: usize) -> u64 {
        self.sums[split].1
    }

    fn totals(&self) -> (u64, u64) {
        self.sums.last().copied().unwrap_or_default()
    }

    /// Twice the logarithm of the likelihood ratio of two rates against one, if `rare` of the
    /// rarer results are before the split.
    pub fn ratio(&self, split: usize, rare: u64) -> f64 {
        let (trials, all) = self.totals();
        let before = self.sums[split].0;
        let of = |rare: u64, trials: u64| {
            let term = |part: u64, share: f64| {
                let part = real(part);
                if part > 0.0 { part * (part / (real(trials) * share)).ln() } else { 0.0 }
            };
            term(rare, self.share) + term(trials - rare, 1.0 - self.share)
        };
        (2.0 * (of(rare, before) + of(all - rare, trials - before))).max(0.0)
    }

    /// The probability that the ratio of any split is at least this.
    pub fn p_value(&self, ratio: f64) -> f64 {
        let bound = self.bound(ratio);
        if bound < BOUND { bound } else { self.exact(ratio).min(1.0) }
    }

    /// An upper bound. The probability of a number of rarer results before a split is at most
    /// exp(−ratio/2), divided by the binomial probability of their total at its own share, which
    /// is at least 1/√(8·n·p·(1 − p)) (R. G. Gallager, "Information Theory and Reliable
    /// Communication" (1968), problem 5.8).
    fn bound(&self, ratio: f64) -> f64 {
        let (trials, all) = self.totals();
        let variance = real(trials) * self.share * (1.0 - self.share);
        let cases = real(self.sums.len() as u64) * real(all + 1);
        cases * (8.0 * variance).sqrt() * (-ratio / 2.0).exp()
    }

    fn exact(&self, ratio: f64) -> f64 {
        let ratio = ratio * (1.0 - RESOLUTION);
        let (trials, all) = self.totals();
        let normal = self.ln_probability(all, trials);
        // Of each number of rarer results from `first` on: the probability of the paths to it.
        let (mut first, mut paths) = (0, vec![1.0]);
        let mut reached = 0.0;
        for split in 1..self.sums.len() - 1 {
            let (before, rest) = (self.sums[split].0, trials - self.sums[split].0);
            let count = before - self.sums[split - 1].0;
            let next = self.step(&paths, first, count);
            let (low, high) = self.below(split, ratio);
            let end = next.0 + next.1.len() as u64;
            for (rare, probability) in (next.0..end).zip(&next.1) {
                let is_possible = rare <= all && all - rare <= rest;
                if is_possible && !(low..high).contains(&rare) {
                    let others = self.ln_probability(all - rare, rest) - normal;
                    reached += probability * others.exp();
                }
            }
            let (low, high) = (low.max(next.0), high.min(end));
            let kept = |at: u64| usize::try_from(at - next.0).unwrap_or_default();
            paths = match low < high {
                true => next.1[kept(low)..kept(high)].to_vec(),
                false => return reached,
            };
            first = low;
        }
        reached
    }

    /// The paths after `count` more trials.
    fn step(&self, paths: &[f64], first: u64, count: u64) -> (u64, Vec<f64>) {
        let (offset, added) = self.likely(count);
        let mut next = vec![0.0; paths.len() + added.len()];
        for (at, path) in paths.iter().enumerate().filter(|(_, path)| **path > 0.0) {
            for (sum, more) in next[at..].iter_mut().zip(&added) {
                *sum += path * more;
            }
        }
        (first + offset, next)
    }

    /// The probabilities of numbers of rarer results in `count` trials that are not negligible,
    /// from the returned number on.
    fn likely(&self, count: u64) -> (u64, Vec<f64>) {
        let all = self.totals().1.min(count);
        let probability = |rare: u64| self.ln_probability(rare, count).exp();
        let mode = ((real(count) * self.share) as u64).min(all);
        let mut first = mode;
        while first > 0 && probability(first - 1) > NEGLIGIBLE {
            first -= 1;
        }
        let from_mode = (mode..=all).map(probability).take_while(|it| *it > NEGLIGIBLE);
        (first, (first..mode).map(probability).chain(from_mode).collect())
    }

    /// The numbers of rarer results before a split whose ratio is below this. The ratio falls
    /// down to the expected number, and then rises.
    fn below(&self, split: usize, ratio: f64) -> (u64, u64) {
        let (trials, all) = self.totals();
        let before = self.sums[split].0;
        let least = all.saturating_sub(trials - before);
        let most = all.min(before);
        let expected = ((real(before) * self.share) as u64).clamp(least, most);
        let is_below = |rare: u64| self.ratio(split, rare) < ratio;
        let low = first_where(least, expected + 1, is_below);
        let high = first_where(expected + 1, most + 1, |rare| rare > most || !is_below(rare));
        (low, high)
    }

    /// The logarithm of the binomial probability.
    fn ln_probability(&self, rare: u64, trials: u64) -> f64 {
        let others = real(trials - rare) * (-self.share).ln_1p();
        ln_binomial(trials, rare) + real(rare) * self.share.ln() + others
    }
}

/// The first number from `low` on that meets the condition, which all later ones meet; at most
/// `high`.
fn first_where(mut low: u64, mut high: u64, condition: impl Fn(u64) -> bool) -> u64 {
    while low < high {
        let middle = low + (high - low) / 2;
        if condition(middle) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

#[expect(clippy::cast_precision_loss, reason = "counts of episodes are far below 2^53")]
fn real(count: u64) -> f64 {
    count as f64
}
