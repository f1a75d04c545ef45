//! Where the mean of a series changed: since which run a measurement or duration is different.
//!
//! E-divisive windows with a t-test and merging of weak points, as in Hunter and Apache Otava:
//!
//! 1. *Split.* A window moves over the series by half its length. In it, unless no split could
//!    pass the t-test ([`screen`]), the split with the highest energy divergence is found ([`divergence`]); if a t-test with a relaxed limit
//!    (10 × that of [`Options::level`]) accepts it, both parts are split further. The result is weak points.
//! 2. *Merge.* The weak points are tested again, between their neighbours. The weakest is removed
//!    and its neighbours are tested again, until all are below that of [`Options::level`].
//! 3. *Outliers.* Segments of fewer than [`Options::min_segment`] values are outliers, or a change
//!    too recent to be sure of. They are set aside, and the rest is merged again. A change is
//!    called only if at least `min_segment` values on each side are nearer to the mean of their
//!    side than to the other.
//!
//! Sources: M. Fleming et al., "Hunter: using change point detection to hunt for performance
//! regressions", ICPE 2023, <https://arxiv.org/abs/2301.03034>; Apache Otava, `docs/MATH.md`.
//! Differences from Otava 0.8 and their reasons: `docs/explanation/change-points.md`.

mod divergence;
mod merge;
mod screen;
mod t_test;
#[cfg(test)]
mod tests;
mod windows;

use serde::Serialize;

pub use t_test::Segment;

/// How change points are searched for. The default is for a series of one value per run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// The number of values in which a change must stand out, at least 2.
    pub window: usize,
    /// How unlikely a difference must be by chance.
    pub level: Level,
    /// The fewest values before and after a change. 1 calls a change from a single value, as Otava
    /// does.
    pub min_segment: usize,
    /// The smallest size of a change, see [`Size::fraction`]. Changes without a size are kept.
    pub min_size: f64,
    /// The distance between the limits of the measurement, in its unit. Without it, or if it is
    /// not positive, sizes are relative to the mean before the change.
    pub limits_span: Option<f64>,
}

/// The significance level, a probability.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Level {
    /// The p value below which a difference is a change, as in Otava. A series with 1000 values
    /// and no change has more than 100 possible splits, so `PerTest(0.001)` calls a false change in
    /// every second one.
    PerTest(f64),
    /// About the probability that a series without changes has one called: the p value is this
    /// divided by the number of values (C. E. Bonferroni's correction).
    PerSeries(f64),
}

impl Options {
    /// The p value below which a difference is a change, in a series of `count` values.
    #[expect(clippy::cast_precision_loss, reason = "counts of values are far below 2^53")]
    fn max_p(&self, count: usize) -> f64 {
        match self.level {
            Level::PerTest(p) => p,
            Level::PerSeries(p) => p / count.max(1) as f64,
        }
    }
}

impl Default for Options {
    fn default() -> Self {
        Self {
            window: 50,
            level: Level::PerSeries(0.001),
            min_segment: 3,
            min_size: 0.0,
            limits_span: None,
        }
    }
}

#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct ChangePoints {
    /// In the order of the series.
    pub points: Vec<ChangePoint>,
    /// Values that differ from those before and after them, but are too few for a change:
    /// outliers, or the start of a recent change. Indexes into the slice that was searched.
    pub set_aside: Vec<usize>,
    /// How many values were searched.
    pub used: usize,
    /// How many values were left out because they are NaN or infinite.
    pub left_out: usize,
}

/// A change of the mean.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChangePoint {
    /// The first value after the change, as an index into the slice that was searched.
    pub index: usize,
    /// The values since the previous change, without those set aside.
    pub before: Segment,
    /// The values until the next change, without those set aside.
    pub after: Segment,
    /// The p value of the t-test of both segments, below that of [`Options::level`].
    pub p_value: f64,
    /// `None` if there are no limits and zero is within the noise before the change: a relative
    /// size would be arbitrarily large.
    pub size: Option<Size>,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Size {
    /// The difference of the means as a fraction of the basis. Positive if the mean increased.
    pub fraction: f64,
    /// What the difference is divided by.
    pub basis: Basis,
}

/// What the size of a change is a fraction of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Basis {
    /// The distance between the measurement's limits.
    LimitsSpan,
    /// The magnitude of the mean before the change.
    MeanBefore,
}

/// The changes of the mean of `values`, which are in the order of their runs.
///
/// Values that are NaN or infinite are left out and counted. The result depends only on the
/// arguments. Time: O(n · window) for a few changes, O(n · window² + n²) if every value is one.
#[must_use]
pub fn find_change_points(values: &[f64], options: &Options) -> ChangePoints {
    let finite: Vec<usize> = (0..values.len()).filter(|i| values[*i].is_finite()).collect();
    let of = |indexes: &[usize]| -> Vec<f64> { indexes.iter().map(|i| values[*i]).collect() };
    let numbers = of(&finite);
    let weak = windows::weak_points(&numbers, options);
    let mut points = merge::merge(&numbers, &weak, options, 1);
    let (mut kept, mut set_aside) = (finite.clone(), Vec::new());
    if options.min_segment > 1 {
        let starts: Vec<usize> = points.iter().map(|point| point.index).collect();
        let parts = merge::without_short_segments(numbers.len(), &starts, options.min_segment);
        kept = parts.kept.iter().map(|i| finite[*i]).collect();
        set_aside = parts.set_aside.iter().map(|i| finite[*i]).collect();
        points = merge::merge(&of(&kept), &parts.splits, options, options.min_segment);
    }
    for point in &mut points {
        point.index = kept[point.index];
    }
    ChangePoints { points, set_aside, used: finite.len(), left_out: values.len() - finite.len() }
}

/// The first item with the largest key.
fn position_of_max<T>(items: &[T], key: impl Fn(&T) -> f64) -> Option<usize> {
    let mut best: Option<(usize, f64)> = None;
    for (position, item) in items.iter().enumerate() {
        let key = key(item);
        if best.is_none_or(|(_, highest)| key > highest) {
            best = Some((position, key));
        }
    }
    best.map(|(position, _)| position)
}
