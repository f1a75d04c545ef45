//! Whether a series of numbers rises: the test of Mann (1945) and Kendall
//! (1975), and the slope of Theil (1950) and Sen (1968), the median of the
//! slopes between all pairs. Neither assumes anything about the numbers'
//! distribution, and single outliers change little. Both are used to detect
//! software ageing (Garg, van Moorsel, Vaidyanathan and
//! Trivedi, "A methodology for detection and estimation of software aging",
//! ISSRE 1998).

/// False positives: one of a thousand series without a trend.
const SIGNIFICANT: f64 = 3.09;
/// False positives: one of twenty.
const LIKELY: f64 = 1.645;

/// The slope of a series, per step, if it rises significantly and its later half probably
/// rises, too: growth that has stopped is no trend.
pub(crate) fn rising(values: &[f64]) -> Option<f64> {
    let later = &values[values.len() / 2..];
    let rises = score(values) > SIGNIFICANT && score(later) > LIKELY;
    rises.then(|| slope(values)).flatten().filter(|slope| *slope > 0.0)
}

/// The Mann–Kendall score: rising pairs minus falling pairs, in standard deviations of
/// a series without a trend.
fn score(values: &[f64]) -> f64 {
    let mut rises = 0_i64;
    for (place, earlier) in values.iter().enumerate() {
        for later in &values[place + 1..] {
            rises += i64::from(later > earlier) - i64::from(later < earlier);
        }
    }
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let variance_of = |n: f64| n * (n - 1.0) * (2.0 * n + 5.0) / 18.0;
    let ties = sorted.chunk_by(|a, b| a == b).map(|same| variance_of(same.len() as f64));
    let variance = variance_of(values.len() as f64) - ties.sum::<f64>();
    if variance <= 0.0 {
        return 0.0;
    }
    // Corrected for steps of one instead of a continuum.
    (rises - rises.signum()) as f64 / variance.sqrt()
}

fn slope(values: &[f64]) -> Option<f64> {
    let mut slopes = Vec::with_capacity(values.len() * values.len() / 2);
    for (place, earlier) in values.iter().enumerate() {
        let later = values[place + 1..].iter().zip(1_u32..);
        slopes.extend(later.map(|(later, distance)| (later - earlier) / f64::from(distance)));
    }
    let middle = slopes.len() / 2;
    (middle < slopes.len()).then(|| *slopes.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_score_matches_published_values() {
        // All pairs of ten rise: S = 45, Var(S) = 10·9·25/18 = 125.
        let rising: Vec<f64> = (0..10).map(f64::from).collect();
        assert!((score(&rising) - 44.0 / 125.0_f64.sqrt()).abs() < 1e-12);
        // With ties: S = 5, Var(S) = (4·3·13 − 2·1·9)/18 = 138/18.
        let tied = [1.0, 2.0, 2.0, 3.0];
        assert!((score(&tied) - 4.0 / (138.0_f64 / 18.0).sqrt()).abs() < 1e-12);
        assert!(score(&[7.0; 20]).abs() < f64::EPSILON);
    }

    #[test]
    fn an_outlier_does_not_change_the_slope() {
        let mut values: Vec<f64> = (0..21).map(|place| f64::from(place) * 2.0).collect();
        values[20] = 1e9;
        assert!(slope(&values).is_some_and(|slope| (slope - 2.0).abs() < 1e-9));
        assert_eq!(rising(&values), slope(&values));
    }

    #[test]
    fn constant_and_falling_series_do_not_rise() {
        assert_eq!(rising(&(0..30).map(|place| -f64::from(place)).collect::<Vec<_>>()), None);
        assert_eq!(rising(&[5.0; 30]), None);
        assert_eq!(rising(&[]), None);
    }
}
