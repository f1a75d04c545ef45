//! The median, its spread, and limits that are learned from them. A few wrong values move them
//! little, unlike the mean and the standard deviation.

use serde::Serialize;

/// The standard deviation of a normal distribution, in its median absolute deviations:
/// 1/Φ⁻¹(3/4). Source: P. J. Rousseeuw, C. Croux, "Alternatives to the median absolute deviation",
/// Journal of the American Statistical Association 88 (1993), 1273–1283.
pub const NORMAL_CONSISTENCY: f64 = 1.482_602_218_505_602;

/// Limits learned from a series, in its unit.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LearnedLimits {
    /// median − k · deviation.
    pub low: f64,
    /// median + k · deviation.
    pub high: f64,
    pub median: f64,
    /// The median absolute deviation, scaled to a standard deviation. 0 if more than half of the
    /// values are equal: then both limits are the median.
    pub deviation: f64,
    pub used: usize,
    /// How many values were left out because they are NaN or infinite.
    pub left_out: usize,
}

/// A series is too short to learn limits from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, thiserror::Error)]
#[error("{used} of {required} values to learn limits")]
pub struct TooFewValues {
    /// How many finite values there are.
    pub used: usize,
    pub required: usize,
}

/// The limits median ± `k` · deviation of `values`.
///
/// `values` must be from one state of the robot: since the last accepted change point. NaN and
/// infinite values are left out and counted.
///
/// # Errors
/// If there are fewer than `min_values` finite values, or none.
pub fn learn_limits(
    values: &[f64],
    k: f64,
    min_values: usize,
) -> Result<LearnedLimits, TooFewValues> {
    let used = values.iter().filter(|value| value.is_finite()).count();
    let too_few = TooFewValues { used, required: min_values.max(1) };
    if used < min_values {
        return Err(too_few);
    }
    let median = median(values).ok_or(too_few)?;
    let deviation = median_absolute_deviation(values).ok_or(too_few)?;
    Ok(LearnedLimits {
        low: median - k * deviation,
        high: median + k * deviation,
        median,
        deviation,
        used,
        left_out: values.len() - used,
    })
}

/// The middle of the finite values, or the mean of both middle ones. `None` without any.
#[must_use]
pub fn median(values: &[f64]) -> Option<f64> {
    let mut finite: Vec<f64> = values.iter().copied().filter(|v| v.is_finite()).collect();
    let (count, middle) = (finite.len(), finite.len() / 2);
    if count == 0 {
        return None;
    }
    let (below, upper, _) = finite.select_nth_unstable_by(middle, f64::total_cmp);
    let lower = below.iter().copied().max_by(f64::total_cmp).filter(|_| count % 2 == 0);
    Some(lower.map_or(*upper, |lower| lower.midpoint(*upper)))
}

/// The median distance of the finite values to their median, times [`NORMAL_CONSISTENCY`].
/// `None` without any.
#[must_use]
pub fn median_absolute_deviation(values: &[f64]) -> Option<f64> {
    let centre = median(values)?;
    let distances: Vec<f64> = values
        .iter()
        .filter(|value| value.is_finite())
        .map(|value| (value - centre).abs())
        .collect();
    Some(NORMAL_CONSISTENCY * median(&distances)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn median_of_odd_and_even_counts() {
        assert_eq!(median(&[]), None);
        assert_eq!(median(&[f64::NAN, f64::INFINITY]), None);
        assert_eq!(median(&[3.0]), Some(3.0));
        assert_eq!(median(&[9.0, 1.0, 2.0]), Some(2.0));
        assert_eq!(median(&[9.0, 1.0, 2.0, 4.0]), Some(3.0));
        assert_eq!(median(&[f64::MAX, f64::MAX]), Some(f64::MAX));
    }

    #[test]
    fn deviation_equals_that_of_scipy() {
        // scipy.stats.median_abs_deviation(x, scale="normal") of SciPy 1.17.1
        let found = median_absolute_deviation(&[1.0, 2.0, 4.0, 7.0, 11.0, 100.0]).expect("values");
        assert!((found - 5.930_408_874_022_408).abs() < 1e-12, "{found}");
    }

    #[test]
    fn one_wrong_value_hardly_moves_the_limits() {
        let clean = [10.0, 10.1, 9.9, 10.2, 9.8, 10.0, 10.1, 9.9, 10.0];
        let mut dirty = clean;
        dirty[4] = 1e6;
        let a = learn_limits(&clean, 4.0, 5).expect("enough");
        let b = learn_limits(&dirty, 4.0, 5).expect("enough");
        assert!((a.high - b.high).abs() < 0.2 && (a.low - b.low).abs() < 0.2);
    }

    #[test]
    fn too_few_values_have_no_limits() {
        let values = [1.0, 2.0, f64::NAN];
        let error = learn_limits(&values, 4.0, 3).expect_err("too few");
        assert_eq!(error.to_string(), "2 of 3 values to learn limits");
        assert_eq!(learn_limits(&values, 4.0, 2).expect("enough").left_out, 1);
        assert!(learn_limits(&[], 4.0, 0).is_err());
    }

    #[test]
    fn equal_values_have_limits_of_no_width() {
        let limits = learn_limits(&[2.5; 10], 4.0, 10).expect("enough");
        assert!(limits.low == limits.high && limits.deviation == 0.0);
    }

    proptest! {
        #[test]
        fn limits_follow_shift_and_scale(
            values in prop::collection::vec(-1000_i32..1000, 1..40),
            shift in -1000_i32..1000,
            exponent in -3..4,
        ) {
            let scale = 2_f64.powi(exponent);
            let original: Vec<f64> = values.iter().copied().map(f64::from).collect();
            let moved: Vec<f64> = values.iter().map(|v| f64::from(v + shift) * scale).collect();
            let a = learn_limits(&original, 4.0, 1).expect("enough");
            let b = learn_limits(&moved, 4.0, 1).expect("enough");
            let expected = (a.high + f64::from(shift)) * scale;
            prop_assert!((b.high - expected).abs() <= 1e-9 * (1.0 + expected.abs()));
            prop_assert!((b.deviation - a.deviation * scale).abs() <= 1e-9 * (1.0 + b.deviation));
        }
    }
}
