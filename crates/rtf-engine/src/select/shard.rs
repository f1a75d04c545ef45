//! A part of the tests, of several that make up the whole.

use std::collections::HashMap;
use std::str::FromStr;
use std::time::Duration;

use super::{hash, retain};
use crate::plan::SuitePlan;

/// How long a test is taken to last of which no time is known.
const UNKNOWN: Duration = Duration::from_secs(1);

/// Part `index` of `of`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1 to `of`.
    pub index: u32,
    /// How many parts there are; at least 1.
    pub of: u32,
    /// What decides to which part a test belongs.
    pub by: ShardBy,
}

/// What decides to which part a test belongs.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum ShardBy {
    /// Its name alone: it stays in its part when others come and go.
    #[default]
    Hash,
    /// Its place: parts of the same number of tests, each of neighbours.
    Count,
    /// How long the tests, by suite and name, took before: parts that last
    /// about equally long. All parts must be made with the same times.
    Duration(HashMap<(String, String), Duration>),
}

impl FromStr for Shard {
    type Err = String;

    /// `2/5`.
    fn from_str(text: &str) -> Result<Self, String> {
        let expected = || format!("expected a part such as `2/5`, got `{text}`");
        let (index, of) = text.split_once('/').ok_or_else(expected)?;
        let (index, of): (u32, u32) =
            index.parse().ok().zip(of.parse().ok()).ok_or_else(expected)?;
        if index < 1 || index > of {
            return Err(format!("there is no part {index} of {of}"));
        }
        Ok(Self { index, of, by: ShardBy::Hash })
    }
}

impl Shard {
    /// Keeps the tests of this part.
    pub(super) fn keep(&self, suites: &mut [SuitePlan]) {
        let mut parts = self.parts(suites).into_iter();
        retain(suites, |_, _| parts.next() == Some(self.index - 1));
    }

    /// The part of each test, from 0, in the order of the plan.
    fn parts(&self, suites: &[SuitePlan]) -> Vec<u32> {
        let tests = suites.iter().flat_map(|suite| suite.tests.iter().map(move |t| (suite, t)));
        match &self.by {
            ShardBy::Hash => tests
                .map(|(suite, test)| {
                    let part = hash(0, &suite.name, &test.name) % u64::from(self.of);
                    u32::try_from(part).unwrap_or_default()
                })
                .collect(),
            ShardBy::Count => {
                let count = tests.count() as u64;
                let part = |place: u64| place * u64::from(self.of) / count.max(1);
                (0..count).map(|place| u32::try_from(part(place)).unwrap_or_default()).collect()
            }
            ShardBy::Duration(known) => {
                let time = |suite: &str, test: &str| {
                    known.get(&(suite.to_owned(), test.to_owned())).copied().unwrap_or(UNKNOWN)
                };
                self.balanced(&tests.map(|(s, t)| time(&s.name, &t.name)).collect::<Vec<_>>())
            }
        }
    }

    /// The longest first, each to the part that has the least (Graham's LPT
    /// rule: at most 4/3 of the best that can be done).
    fn balanced(&self, times: &[Duration]) -> Vec<u32> {
        let mut order: Vec<usize> = (0..times.len()).collect();
        order.sort_by_key(|place| (std::cmp::Reverse(times[*place]), *place));
        let mut loads = vec![Duration::ZERO; self.of as usize];
        let mut parts = vec![0; times.len()];
        for place in order {
            let least = (0..loads.len()).min_by_key(|part| loads[*part]).unwrap_or_default();
            loads[least] += times[place];
            parts[place] = u32::try_from(least).unwrap_or_default();
        }
        parts
    }
}
