//! The resources that processes use, and whether their use grows.

use serde::{Deserialize, Serialize};

use crate::trend;

/// The resources that a process and its descendants use at one moment.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Usage {
    /// Number of processes.
    pub processes: u64,
    /// Private memory in bytes: anonymous and shared
    /// memory that is resident or swapped out. Mapped files do not count.
    pub memory: u64,
    /// Number of open file descriptors.
    pub descriptors: u64,
}

/// A kind of resource that can be exhausted.
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

    fn used(self, usage: &Usage) -> u64 {
        match self {
            Self::Memory => usage.memory,
            Self::Descriptors => usage.descriptors,
            Self::Processes => usage.processes,
        }
    }

    /// The smallest total growth that is reported: allocators and
    /// the kernel's counters are not exact.
    fn reported_growth(self) -> f64 {
        match self {
            Self::Memory => 1024.0 * 1024.0,
            Self::Descriptors | Self::Processes => 2.0,
        }
    }
}

/// A resource whose use keeps growing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Growth {
    /// The resource.
    pub resource: Resource,
    /// Growth per test: the median of the slopes.
    pub each: f64,
    /// Use at the first sample of the trend.
    pub from: u64,
    /// Use at the last sample.
    pub to: u64,
    /// Number of tests between the two.
    pub tests: u64,
}

/// Resource use at the end of each test. Of a long series, evenly
/// spaced samples are kept.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct UsageSeries {
    kept: Vec<Usage>,
    /// One of 2^`thinned` samples is kept.
    thinned: u32,
    seen: u64,
}

impl UsageSeries {
    /// At most so many samples are kept.
    const MAX_SAMPLES: usize = 512;
    /// Growth is reported only of at least so many samples.
    const MIN_SAMPLES: usize = 10;

    pub(crate) fn add(&mut self, usage: Usage) {
        let distance = self.distance();
        if self.seen.is_multiple_of(distance) {
            if self.kept.len() == Self::MAX_SAMPLES {
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

    /// Number of tests between two samples.
    fn distance(&self) -> u64 {
        1 << self.thinned
    }

    /// Number of measurements.
    #[must_use]
    pub fn seen(&self) -> u64 {
        self.seen
    }

    /// The last sample.
    #[must_use]
    pub fn last(&self) -> Option<Usage> {
        self.kept.last().copied()
    }

    /// The resources that grow. The first fifth is ignored: caches fill there.
    #[must_use]
    pub fn growth(&self) -> Vec<Growth> {
        if self.kept.len() < Self::MIN_SAMPLES {
            return Vec::new();
        }
        let warm = &self.kept[self.kept.len() / 5..];
        let grows = |resource| self.growth_of(resource, warm);
        Resource::ALL.into_iter().filter_map(grows).collect()
    }

    fn growth_of(&self, resource: Resource, warm: &[Usage]) -> Option<Growth> {
        let values: Vec<f64> = warm.iter().map(|usage| resource.used(usage) as f64).collect();
        let (first, last) = (warm.first()?, warm.last()?);
        let slope = trend::rising(&values)?;
        let steps = values.len() - 1;
        let enough = slope * steps as f64 >= resource.reported_growth();
        enough.then(|| Growth {
            resource,
            each: slope / self.distance() as f64,
            from: resource.used(first),
            to: resource.used(last),
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
    fn a_leak_is_found_with_its_size() {
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
    fn evenly_spaced_samples_of_a_long_run_are_kept() {
        let long = series((0..100_000).map(|test| 8 * MIB + test * 1000));
        assert!(
            long.kept.len() <= UsageSeries::MAX_SAMPLES
                && long.kept.len() >= UsageSeries::MAX_SAMPLES / 2
        );
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
