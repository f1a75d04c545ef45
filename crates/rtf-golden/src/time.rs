//! Alignment by time: both trajectories start at their first point.

use crate::{Aligned, Comparison, Deviation, Trajectory};

/// Compares at all times; beyond its end, a trajectory keeps its last value.
///
/// The difference is linear between the points of both, so its maximum is at one of them, and the
/// mean of its square is an exact integral.
#[must_use]
pub fn by_time(got: &Trajectory, expected: &Trajectory) -> Comparison {
    let mut times: Vec<f64> =
        got.points().iter().chain(expected.points()).map(|(time, _)| *time).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut worst = None;
    let mut integral = 0.0;
    let mut last: Option<(f64, f64)> = None;
    for time in times {
        let deviation = Deviation { time, got: got.at(time), expected: expected.at(time) };
        let difference = deviation.got - deviation.expected;
        worst = Comparison::worse(worst, deviation);
        if let Some((before, other)) = last {
            let squares = other * other + other * difference + difference * difference;
            integral += (time - before) * squares / 3.0;
        }
        last = Some((time, difference));
    }
    let duration = got.duration().max(expected.duration());
    let worst = worst.unwrap_or(Deviation { time: 0.0, got: 0.0, expected: 0.0 });
    let rms = if duration > 0.0 { (integral / duration).sqrt() } else { worst.size() };
    let held = (duration > expected.duration()).then_some(duration);
    let times = expected.points().iter().map(|(time, _)| *time).chain(held);
    let aligned = times.map(|time| {
        let value = expected.at(time);
        Aligned { time, low: value, high: value }
    });
    Comparison { rms, worst, aligned: aligned.collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trajectory(points: &[(f64, f64)]) -> Trajectory {
        Trajectory::new(points).unwrap()
    }

    #[test]
    fn the_difference_is_compared_at_all_times() {
        // They differ most at a point of the reference: at 1 s by 1.
        let got = trajectory(&[(5.0, 0.0), (7.0, 0.0)]);
        let expected = trajectory(&[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)]);
        let comparison = by_time(&got, &expected);
        assert_eq!(comparison.worst, Deviation { time: 1.0, got: 0.0, expected: 1.0 });
        // The integral of t² over [0, 1], twice, over 2 s.
        assert!((comparison.rms - (1.0_f64 / 3.0).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn ends_are_held() {
        let got = trajectory(&[(0.0, 1.0)]);
        let expected = trajectory(&[(0.0, 1.0), (1.0, 1.0), (3.0, 4.0)]);
        let comparison = by_time(&got, &expected);
        assert_eq!((comparison.worst.time, comparison.worst.size()), (3.0, 3.0));
        let aligned: Vec<_> =
            by_time(&expected, &got).aligned.iter().map(|it| (it.time, it.low, it.high)).collect();
        assert_eq!(aligned, [(0.0, 1.0, 1.0), (3.0, 1.0, 1.0)]);
        assert_eq!(by_time(&got, &trajectory(&[(2.0, 4.0)])).rms, 3.0);
    }
}
