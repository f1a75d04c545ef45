//! Student's t-test of two segments of a series.

use serde::Serialize;
use statrs::function::beta::checked_beta_reg;

/// Differences below this part of the largest magnitude are rounding errors.
const RESOLUTION: f64 = 16.0 * f64::EPSILON;

/// A run of values between two changes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Segment {
    pub count: usize,
    /// The mean, in the unit of the values.
    pub mean: f64,
    /// The sample standard deviation (divisor n − 1), in the unit of the values. 0 for one value.
    pub deviation: f64,
}

impl Segment {
    #[expect(clippy::cast_precision_loss, reason = "counts of values are far below 2^53")]
    pub(super) fn of(values: &[f64]) -> Self {
        let first = values.first().copied().unwrap_or(0.0);
        let count = values.len() as f64;
        // Relative to the first value, so that equal values have exactly that mean.
        let mean = first + values.iter().map(|v| v / count - first / count).sum::<f64>();
        let largest = values.iter().map(|v| (v - mean).abs()).fold(0.0, f64::max);
        // Scaled, because the square of a large value overflows.
        let deviation = if values.len() < 2 || largest == 0.0 {
            0.0
        } else {
            let squares = values.iter().map(|v| ((v - mean) / largest).powi(2));
            largest * (squares.sum::<f64>() / (count - 1.0)).sqrt()
        };
        Self { count: values.len(), mean, deviation }
    }
}

/// The probability of a difference of means at least as large as that of `a` and `b` if both were
/// from one normal distribution: the two-sided p value of Student's t-test with pooled variance.
///
/// Source: Student (W. S. Gosset), "The probable error of a mean", Biometrika 6 (1908), 1–25; the
/// probability is the regularized incomplete beta function I(ν/(ν+t²); ν/2, 1/2), M. Abramowitz,
/// I. A. Stegun, "Handbook of mathematical functions", 26.7.1.
#[expect(clippy::cast_precision_loss, reason = "counts of values are far below 2^53")]
pub(super) fn p_value(a: &Segment, b: &Segment) -> f64 {
    let difference = (a.mean - b.mean).abs();
    if a.count + b.count < 3 || difference <= RESOLUTION * a.mean.abs().max(b.mean.abs()) {
        return 1.0;
    }
    let (n, m) = (a.count as f64, b.count as f64);
    let freedom = n + m - 2.0;
    // Relative to the difference, because its square can overflow.
    let part = |segment: &Segment, count: f64| {
        (count - 1.0) * (segment.deviation / difference).powi(2) / freedom
    };
    let t_squared = 1.0 / ((part(a, n) + part(b, m)) * (1.0 / n + 1.0 / m));
    let x = freedom / (freedom + t_squared);
    checked_beta_reg(freedom / 2.0, 0.5, x).unwrap_or(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn p_values_equal_those_of_scipy() {
        // scipy.stats.ttest_ind(a, b).pvalue of SciPy 1.17.1
        let cases: [(&[f64], &[f64], f64); 4] = [
            (&[1.0, 2.0, 3.0], &[2.0, 3.0, 4.5], 0.277_069_167_347_592_1),
            (&[1.0, 2.0, 3.0], &[11.0, 12.0, 13.0], 0.000_255_216_749_441_926_8),
            (&[1.0, 1.1, 0.9, 1.05, 0.95], &[9.0, 9.1, 8.9], 1.646_328_113_095_780_7e-11),
            (&[1.0, 2.0, 3.0, 4.0], &[1.0, 2.0, 3.0, 4.0], 1.0),
        ];
        for (a, b, expected) in cases {
            let p = p_value(&Segment::of(a), &Segment::of(b));
            assert!((p / expected - 1.0).abs() < 1e-10, "{p} != {expected}");
        }
    }

    #[test]
    fn segments_without_noise_differ_or_are_equal() {
        assert!(p_value(&Segment::of(&[1.0; 5]), &Segment::of(&[2.0; 5])) < f64::MIN_POSITIVE);
        assert!(
            (p_value(&Segment::of(&[0.1; 5]), &Segment::of(&[0.1; 7])) - 1.0).abs() < f64::EPSILON
        );
    }

    #[test]
    fn rounding_errors_are_no_difference() {
        let (a, b) = (Segment::of(&[0.1 + 0.2; 5]), Segment::of(&[0.3; 5]));
        assert!(a.mean > b.mean);
        assert!((p_value(&a, &b) - 1.0).abs() < f64::EPSILON);
    }

    #[test]
    fn values_near_the_limits_of_floating_point() {
        let segment = Segment::of(&[f64::MAX, f64::MAX / 2.0, f64::MAX]);
        assert!(segment.mean.is_finite() && segment.deviation.is_finite());
        let small = Segment::of(&[1.0, 2.0, 3.0]);
        assert!((0.0..1.0).contains(&p_value(&segment, &small)));
    }
}
