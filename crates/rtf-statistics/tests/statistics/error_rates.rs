//! Error rates and coverage, computed exactly.

use rtf_statistics::{Accepted, ConfidenceSequence, Rate, Sprt, exact_rate, rate};

use super::binomial::{ends, probabilities};

/// A rule that asks a sequential test.
fn asking(test: Sprt) -> impl Fn(u64, u64) -> Option<bool> {
    move |successes, trials| {
        test.accepted(successes, trials - successes).map(|accepted| accepted == Accepted::High)
    }
}

#[test]
fn sprt_keeps_both_error_rates() {
    for (low, high) in [(0.9, 0.97), (0.95, 0.99), (0.5, 0.7), (0.1, 0.2), (0.2, 0.9)] {
        for (alpha, beta) in [(0.05, 0.05), (0.01, 0.1), (0.2, 0.01)] {
            let test = Sprt::new(low, high, alpha, beta).unwrap();
            let at_low = ends(low, 5000, asking(test));
            let at_high = ends(high, 5000, asking(test));
            let of = format!("{low} and {high} with {alpha} and {beta}");
            assert!(at_low.high <= alpha, "{of}: {at_low:?}");
            assert!(at_high.low <= beta, "{of}: {at_high:?}");
            // It decides, and is not much more careful than it has to be.
            assert!(at_low.low + at_low.high > 0.9999, "{of}: {at_low:?}");
            assert!(at_high.low + at_high.high > 0.9999, "{of}: {at_high:?}");
            assert!(at_low.high > 0.2 * alpha && at_high.low > 0.02 * beta, "{of}");
        }
    }
}

#[test]
fn a_rate_beyond_both_has_fewer_errors() {
    let test = Sprt::new(0.9, 0.97, 0.05, 0.05).unwrap();
    let found = [0.8, 0.9].map(|rate| ends(rate, 5000, asking(test)));
    assert!(found[0].high < found[1].high && found[0].mean < found[1].mean, "{found:?}");
}

#[test]
fn confidence_sequences_hold_at_every_number_of_trials() {
    for confidence in [0.9, 0.99] {
        let sequence = ConfidenceSequence::new(confidence).unwrap();
        for rate in [0.02, 0.3, 0.5, 0.95, 0.999] {
            let excluded = |s, n| sequence.excludes(rate, s, n).then_some(true);
            let found = ends(rate, 1000, excluded);
            assert!(found.high <= 1.0 - confidence, "{rate}, {confidence}: {found:?}");
        }
    }
}

/// An interval for a fixed number, evaluated after each trial, excludes the rate far too often:
/// the reason for the rules above.
#[test]
fn an_interval_for_a_fixed_number_does_not_hold_at_every_number() {
    let excluded = |successes, trials| {
        let found = rate(successes, trials, 0.95).unwrap();
        (trials >= 10 && (found.low > 0.5 || found.high < 0.5)).then_some(true)
    };
    assert!(ends(0.5, 500, excluded).high > 0.3);
}

/// The probability that an interval contains the rate; `intervals` are those for 0, 1, … successes.
fn coverage(p: f64, intervals: &[Rate]) -> f64 {
    let trials = intervals.len() as u64 - 1;
    let probabilities = probabilities(trials, p).into_iter().zip(intervals);
    let covered = probabilities.filter(|(_, found)| found.low <= p && p <= found.high);
    covered.map(|(probability, _)| probability).sum()
}

#[test]
fn exact_intervals_contain_every_rate_and_wilson_intervals_the_average_one() {
    for (trials, confidence) in [(20, 0.95), (100, 0.9), (100, 0.99), (200, 0.95)] {
        let rates: Vec<f64> = (1..200).map(|step| f64::from(step) / 200.0).collect();
        let intervals = |interval: fn(u64, u64, f64) -> Option<Rate>| -> Vec<Rate> {
            (0..=trials).filter_map(|successes| interval(successes, trials, confidence)).collect()
        };
        let (exact, wilson) = (intervals(exact_rate), intervals(rate));
        let lowest = rates.iter().map(|p| coverage(*p, &exact)).fold(1.0, f64::min);
        assert!(lowest >= confidence - 1e-9, "{trials}, {confidence}: {lowest}");
        let mean = rates.iter().map(|p| coverage(*p, &wilson)).sum::<f64>() / rates.len() as f64;
        assert!((mean - confidence).abs() < 0.005, "{trials}, {confidence}: {mean}");
    }
}

/// The reason for exact intervals in judgements: a claim that is just true.
#[test]
fn wilson_intervals_would_refute_true_claims_too_often() {
    let refuted = |interval: &dyn Fn(u64) -> Option<Rate>| {
        let below = |(successes, p): (usize, f64)| {
            if interval(successes as u64).unwrap().high < 0.99 { p } else { 0.0 }
        };
        probabilities(100, 0.99).into_iter().enumerate().map(below).sum::<f64>()
    };
    let wilson = refuted(&|successes| rate(successes, 100, 0.99));
    let exact = refuted(&|successes| exact_rate(successes, 100, 0.99));
    assert!(wilson > 0.018 && exact <= 0.005, "{wilson}, {exact}");
}
