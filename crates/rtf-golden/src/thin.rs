//! Thinning: fewer points, with a bound of the error at each sample.

use crate::Trajectory;

const MAX_DECIMALS: usize = 12;
/// A nanosecond.
const MAX_TIME_DECIMALS: usize = 9;

/// Rounded points of a trajectory.
#[derive(Clone, Debug, PartialEq)]
pub struct Thinned {
    pub points: Vec<(f64, f64)>,
    pub time_decimals: usize,
    /// The decimals of values.
    pub decimals: usize,
}

/// Leaves out points and digits so that the rest differs by at most `error` at each point.
///
/// From a point, the next one that is kept is the last to which a straight line passes all points
/// between within the error: the cone of possible slopes is not empty until there (swinging door,
/// E. H. Bristol, *Swinging door trending*, ISA 1990, with points of the trajectory as ends).
#[must_use]
pub fn thin(trajectory: &Trajectory, error: f64) -> Thinned {
    // Nine tenths are for the lines, the rest for rounding.
    let kept = kept(trajectory.points(), error * 0.9);
    let digits = (-(error * 0.1).log10()).ceil().clamp(0.0, MAX_DECIMALS as f64);
    let decimals = digits as usize;
    for time_decimals in 3..=MAX_TIME_DECIMALS {
        let points: Vec<_> = kept
            .iter()
            .map(|(time, value)| (round(*time, time_decimals), round(*value, decimals)))
            .collect();
        if let Ok(rounded) = Trajectory::new(&points)
            && is_within(trajectory, &rounded, error)
        {
            return Thinned { points, time_decimals, decimals };
        }
    }
    // Rounding moves more than the error permits.
    Thinned {
        points: trajectory.points().to_vec(),
        time_decimals: MAX_TIME_DECIMALS,
        decimals: MAX_DECIMALS,
    }
}

fn round(value: f64, decimals: usize) -> f64 {
    format!("{value:.decimals$}").parse().unwrap_or(value)
}

fn is_within(trajectory: &Trajectory, other: &Trajectory, error: f64) -> bool {
    trajectory.points().iter().all(|(time, value)| (other.at(*time) - value).abs() <= error)
}

fn kept(points: &[(f64, f64)], error: f64) -> Vec<(f64, f64)> {
    let Some(first) = points.first() else { return Vec::new() };
    let mut kept = vec![*first];
    let mut anchor = 0;
    while anchor + 1 < points.len() {
        let next = end_of_line(&points[anchor..], error);
        anchor += next;
        kept.push(points[anchor]);
    }
    kept
}

/// The index of the last point that a line from the first one can end at.
fn end_of_line(points: &[(f64, f64)], error: f64) -> usize {
    let (from, value) = points[0];
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut end = 1;
    for (index, (time, other)) in points.iter().enumerate().skip(1) {
        let duration = time - from;
        let slope = (other - value) / duration;
        if slope >= low && slope <= high {
            end = index;
        }
        low = low.max((other - error - value) / duration);
        high = high.min((other + error - value) / duration);
        if low > high {
            break;
        }
    }
    end
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn a_line_is_two_points_and_a_corner_is_kept() {
        let points: Vec<_> = (0..1000)
            .map(|index| f64::from(index) * 0.001)
            .map(|time| (time, if time < 0.5 { time } else { 0.5 }))
            .collect();
        let thinned = thin(&Trajectory::new(&points).unwrap(), 0.001);
        assert!(thinned.points.len() <= 4, "{thinned:?}");
        assert_eq!((thinned.time_decimals, thinned.decimals), (3, 4));
        assert_eq!(thinned.points.last(), Some(&(0.999, 0.5)));
    }

    proptest! {
        #[test]
        fn the_error_is_bounded_at_each_point(
            steps in prop::collection::vec((1e-4..0.1, -1.0..1.0), 1..200),
            error in 1e-6..0.5,
        ) {
            let (mut time, mut value) = (0.0, 0.0);
            let points: Vec<(f64, f64)> = steps
                .iter()
                .map(|(step, change)| {
                    (time, value) = (time + step, value + change);
                    (time, value)
                })
                .collect();
            let trajectory = Trajectory::new(&points).unwrap();
            let thinned = thin(&trajectory, error);
            let other = Trajectory::new(&thinned.points).unwrap();
            for (time, value) in trajectory.points() {
                prop_assert!((other.at(*time) - value).abs() <= error * (1.0 + 1e-9));
            }
            prop_assert!(thinned.points.len() <= points.len());
        }
    }
}
