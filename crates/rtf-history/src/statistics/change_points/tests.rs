//! Made series with known changes, and properties.

use proptest::prelude::*;

use super::*;

/// Deterministic noise between −1 and 1: the golden ratio's multiples, evenly distributed.
fn noise(count: usize) -> impl Iterator<Item = f64> {
    (1..=count).map(|i| 2.0 * (i as f64 * 0.618_033_988_749_895).fract() - 1.0)
}

/// Levels with their lengths, and noise.
fn steps(levels: &[(usize, f64)], amplitude: f64) -> Vec<f64> {
    let levels = levels.iter().flat_map(|(count, level)| std::iter::repeat_n(*level, *count));
    let levels: Vec<f64> = levels.collect();
    let noise = noise(levels.len());
    levels.iter().zip(noise).map(|(level, n)| level + amplitude * n).collect()
}

fn indexes(values: &[f64]) -> Vec<usize> {
    let found = find_change_points(values, &Options::default());
    found.points.iter().map(|point| point.index).collect()
}

#[test]
fn step_is_found_with_its_means() {
    let values = steps(&[(30, 10.0), (20, 12.0)], 0.5);
    let found = find_change_points(&values, &Options::default());
    let [point] = found.points.as_slice() else { panic!("{found:?}") };
    assert_eq!((point.index, point.before.count, point.after.count), (30, 30, 20));
    assert!((point.before.mean - 10.0).abs() < 0.1 && (point.after.mean - 12.0).abs() < 0.1);
    assert!(point.p_value < 1e-6);
    let size = point.size.expect("the mean is far from zero");
    assert!((size.fraction - 0.2).abs() < 0.02 && size.basis == Basis::MeanBefore);
}

#[test]
fn two_values_after_a_step_are_too_few() {
    assert_eq!(indexes(&steps(&[(30, 10.0), (2, 20.0)], 0.5)), [0; 0]);
    assert_eq!(indexes(&steps(&[(30, 10.0), (3, 20.0)], 0.5)), [30]);
}

#[test]
fn single_outlier_is_no_change() {
    for position in 0..60 {
        let mut values = steps(&[(60, 10.0)], 0.5);
        values[position] = 30.0;
        assert_eq!(indexes(&values), [0; 0], "outlier at {position}");
    }
}

#[test]
fn changes_over_many_windows_are_found() {
    let levels = [(40, 1.0), (90, 2.0), (170, 0.5), (200, 1.5)];
    assert_eq!(indexes(&steps(&levels, 0.2)), [40, 130, 300]);
}

#[test]
fn values_that_are_no_numbers_are_left_out_and_counted() {
    let mut values = steps(&[(20, 1.0), (20, 2.0)], 0.1);
    values.insert(0, f64::NAN);
    values.insert(11, f64::INFINITY);
    values.push(f64::NEG_INFINITY);
    let found = find_change_points(&values, &Options::default());
    assert_eq!((found.used, found.left_out), (40, 3));
    // Indexes are those of the caller.
    assert_eq!(found.points.iter().map(|p| p.index).collect::<Vec<_>>(), [22]);
}

#[test]
fn sizes_are_scaled_by_the_limits() {
    let values = steps(&[(30, 0.001), (30, 0.4)], 0.01);
    let found = find_change_points(&values, &Options::default());
    assert_eq!(found.points.len(), 1);
    assert_eq!(found.points[0].size, None, "zero is within the noise");
    let options = Options { limits_span: Some(4.0), ..Options::default() };
    let size = find_change_points(&values, &options).points[0].size.expect("limits");
    assert!((size.fraction - 0.1).abs() < 0.01 && size.basis == Basis::LimitsSpan);
    for span in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let options = Options { limits_span: Some(span), ..Options::default() };
        assert_eq!(find_change_points(&values, &options), found, "span {span}");
    }
}

#[test]
fn small_changes_are_merged() {
    let values = steps(&[(30, 10.0), (30, 10.5), (30, 20.0)], 0.1);
    assert_eq!(indexes(&values), [30, 60]);
    let options = Options { min_size: 0.1, ..Options::default() };
    let found = find_change_points(&values, &options);
    let [point] = found.points.as_slice() else { panic!("{found:?}") };
    assert_eq!((point.index, point.before.count), (60, 60), "measured from the merged segment");
}

#[test]
fn values_near_the_limits_of_floating_point() {
    for (low, high) in [(-f64::MAX, f64::MAX), (0.0, f64::MIN_POSITIVE), (1e300, 1.1e300)] {
        let values = [[low; 10], [high; 10]].concat();
        let found = find_change_points(&values, &Options::default());
        assert_eq!(found.points.len(), 1, "{low} to {high}");
        assert_eq!(found.points[0].index, 10);
    }
}

#[test]
fn short_and_empty_series_have_no_changes() {
    for count in 0..6 {
        let found = find_change_points(
            &steps(&[(count / 2, 1.0), (count, 9.0)], 0.0)[..count],
            &Options::default(),
        );
        assert_eq!((found.points.len(), found.used), (0, count));
    }
}

proptest! {
    #[test]
    fn constant_series_has_no_change(value in any::<f64>(), count in 0_usize..300) {
        prop_assert_eq!(find_change_points(&vec![value; count], &Options::default()).points, []);
    }

    /// Integers and powers of two, for which arithmetic is exact.
    #[test]
    fn changes_are_those_of_the_shifted_and_scaled_series(
        levels in prop::collection::vec((3_usize..40, -50_i32..50), 1..5),
        noise in prop::collection::vec(-10_i32..10, 160),
        shift in -10_000_i32..10_000,
        exponent in -20..20,
        mirrored in any::<bool>(),
    ) {
        let levels = levels.iter().flat_map(|(count, level)| std::iter::repeat_n(*level, *count));
        let values: Vec<i32> = levels.zip(noise).map(|(level, noise)| level + noise).collect();
        let scale = 2_f64.powi(exponent) * if mirrored { -1.0 } else { 1.0 };
        let original: Vec<f64> = values.iter().map(|v| f64::from(*v)).collect();
        let moved: Vec<f64> = values.iter().map(|v| scale * f64::from(v + shift)).collect();
        let a = find_change_points(&original, &Options::default());
        let b = find_change_points(&moved, &Options::default());
        prop_assert_eq!(a.points.len(), b.points.len());
        for (a, b) in a.points.iter().zip(&b.points) {
            prop_assert_eq!(a.index, b.index);
            prop_assert!((a.p_value - b.p_value).abs() <= 1e-9 * a.p_value);
        }
    }

    #[test]
    fn segments_are_long_enough_and_significant(
        values in prop::collection::vec(-5_i8..5, 0..200),
        min_segment in 1_usize..8,
        window in 0_usize..60,
    ) {
        let values: Vec<f64> = values.into_iter().map(f64::from).collect();
        let options = Options { min_segment, window, level: Level::PerTest(0.05), ..Options::default() };
        let found = find_change_points(&values, &options);
        for point in &found.points {
            prop_assert!(point.p_value < 0.05);
            prop_assert!(point.before.count >= min_segment && point.after.count >= min_segment);
        }
        for pair in found.points.windows(2) {
            let between = pair[0].index..pair[1].index;
            let set_aside = found.set_aside.iter().filter(|i| between.contains(i)).count();
            prop_assert_eq!(between.len(), pair[0].after.count + set_aside);
            prop_assert_eq!(pair[0].after, pair[1].before);
        }
    }
}
