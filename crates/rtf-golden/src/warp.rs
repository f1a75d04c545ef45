//! Alignment by dynamic time warping: H. Sakoe, S. Chiba, *Dynamic programming algorithm optimization
//! for spoken word recognition*, IEEE Transactions on Acoustics, Speech, and Signal Processing 26,
//! 1978, with steps of (1, 0), (0, 1) and (1, 1), the squared difference as cost, and a band.

use crate::{Aligned, Comparison, Deviation, Trajectory, by_time};

/// The fewest and the most values that are compared of each trajectory.
const MIN_VALUES: usize = 1000;
const MAX_VALUES: usize = 2000;

/// A step of the path, from which it came.
const BOTH: u8 = 0;
const FIRST: u8 = 1;
const SECOND: u8 = 2;

/// The best alignment of two sequences.
#[derive(Clone, Debug, PartialEq)]
pub struct Warp {
    /// The root of the sum of squared differences.
    pub distance: f64,
    /// Pairs of indices, from the first ones to the last ones.
    pub path: Vec<(usize, usize)>,
}

/// Aligns two sequences whose indices differ by at most `radius`; `None` if one is empty, or if their
/// lengths differ by more.
#[must_use]
pub fn warp(first: &[f64], second: &[f64], radius: usize) -> Option<Warp> {
    let (rows, columns) = (first.len(), second.len());
    if rows == 0 || columns == 0 || rows.abs_diff(columns) > radius {
        return None;
    }
    let radius = radius.min(rows.max(columns));
    let width = 2 * radius + 1;
    // Column `j` of row `i` is at `j + radius - i`.
    let mut steps = vec![BOTH; rows * width];
    let mut above = vec![f64::INFINITY; width + 1];
    for (row, value) in first.iter().enumerate() {
        let mut costs = vec![f64::INFINITY; width + 1];
        let from = row.saturating_sub(radius);
        let to = (row + radius + 1).min(columns);
        for (column, other) in second.iter().enumerate().take(to).skip(from) {
            let at = column + radius - row;
            let difference = value - other;
            // One row up, the same column is one further to the right.
            let both = above[at];
            let up = above[at + 1];
            let left = if at > 0 { costs[at - 1] } else { f64::INFINITY };
            let (best, step) = if row == 0 && column == 0 {
                (0.0, BOTH)
            } else if both <= up && both <= left {
                (both, BOTH)
            } else if up <= left {
                (up, FIRST)
            } else {
                (left, SECOND)
            };
            costs[at] = best + difference * difference;
            steps[row * width + at] = step;
        }
        above = costs;
    }
    let distance = above[columns - 1 + radius - (rows - 1)].sqrt();
    let mut path = vec![(rows - 1, columns - 1)];
    while let Some(&(row, column)) = path.last()
        && (row, column) != (0, 0)
    {
        path.push(match steps[row * width + column + radius - row] {
            BOTH => (row - 1, column - 1),
            FIRST => (row - 1, column),
            _ => (row, column - 1),
        });
    }
    path.reverse();
    Some(Warp { distance, path })
}

/// Compares along the best alignment, in which times differ by at most `band` seconds; `None` if the
/// durations differ by more.
#[must_use]
pub fn by_warp(got: &Trajectory, expected: &Trajectory, band: f64) -> Option<Comparison> {
    let longest = got.duration().max(expected.duration());
    let points = got.points().len().max(expected.points().len());
    let count = points.clamp(MIN_VALUES, MAX_VALUES);
    // The smallest durations cannot be divided.
    let step = longest / (count - 1) as f64;
    if step <= 0.0 {
        return Some(by_time(got, expected));
    }
    let values = |trajectory: &Trajectory| {
        let count = (trajectory.duration() / step).round() as usize + 1;
        trajectory.resampled(step, count)
    };
    let (first, second) = (values(got), values(expected));
    let radius = (band / step).round() as usize;
    let path = warp(&first, &second, radius)?.path;
    let mut worst = None;
    let mut sum = 0.0;
    let mut aligned: Vec<Aligned> = Vec::with_capacity(first.len());
    for (row, column) in &path {
        let time = step * *row as f64;
        let value = second[*column];
        match aligned.last_mut().filter(|last| last.time >= time) {
            Some(last) => (last.low, last.high) = (last.low.min(value), last.high.max(value)),
            None => aligned.push(Aligned { time, low: value, high: value }),
        }
        let deviation = Deviation { time, got: first[*row], expected: second[*column] };
        sum += deviation.size() * deviation.size();
        worst = Comparison::worse(worst, deviation);
    }
    Some(Comparison { rms: (sum / path.len() as f64).sqrt(), worst: worst?, aligned })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_smallest_duration_is_compared_by_time() {
        let points = [(0.0, 1.0), (f64::from_bits(1), 2.0)];
        let trajectory = Trajectory::new(&points).unwrap();
        assert_eq!(by_warp(&trajectory, &trajectory, 0.1).unwrap().worst.size(), 0.0);
    }

    #[test]
    fn a_delay_within_the_band_is_no_difference() {
        let first = [0.0, 0.0, 1.0, 2.0, 2.0];
        let second = [0.0, 1.0, 2.0, 2.0, 2.0];
        let found = warp(&first, &second, 1).unwrap();
        assert_eq!(found.distance, 0.0);
        assert_eq!(found.path, [(0, 0), (1, 0), (2, 1), (3, 2), (3, 3), (4, 4)]);
        assert_eq!(warp(&first, &second, 0).unwrap().distance, 2.0_f64.sqrt());
        assert_eq!(warp(&first, &second[..3], 1), None);
        assert_eq!(warp(&[], &second, 1), None);
    }

    #[test]
    fn a_delayed_trajectory_is_equal_within_the_band_only() {
        let shape = |delay: f64| {
            let points: Vec<_> = (0..=300)
                .map(|index| f64::from(index) * 0.01)
                .map(|time| (time, (time - delay).clamp(0.0, 1.0)))
                .collect();
            Trajectory::new(&points).unwrap()
        };
        let (got, expected) = (shape(0.5), shape(0.3));
        let wide = by_warp(&got, &expected, 0.25).unwrap();
        // At most half a step of the grid.
        assert!(wide.worst.size() < 0.002, "{wide:?}");
        // The reference is where the trajectory is, 0.2 s later than it was.
        let near = wide.aligned.iter().find(|it| it.time >= 1.0).unwrap();
        assert!((near.low - 0.5).abs() < 0.01 && (near.high - 0.5).abs() < 0.01, "{near:?}");
        let narrow = by_warp(&got, &expected, 0.1).unwrap();
        assert!((narrow.worst.size() - 0.1).abs() < 0.011, "{narrow:?}");
        assert!((by_time(&got, &expected).worst.size() - 0.2).abs() < 1e-9);
        let longer = Trajectory::new(&[(0.0, 0.0), (4.0, 1.0)]).unwrap();
        assert_eq!(by_warp(&longer, &expected, 0.5), None);
    }

    /// The definition, without a band of stored cells.
    fn brute_force(first: &[f64], second: &[f64], radius: usize) -> f64 {
        let mut costs = vec![vec![f64::INFINITY; second.len() + 1]; first.len() + 1];
        costs[0][0] = 0.0;
        for row in 1..=first.len() {
            for column in 1..=second.len() {
                if row.abs_diff(column) <= radius {
                    let difference = first[row - 1] - second[column - 1];
                    let best = costs[row - 1][column - 1]
                        .min(costs[row - 1][column])
                        .min(costs[row][column - 1]);
                    costs[row][column] = best + difference * difference;
                }
            }
        }
        costs[first.len()][second.len()].sqrt()
    }

    proptest! {
        #[test]
        fn the_path_is_the_best_one(
            first in prop::collection::vec(-10.0..10.0, 1..30),
            second in prop::collection::vec(-10.0..10.0, 1..30),
            radius in 0_usize..40,
        ) {
            let Some(found) = warp(&first, &second, radius) else {
                prop_assert!(first.len().abs_diff(second.len()) > radius);
                return Ok(());
            };
            prop_assert!((found.distance - brute_force(&first, &second, radius)).abs() < 1e-9);
            let along: f64 =
                found.path.iter().map(|(row, column)| (first[*row] - second[*column]).powi(2)).sum();
            prop_assert!((found.distance - along.sqrt()).abs() < 1e-9);
            prop_assert_eq!(found.path[0], (0, 0));
            for pair in found.path.windows(2) {
                let step = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
                prop_assert!(matches!(step, (0 | 1, 1) | (1, 0)));
                prop_assert!(pair[1].0.abs_diff(pair[1].1) <= radius);
            }
        }
    }
}
