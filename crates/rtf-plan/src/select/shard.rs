//! Splits the tests into several parts.

use std::hash::Hasher;
use std::str::FromStr;
use std::time::Duration;

use siphasher::sip::SipHasher13;

use super::order::{Durations, PastResults};
use super::{hash, retain};
use crate::plan::SuitePlan;

/// Part `index` of `count`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shard {
    /// The number of this part, from 1 to `count`.
    pub index: u32,
    /// The number of parts, at least 1.
    pub count: u32,
    pub by: ShardBy,
}

/// The methods that assign tests to parts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ShardBy {
    /// By name: a test stays in its part when others are added or removed.
    #[default]
    Hash,
    /// By position: parts of equally many consecutive tests.
    Count,
    /// By the past durations of tests: parts that take about equally long. All parts must be
    /// computed from the same durations.
    Duration(PastResults),
}

impl FromStr for Shard {
    type Err = String;

    /// Parses `2/5`.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("expected a part such as `2/5`, got `{text}`");
        let (index, count) = text.split_once('/').ok_or_else(expected)?;
        let (index, count): (u32, u32) =
            index.parse().ok().zip(count.parse().ok()).ok_or_else(expected)?;
        if index < 1 || index > count {
            return Err(format!("there is no part {index} of {count}"));
        }
        Ok(Self { index, count, by: ShardBy::Hash })
    }
}

impl Shard {
    /// Removes the tests of all other parts. Returns a hash of the assignment if it depends on
    /// more than the tests.
    pub(super) fn apply(&self, suites: &mut [SuitePlan]) -> Option<u64> {
        let parts = self.parts(suites);
        let mut hasher = SipHasher13::new();
        parts.iter().for_each(|part| hasher.write_u32(*part));
        let mut parts = parts.into_iter();
        retain(suites, |_, _| parts.next() == Some(self.index - 1));
        matches!(self.by, ShardBy::Duration(_)).then(|| hasher.finish())
    }

    /// Returns the part of each test, from 0, in the order of the plan.
    #[must_use]
    pub fn parts(&self, suites: &[SuitePlan]) -> Vec<u32> {
        let tests = suites.iter().flat_map(|suite| suite.tests.iter().map(move |t| (suite, t)));
        match &self.by {
            ShardBy::Hash => tests
                .map(|(suite, test)| {
                    let part = hash(0, &suite.name, &test.name) % u64::from(self.count);
                    u32::try_from(part).unwrap_or_default()
                })
                .collect(),
            ShardBy::Count => {
                let total = tests.count() as u64;
                let part = |index: u64| index * u64::from(self.count) / total.max(1);
                (0..total).map(|index| u32::try_from(part(index)).unwrap_or_default()).collect()
            }
            ShardBy::Duration(past) => {
                let durations = Durations::new(suites, past);
                self.balance(&tests.map(|(s, t)| durations.of(&s.name, t)).collect::<Vec<_>>())
            }
        }
    }

    /// Assigns the longest test first, each to the part with the least load
    /// (Graham's LPT rule: at most 4/3 of the optimum).
    fn balance(&self, times: &[Duration]) -> Vec<u32> {
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by_key(|index| (std::cmp::Reverse(times[*index]), *index));
        let mut loads = vec![Duration::ZERO; self.count as usize];
        let mut parts = vec![0; times.len()];
        for index in order {
            let least = (0..loads.len()).min_by_key(|part| loads[*part]).unwrap_or_default();
            loads[least] += times[index];
            parts[index] = u32::try_from(least).unwrap_or_default();
        }
        parts
    }
}
