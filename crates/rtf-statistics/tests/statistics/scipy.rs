//! Comparisons with `tests/campaign/scipy.json`, which `tests/campaign/oracle.py` writes.

use rtf_statistics::paired::{mcnemar, permutation_test};
use rtf_statistics::random::normal_quantile;
use rtf_statistics::sample_size::{independent_power, paired_power};
use rtf_statistics::{ConfidenceSequence, Counts, Difference, PairCounts, RandomStream};
use rtf_statistics::{difference, exact_rate, holm, independent, rate};
use serde_json::Value;

/// The rows with results of one kind.
fn rows(kind: &str) -> Vec<Value> {
    let file = include_str!("../../../../tests/campaign/scipy.json");
    let mut results: Value = serde_json::from_str(file).unwrap();
    let rows = results[kind].take();
    let rows = rows.as_array().unwrap();
    assert!(!rows.is_empty());
    rows.clone()
}

/// The rows of a kind whose cells are numbers.
fn numbers<const COLUMNS: usize>(kind: &str) -> Vec<[f64; COLUMNS]> {
    let row = |row: Value| {
        let cells: Vec<f64> = serde_json::from_value(row).unwrap();
        cells.try_into().unwrap()
    };
    rows(kind).into_iter().map(row).collect()
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "small counts")]
fn count(number: f64) -> u64 {
    number as u64
}

#[track_caller]
fn assert_near(found: f64, expected: f64, relative: f64) {
    assert!((found - expected).abs() <= relative * expected.abs(), "{found} != {expected}");
}

#[test]
fn wilson_intervals() {
    for [successes, trials, confidence, low, high] in numbers("wilson") {
        let found = rate(count(successes), count(trials), confidence).unwrap();
        assert_near(found.low, low, 1e-9);
        assert_near(found.high, high, 1e-9);
    }
}

#[test]
fn exact_intervals() {
    for [successes, trials, confidence, low, high] in numbers("exact") {
        let found = exact_rate(count(successes), count(trials), confidence).unwrap();
        assert_near(found.low, low, 1e-7);
        assert_near(found.high, high, 1e-7);
    }
}

#[test]
fn quantiles_of_the_normal_distribution() {
    for [probability, quantile] in numbers("normal_quantile") {
        assert_near(normal_quantile(probability), quantile, 1e-13);
    }
}

#[test]
fn confidence_sequences() {
    for [successes, trials, confidence, low, high] in numbers("confidence_sequence") {
        let sequence = ConfidenceSequence::new(confidence).unwrap();
        let found = sequence.rate(count(successes), count(trials)).unwrap();
        assert_near(found.low, low, 1e-8);
        assert_near(found.high, high, 1e-8);
    }
}

#[test]
fn mcnemars_test() {
    for [only_first, only_second, p_value] in numbers("mcnemar") {
        assert_near(mcnemar(count(only_first), count(only_second)).p_value, p_value, 1e-9);
    }
}

#[test]
fn permutation_tests() {
    for row in rows("permutation") {
        let differences: Vec<f64> = serde_json::from_value(row[0].clone()).unwrap();
        let found = permutation_test(&differences, 0);
        assert_near(found.p_value, row[1].as_f64().unwrap(), 1e-12);
    }
}

#[test]
fn random_numbers() {
    for row in rows("random") {
        let (seed, index) = (row[0].as_u64().unwrap(), row[3].as_u64().unwrap());
        let mut stream =
            RandomStream::new(seed, row[1].as_str().unwrap(), row[2].as_str().unwrap());
        assert_eq!(stream.bits(index).to_string(), row[4].as_str().unwrap());
    }
}

fn counts(successes: f64, trials: f64) -> Counts {
    Counts { successes: count(successes), trials: count(trials) }
}

#[track_caller]
fn assert_interval(found: Option<Difference>, low: f64, high: f64, relative: f64) {
    let found = found.unwrap();
    assert!((found.low - low).abs() <= relative, "{found:?} != {low} to {high}");
    assert!((found.high - high).abs() <= relative, "{found:?} != {low} to {high}");
}

#[test]
fn fishers_test() {
    for [first, trials, second, others, p_value] in numbers("fisher") {
        let found = independent::fisher(counts(first, trials), counts(second, others));
        assert_near(found, p_value, 1e-9);
    }
}

#[test]
fn differences_of_rates() {
    for [first, trials, second, others, low, high] in numbers("difference") {
        let (first, second) = (counts(first, trials), counts(second, others));
        assert_interval(difference::of_rates(first, second, 0.95), low, high, 1e-9);
    }
    for [both, first, second, none, low, high] in numbers("paired_difference") {
        let [both_passed, only_first, only_second, none_passed] =
            [both, first, second, none].map(count);
        let pairs = PairCounts { both_passed, only_first, only_second, none_passed };
        assert_interval(difference::of_paired_rates(&pairs, 0.95), low, high, 1e-9);
    }
}

#[test]
fn differences_of_means_and_their_permutations() {
    let values = |cell: &Value| -> Vec<f64> { serde_json::from_value(cell.clone()).unwrap() };
    let number = |cell: &Value| cell.as_f64().unwrap();
    for row in rows("paired_means") {
        let found = difference::of_paired_means(&values(&row[0]), 0.95);
        assert_interval(found, number(&row[1]), number(&row[2]), 1e-9);
    }
    for row in rows("means") {
        let (first, second) = (values(&row[0]), values(&row[1]));
        let found = difference::of_means(&first, &second, 0.95);
        assert_interval(found, number(&row[2]), number(&row[3]), 1e-9);
        let p_value = independent::permutation_test(&first, &second, 0);
        assert_near(p_value, number(&row[4]), 1e-12);
    }
}

#[test]
fn adjusted_p_values() {
    for row in rows("holm") {
        let [p_values, adjusted]: [Vec<f64>; 2] = serde_json::from_value(row).unwrap();
        for (found, expected) in holm(&p_values).into_iter().zip(adjusted) {
            assert_near(found, expected, 1e-12);
        }
    }
}

#[test]
fn powers_of_comparisons() {
    for [pairs, better, worse, alpha, power] in numbers("paired_power") {
        assert_near(paired_power(count(pairs), better, worse, alpha), power, 1e-8);
    }
    for [trials, better, worse, alpha, power] in numbers("independent_power") {
        assert_near(independent_power(count(trials), better, worse, alpha), power, 1e-8);
    }
}
