//! Comparisons of two versions: error rates, coverage and numbers of trials, computed exactly.

use std::collections::BTreeMap;

use rtf_statistics::difference::{of_paired_rates, of_rates};
use rtf_statistics::independent::fisher;
use rtf_statistics::paired::mcnemar;
use rtf_statistics::sample_size::{MAX_TRIALS, independent_power, paired_power, sufficient_trials};
use rtf_statistics::{Counts, Difference, PairCounts};

use super::binomial::probabilities;
use super::documented::assert_documented;

const ALPHAS: [f64; 2] = [0.05, 0.01];

fn counts(successes: usize, trials: u64) -> Counts {
    Counts { successes: successes as u64, trials }
}

#[test]
fn mcnemars_test_keeps_its_error_rate() {
    for (pairs, discordant) in [(10, 0.9), (40, 0.05), (40, 0.3), (200, 0.1), (200, 0.5)] {
        for alpha in ALPHAS {
            let wrong = |different: usize| {
                let each = probabilities(different as u64, 0.5).into_iter().enumerate();
                let is_found = |first: usize| {
                    mcnemar(first as u64, (different - first) as u64).p_value <= alpha
                };
                each.filter(|(first, _)| is_found(*first)).map(|(_, p)| p).sum::<f64>()
            };
            let numbers = probabilities(pairs, discordant).into_iter().enumerate();
            let found: f64 = numbers.map(|(different, p)| p * wrong(different)).sum();
            assert!(found <= alpha + 1e-12, "{pairs}, {discordant}, {alpha}: {found}");
        }
    }
}

#[test]
fn fishers_test_keeps_its_error_rate_on_each_side() {
    for (first, second) in [(10, 10), (20, 60), (50, 50), (100, 30)] {
        let mut p_values = BTreeMap::new();
        for (a, b) in (0..=first).flat_map(|a| (0..=second).map(move |b| (a, b))) {
            let (of_first, of_second) = (counts(a as usize, first), counts(b as usize, second));
            p_values.insert((a as usize, b as usize), fisher(of_first, of_second));
        }
        for rate in [0.03, 0.1, 0.25, 0.5, 0.8, 0.95, 0.99] {
            let chances = [probabilities(first, rate), probabilities(second, rate)];
            for alpha in ALPHAS {
                let mut wrong = [0.0; 2];
                for ((a, b), p_value) in &p_values {
                    if *p_value <= alpha {
                        let is_first_worse = (*a as u64) * second < (*b as u64) * first;
                        wrong[usize::from(is_first_worse)] += chances[0][*a] * chances[1][*b];
                    }
                }
                let of = format!("{first}, {second}, {rate}, {alpha}: {wrong:?}");
                assert!(wrong.iter().all(|it| *it <= alpha / 2.0 + 1e-12), "{of}");
            }
        }
    }
}

/// The mean and the lowest probability that an interval contains the difference.
fn summary(coverage: &[f64]) -> (f64, f64) {
    let mean = coverage.iter().sum::<f64>() / coverage.len() as f64;
    (mean, coverage.iter().copied().fold(1.0, f64::min))
}

fn contains(found: &Difference, difference: f64) -> bool {
    found.low - 1e-12 <= difference && difference <= found.high + 1e-12
}

fn independent_coverage(trials: u64) -> (f64, f64) {
    let size = trials as usize + 1;
    let interval =
        |at: usize| of_rates(counts(at / size, trials), counts(at % size, trials), 0.95).unwrap();
    let intervals: Vec<Difference> = (0..size * size).map(interval).collect();
    let rates: Vec<f64> = (0..25).map(|step| 0.02 + 0.04 * f64::from(step)).collect();
    let chances: Vec<_> = rates.iter().map(|rate| probabilities(trials, *rate)).collect();
    let mut coverage = Vec::new();
    for (first, of_first) in rates.iter().zip(&chances) {
        for (second, of_second) in rates.iter().zip(&chances) {
            let pairs = of_first.iter().flat_map(|a| of_second.iter().map(move |b| a * b));
            let inside = pairs.zip(&intervals).filter(|(_, it)| contains(it, second - first));
            coverage.push(inside.map(|(probability, _)| probability).sum());
        }
    }
    summary(&coverage)
}

fn paired_coverage(pairs: u64) -> (f64, f64) {
    let log = |count: u64| libm::lgamma(count as f64 + 1.0);
    let mut tables = Vec::new();
    for both_passed in 0..=pairs {
        for only_first in 0..=pairs - both_passed {
            for only_second in 0..=pairs - both_passed - only_first {
                let none_passed = pairs - both_passed - only_first - only_second;
                let table = PairCounts { both_passed, only_first, only_second, none_passed };
                let counts = [both_passed, only_first, only_second, none_passed];
                let ways = log(pairs) - counts.into_iter().map(log).sum::<f64>();
                let interval = of_paired_rates(&table, 0.95).unwrap();
                tables.push((counts.map(|count| count as f64), ways, interval));
            }
        }
    }
    let mut coverage = Vec::new();
    for shares in shares(20) {
        let difference = shares[2] - shares[1];
        let logs = shares.map(|share| if share > 0.0 { share.ln() } else { -1e9 });
        let inside = tables.iter().filter(|(_, _, interval)| contains(interval, difference));
        let probability = |(counts, ways, _): &([f64; 4], f64, Difference)| {
            let terms = counts.iter().zip(&logs);
            (ways + terms.map(|(count, log)| count * log).sum::<f64>()).exp()
        };
        coverage.push(inside.map(probability).sum());
    }
    summary(&coverage)
}

/// The probabilities of the four results of a pair, in parts of `parts`; the second version is the
/// better one.
fn shares(parts: u32) -> Vec<[f64; 4]> {
    let mut all = Vec::new();
    for both in 1..parts {
        for first in 0..parts - both {
            for second in first..parts - both - first {
                let counts = [both, first, second, parts - both - first - second];
                all.push(counts.map(|count| f64::from(count) / f64::from(parts)));
            }
        }
    }
    all
}

#[test]
fn intervals_of_differences_have_their_confidence_on_average() {
    let mut table = String::from(
        "| versions | episodes of each | contains the difference, mean | lowest |\n\
         | --- | ---: | ---: | ---: |\n",
    );
    let mut row = |name: &str, trials: u64, (mean, lowest): (f64, f64), least: f64| {
        let is_expected = (0.95..0.97).contains(&mean) && lowest >= least;
        assert!(is_expected, "{name} {trials}: {mean} {lowest}");
        let (mean, lowest) = (100.0 * mean, 100.0 * lowest);
        table += &format!("| {name} | {trials} | {mean:.1} % | {lowest:.1} % |\n");
    };
    for (trials, least) in [(20, 0.88), (50, 0.93), (100, 0.93)] {
        row("independent", trials, independent_coverage(trials), least);
    }
    for (pairs, least) in [(20, 0.9), (40, 0.89)] {
        row("in pairs", pairs, paired_coverage(pairs), least);
    }
    assert_documented(&table);
}

#[test]
fn a_sufficient_number_has_the_power_and_hardly_fewer_trials_have_it() {
    let nearly = |enough: u64, power_of: &dyn Fn(u64) -> f64| {
        assert!(power_of(enough) >= 0.8 && power_of(enough * 9 / 10) < 0.8, "{enough}");
        // The power falls when one more failure is necessary, but hardly.
        assert!((enough..enough + 12).all(|trials| power_of(trials) >= 0.79), "{enough}");
    };
    for (better, worse, alpha) in [(0.9, 0.8, 0.05), (0.95, 0.75, 0.01), (0.55, 0.4, 0.025)] {
        let power_of = |trials| independent_power(trials, better, worse, alpha);
        let (enough, power) = sufficient_trials(0.8, power_of).unwrap();
        assert_eq!(power, power_of(enough));
        nearly(enough, &power_of);
    }
    for (only_better, only_worse) in [(0.1, 0.0), (0.18, 0.08), (0.3, 0.15)] {
        let power_of = |pairs| paired_power(pairs, only_better, only_worse, 0.05);
        nearly(sufficient_trials(0.8, power_of).unwrap().0, &power_of);
    }
}

#[test]
fn a_power_out_of_reach_has_no_number() {
    let power_of = |trials| independent_power(trials, 0.5, 0.499, 0.05);
    assert_eq!(sufficient_trials(0.8, power_of), None);
    assert_eq!(sufficient_trials(0.8, |trials| trials as f64 / MAX_TRIALS as f64 - 0.3), None);
    assert_eq!(sufficient_trials(0.8, |_| 0.9), Some((1, 0.9)));
}

#[test]
fn impossible_rates_have_no_power() {
    assert!(independent_power(10, 1.2, 0.5, 0.05).is_nan());
    assert_eq!(paired_power(10, 0.0, 0.0, 0.05), 0.0);
}
