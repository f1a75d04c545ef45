//! Removes weak points until all that are left are significant, large enough and supported.

use super::t_test::{Segment, p_value};
use super::{Basis, ChangePoint, Options, Size, position_of_max};

/// The changes that remain of `splits`, which are indexes into `values`, in order. Each has at
/// least `min_support` values on each side that are nearer to the mean of their side.
pub(super) fn merge(
    values: &[f64],
    splits: &[usize],
    options: &Options,
    min_support: usize,
) -> Vec<ChangePoint> {
    let max_p = options.max_p(values.len());
    let merge = Merge { values, options, max_p, min_support };
    let mut points: Vec<ChangePoint> =
        bounds(values.len(), splits).windows(3).map(|b| merge.point(b[0], b[1], b[2])).collect();
    while let Some(weakest) = merge.weakest(&points) {
        points.remove(weakest);
        for changed in weakest.saturating_sub(1)..points.len().min(weakest + 1) {
            let start = changed.checked_sub(1).map_or(0, |i| points[i].index);
            let next = points.get(changed + 1);
            let end = next.map_or(values.len(), |next| next.index);
            points[changed] = merge.point(start, points[changed].index, end);
        }
    }
    points
}

/// A series of which the short segments were set aside.
#[derive(Debug, Default, PartialEq, Eq)]
pub(super) struct Parts {
    /// The indexes of the values in long segments.
    pub kept: Vec<usize>,
    /// The indexes of the other values.
    pub set_aside: Vec<usize>,
    /// The first value of each long segment but the first one, as an index into `kept`.
    pub splits: Vec<usize>,
}

/// Sets aside the segments between `splits` that have fewer than `min_segment` values.
pub(super) fn without_short_segments(count: usize, splits: &[usize], min_segment: usize) -> Parts {
    let mut parts = Parts::default();
    for segment in bounds(count, splits).windows(2) {
        let segment = segment[0]..segment[1];
        if segment.len() < min_segment && !splits.is_empty() {
            parts.set_aside.extend(segment);
            continue;
        }
        if !parts.kept.is_empty() {
            parts.splits.push(parts.kept.len());
        }
        parts.kept.extend(segment);
    }
    parts
}

fn bounds(count: usize, splits: &[usize]) -> Vec<usize> {
    let mut bounds = vec![0];
    bounds.extend_from_slice(splits);
    bounds.push(count);
    bounds
}

struct Merge<'a> {
    values: &'a [f64],
    options: &'a Options,
    max_p: f64,
    min_support: usize,
}

impl Merge<'_> {
    /// The point to remove next: that with the largest p value, then that with the smallest size.
    fn weakest(&self, points: &[ChangePoint]) -> Option<usize> {
        let weakest = position_of_max(points, |p| p.p_value)?;
        if points[weakest].p_value >= self.max_p {
            return Some(weakest);
        }
        let magnitude = |p: &ChangePoint| p.size.map_or(f64::INFINITY, |size| size.fraction.abs());
        let smallest = position_of_max(points, |p| -magnitude(p))?;
        (magnitude(&points[smallest]) < self.options.min_size).then_some(smallest)
    }

    /// The change at `index` between the values from `start` and those until `end`. Without
    /// support, its p value is 1.
    fn point(&self, start: usize, index: usize, end: usize) -> ChangePoint {
        let (left, right) = (&self.values[start..index], &self.values[index..end]);
        let (before, after) = (Segment::of(left), Segment::of(right));
        let supported = support(left, before.mean, after.mean) >= self.min_support
            && support(right, after.mean, before.mean) >= self.min_support;
        let p_value = if supported { p_value(&before, &after) } else { 1.0 };
        ChangePoint {
            index,
            before,
            after,
            p_value,
            size: size(&before, &after, self.options.limits_span),
        }
    }
}

/// How many values are nearer to the mean of their side than to the other.
fn support(values: &[f64], mean: f64, other: f64) -> usize {
    let nearer = |value: &&f64| (*value - mean).abs() < (*value - other).abs();
    values.iter().filter(nearer).count()
}

fn size(before: &Segment, after: &Segment, limits_span: Option<f64>) -> Option<Size> {
    let (divisor, basis) = match limits_span.filter(|span| span.is_finite() && *span > 0.0) {
        Some(span) => (span, Basis::LimitsSpan),
        None if before.mean.abs() > before.deviation => (before.mean.abs(), Basis::MeanBefore),
        None => return None,
    };
    Some(Size { fraction: (after.mean - before.mean) / divisor, basis })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn short_segments_are_set_aside() {
        // Values 0 to 9 in segments of 3, 1, 4 and 2.
        let parts = without_short_segments(10, &[3, 4, 8], 3);
        assert_eq!(parts.kept, [0, 1, 2, 4, 5, 6, 7]);
        assert_eq!(parts.set_aside, [3, 8, 9]);
        assert_eq!(parts.splits, [3]);
    }

    #[test]
    fn series_without_a_change_is_kept_although_it_is_short() {
        assert_eq!(without_short_segments(2, &[], 3).kept, [0, 1]);
    }

    #[test]
    fn values_between_the_means_support_no_side() {
        assert_eq!(support(&[10.0, 20.0, 15.0, 14.0], 10.0, 20.0), 2);
        assert_eq!(support(&[], 10.0, 20.0), 0);
    }
}
