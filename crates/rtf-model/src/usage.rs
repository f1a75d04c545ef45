//! What processes use, and whether that grows.

use serde::{Deserialize, Serialize};

use crate::trend;

/// What a process and everything below it uses at a moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Usage {
    /// How many processes there are.
    pub processes: u64,
    /// How many bytes of memory of their own they have: anonymous and shared
    /// memory that is present, or swapped out. Files that are mapped do not count.
    pub memory: u64,
    /// How many file descriptors they have open.
    pub descriptors: u64,
}

/// A kind of thing that can be used up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resource {
    /// [`Usage::memory`]
    Memory,
    /// [`Usage::descriptors`]
    Descriptors,
    /// [`Usage::processes`]
    Processes,
}

impl Resource {
    /// Every kind.
    pub const ALL: [Self; 3] = [Self::Memory, Self::Descriptors, Self::Processes];

    /// The word for it.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Memory => "memory",
            Self::Descriptors => "descriptors",
            Self::Processes => "processes",
        }
    }

    fn of(self, usage: &Usage) -> u64 {
        match self {
            Self::Memory => usage.memory,
            Self::Descriptors => usage.descriptors,
            Self::Processes => usage.processes,
        }
    }

    /// What it must have grown by altogether to be worth a word: allocators and
    /// the kernel's counters are not exact.
    fn least(self) -> f64 {
        match self {
            Self::Memory => 1024.0 * 1024.0,
            Self::Descriptors | Self::Processes => 2.0,
        }
    }
}

/// Something is used more and more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// What.
    pub resource: Resource,
    /// By how much from one test to the next: the median of the slopes.
    pub each: f64,
    /// How much was used when the growth began to be looked at.
    pub from: u64,
    /// How much was used at last.
    pub to: u64,
    /// How many tests lie between the two.
    pub tests: u64,
}

/// What was used at the ends of tests, one after the other. Of many, some are
/// kept, at equal distances.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UsageSeries {
    kept: Vec<Usage>,
    /// One of so many is kept, as a power of two.
    thinned: u32,
    seen: u64,
}

impl UsageSeries {
    /// How many are kept at the most.
    const MOST: usize = 512;
    /// How many there must be to speak of growth.
    const LEAST: usize = 10;

    pub(crate) fn add(&mut self, usage: Usage) {
        let distance = self.distance();
        if self.seen.is_multiple_of(distance) {
            if self.kept.len() == Self::MOST {
                let mut place = 0_u32;
                self.kept.retain(|_| {
                    place += 1;
                    place % 2 == 1
                });
                self.thinned += 1;
            }
            if self.seen.is_multiple_of(self.distance()) {
                self.kept.push(usage);
            }
        }
        self.seen += 1;
    }

    /// How many tests lie between two that are kept.
    fn distance(&self) -> u64 {
        1 << self.thinned
    }

    /// How often it was measured.
    #[must_use]
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// What was used at last.
    #[must_use]
    pub fn last(&self) -> Option<Usage> {
        self.kept.last().copied()
    }

    /// What grows, after the first fifth, in which caches fill.
    #[must_use]
    pub fn growth(&self) -> Vec<Growth> {
        if self.kept.len() < Self::LEAST {
            return Vec::new();
        }
        let warm = &self.kept[self.kept.len() / 5..];
        let grows = |resource| self.growth_of(resource, warm);
        Resource::ALL.into_iter().filter_map(grows).collect()
    }

    fn growth_of(&self, resource: Resource, warm: &[Usage]) -> Option<Growth> {
        let values: Vec<f64> = warm.iter().map(|usage| resource.of(usage) as f64).collect();
        let (first, last) = (warm.first()?, warm.last()?);
        let slope = trend::rising(&values)?;
        let steps = values.len() - 1;
        let enough = slope * steps as f64 >= resource.least();
        enough.then(|| Growth {
            resource,
            each: slope / self.distance() as f64,
            from: resource.of(first),
            to: resource.of(last),
            tests: steps as u64 * self.distance(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MIB: u64 = 1024 * 1024;

    fn series(memory: impl IntoIterator<Item = u64>) -> UsageSeries {
        let mut series = UsageSeries::default();
        for memory in memory {
            series.add(Usage { processes: 1, memory, descriptors: 9 });
        }
        series
    }

    #[test]
    fn what_a_test_leaks_is_found_with_its_size() {
        let noise = [0, 40_000, 12_000, 28_000, 4_000];
        let leaking = series((0..50).map(|test| 8 * MIB + test * MIB + noise[test as usize % 5]));
        let [growth] = leaking.growth()[..] else { panic!("{:?}", leaking.growth()) };
        assert_eq!((growth.resource, growth.tests), (Resource::Memory, 39));
        assert!((growth.each / MIB as f64 - 1.0).abs() < 0.01, "{growth:?}");
    }

    #[test]
    fn a_cache_that_fills_and_noise_are_no_growth() {
        let filling = series((0..100).map(|test: u64| 8 * MIB + test.min(15) * MIB));
        assert_eq!(filling.growth(), []);
        let later = series((0..100).map(|test: u64| 8 * MIB + test.min(50) * MIB));
        assert_eq!(later.growth(), [], "it has not grown for a while");
        let collected = series((0..100).map(|test| 8 * MIB + test % 12 * MIB));
        assert_eq!(collected.growth(), [], "a collector takes it back");
        assert_eq!(series((0..9).map(|test| test * MIB)).growth(), [], "too few to know");
    }

    #[test]
    fn of_a_long_run_a_part_is_kept_at_equal_distances() {
        let long = series((0..100_000).map(|test| 8 * MIB + test * 1000));
        assert!(long.kept.len() <= UsageSeries::MOST && long.kept.len() >= UsageSeries::MOST / 2);
        assert_eq!(long.seen(), 100_000);
        let [growth] = long.growth()[..] else { panic!("{:?}", long.growth()) };
        assert!((growth.each - 1000.0).abs() < 1e-6, "{growth:?}");
        assert_eq!((growth.to - growth.from) / 1000, growth.tests);
    }

    #[test]
    fn a_descriptor_every_few_tests_is_found() {
        let mut series = UsageSeries::default();
        for test in 0..200 {
            series.add(Usage { processes: 1, memory: MIB, descriptors: 9 + test / 7 });
        }
        let [growth] = series.growth()[..] else { panic!("{:?}", series.growth()) };
        assert_eq!(growth.resource, Resource::Descriptors);
        assert!((growth.each - 1.0 / 7.0).abs() < 0.01, "{growth:?}");
    }
}
