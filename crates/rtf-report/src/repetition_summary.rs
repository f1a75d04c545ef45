//! Summarizes the repetitions of a test: how many passed, and how long they took.

use std::time::Duration;

use rtf_model::{AttemptRecord, TestRecord};

use crate::words;

/// How many steps the histogram has.
const STEPS: usize = 20;
/// The heights of its bars; nothing for none.
const BARS: [char; 9] = [' ', '▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];

/// The repetitions of a test that ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Repeated {
    pub passed: usize,
    /// How long each took, the shortest first. Never empty.
    pub times: Vec<Duration>,
}

impl Repeated {
    /// Of a test that ran more than once; of each repetition, the last attempt counts.
    #[must_use]
    pub fn of(test: &TestRecord) -> Option<Self> {
        let mut times: Vec<_> =
            test.deciding_attempts().filter_map(AttemptRecord::duration).collect();
        times.sort();
        let green = |attempt: &&AttemptRecord| attempt.verdict().is_some_and(|v| v.is_green());
        let passed = test.deciding_attempts().filter(green).count();
        (times.len() > 1).then_some(Self { passed, times })
    }

    /// `98 of 100 passed (98.0 %)`
    #[must_use]
    pub fn rate(&self) -> String {
        let count = self.times.len();
        let rate = 100.0 * self.passed as f64 / count as f64;
        // Never 100 % when one has failed.
        let rate = (rate * 10.0).floor() / 10.0;
        format!("{} of {count} passed ({rate:.1} %)", self.passed)
    }

    /// The shortest, the mean, the 95th percentile (the time that 95 of 100 do
    /// not exceed: nearest rank) and the longest.
    #[must_use]
    pub fn spread(&self) -> String {
        let count = self.times.len();
        let mean = self.times.iter().sum::<Duration>() / u32::try_from(count).unwrap_or(u32::MAX);
        let rank = (count * 95).div_ceil(100).max(1);
        let [min, p95, max] = [0, rank - 1, count - 1].map(|place| words::time(self.times[place]));
        format!("min {min}, mean {}, 95 % {p95}, max {max}", words::time(mean))
    }

    /// A bar for each of twenty equal steps from the shortest to the longest.
    #[must_use]
    pub fn histogram(&self) -> String {
        let (Some(min), Some(max)) = (self.times.first(), self.times.last()) else {
            return String::new();
        };
        let width = (*max - *min).as_secs_f64() / STEPS as f64;
        let mut counts = [0_usize; STEPS];
        for time in &self.times {
            let step = ((*time - *min).as_secs_f64() / width) as usize;
            counts[step.min(STEPS - 1)] += 1;
        }
        let most = counts.iter().max().copied().unwrap_or(1).max(1);
        let bar = |count: &usize| BARS[(count * (BARS.len() - 1)).div_ceil(most)];
        counts.iter().map(bar).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn repeated(millis: impl Iterator<Item = u64>, passed: usize) -> Repeated {
        Repeated { passed, times: millis.map(Duration::from_millis).collect() }
    }

    #[test]
    fn the_numbers_of_a_hundred() {
        let hundred = repeated(1..=100, 98);
        assert_eq!(hundred.rate(), "98 of 100 passed (98.0 %)");
        assert_eq!(hundred.spread(), "min 0.001 s, mean 0.051 s, 95 % 0.095 s, max 0.100 s");
        assert_eq!(hundred.histogram(), "█".repeat(STEPS));
    }

    #[test]
    fn nearly_all_is_not_all() {
        assert_eq!(repeated(1..=3000, 2999).rate(), "2999 of 3000 passed (99.9 %)");
    }

    #[test]
    fn one_that_is_far_out_is_seen() {
        let times = repeated(std::iter::repeat_n(10, 99).chain([1000]), 100);
        assert_eq!(times.histogram(), format!("█{}▁", " ".repeat(STEPS - 2)));
        let same = repeated(std::iter::repeat_n(10, 5), 5);
        assert_eq!(same.histogram().trim_end(), "█");
    }
}
