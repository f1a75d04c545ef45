use rtf_statistics::random::unit;
use rtf_statistics::{ConfidenceSequence, RandomStream};

use super::exact::Series;
use super::*;

fn counts(failed: &[(u64, u64)]) -> Vec<Counts> {
    failed.iter().map(|(failed, all)| Counts { passed: all - failed, failed: *failed }).collect()
}

/// Campaigns with given rates of passed episodes.
fn campaigns(random: &mut impl Iterator<Item = u64>, rates: &[(f64, u64)]) -> Vec<Counts> {
    let campaign = |(rate, episodes): &(f64, u64)| {
        let passes = random.by_ref().take(usize::try_from(*episodes).unwrap());
        let passed = passes.filter(|bits| unit(*bits) < *rate).count() as u64;
        Counts { passed, failed: episodes - passed }
    };
    rates.iter().map(campaign).collect()
}

fn random(name: &str) -> impl Iterator<Item = u64> {
    RandomStream::new(7, "test", name).sequence()
}

/// The definition: every arrangement of the failures.
fn by_definition(counts: &[Counts], ratio: f64) -> f64 {
    let series = Series::new(counts).unwrap();
    let failures: u64 = counts.iter().map(|it| it.failed).sum();
    let ways = |n: u64, k: u64| (0..k).fold(1.0, |ways, i| ways * (n - i) as f64 / (i + 1) as f64);
    let (mut all, mut reached) = (0.0, 0.0);
    let mut arrangements = vec![(Vec::new(), 1.0)];
    for count in counts {
        let add = |(numbers, weight): (Vec<u64>, f64)| {
            let choices = (0..=count.trials()).map(move |number| {
                let numbers = numbers.iter().copied().chain([number]).collect::<Vec<_>>();
                (numbers, weight * ways(count.trials(), number))
            });
            choices.collect::<Vec<_>>()
        };
        arrangements = arrangements.into_iter().flat_map(add).collect();
    }
    for (numbers, weight) in arrangements {
        if numbers.iter().sum::<u64>() != failures {
            continue;
        }
        all += weight;
        let sums = numbers.iter().scan(0, |sum, number| {
            *sum += number;
            Some(*sum)
        });
        let splits = (1..counts.len()).zip(sums);
        let highest = splits.map(|(split, sum)| series.ratio(split, sum)).fold(0.0, f64::max);
        reached += if highest >= ratio * (1.0 - 1e-9) { weight } else { 0.0 };
    }
    reached / all
}

#[test]
fn p_values_equal_the_definition() {
    let all = [
        counts(&[(1, 3), (0, 2), (2, 4)]),
        counts(&[(0, 5), (0, 1), (3, 5), (1, 2)]),
        counts(&[(2, 6), (1, 6), (0, 0), (2, 6)]),
        counts(&[(0, 4), (4, 4)]),
    ];
    for counts in &all {
        let series = Series::new(counts).unwrap();
        for split in 1..counts.len() {
            let ratio = series.ratio(split, series.observed(split));
            let (found, expected) = (series.p_value(ratio), by_definition(counts, ratio));
            assert!((found - expected).abs() < 1e-9, "{counts:?} {split}: {found} {expected}");
        }
    }
}

#[test]
fn of_two_equal_groups_it_is_fishers_exact_test() {
    // scipy.stats.fisher_exact([[1, 9], [11, 3]]) has unequal groups; of equal ones, the order of
    // the tables by ratio and by probability is the same: [[3, 1], [1, 3]] has 34/70.
    let change = best_split(&counts(&[(3, 4), (1, 4)])).unwrap();
    assert_eq!(change.index, 1);
    assert!((change.p_value - 34.0 / 70.0).abs() < 1e-9, "{change:?}");
}

#[test]
fn a_large_difference_has_a_bound_as_p_value() {
    let change = best_split(&counts(&[(0, 100_000), (0, 100_000), (90_000, 100_000)])).unwrap();
    assert_eq!(change.index, 2);
    assert!(change.p_value < 1e-300, "{change:?}");
    let series = Series::new(&counts(&[(10, 400), (60, 400)])).unwrap();
    let ratio = series.ratio(1, 10);
    let exact = by_split(400, 70, |rare| series.ratio(1, rare) >= ratio * (1.0 - 1e-9));
    assert!(exact < 1e-9 && series.p_value(ratio) >= exact, "{exact}");
}

/// The probability of splits of `failures` among two times `trials`.
fn by_split(trials: u64, failures: u64, is_meant: impl Fn(u64) -> bool) -> f64 {
    let ways = |n: u64, k: u64| statrs::function::factorial::ln_binomial(n, k);
    let of = |rare| {
        (ways(trials, rare) + ways(trials, failures - rare) - ways(2 * trials, failures)).exp()
    };
    (0..=failures).filter(|rare| is_meant(*rare)).map(of).sum()
}

#[test]
fn without_differences_there_is_no_change() {
    assert_eq!(find_rate_changes(&[], LEVEL), []);
    assert_eq!(find_rate_changes(&counts(&[(1, 9)]), LEVEL), []);
    assert_eq!(find_rate_changes(&counts(&[(0, 9), (0, 9)]), LEVEL), []);
    assert_eq!(find_rate_changes(&counts(&[(9, 9), (9, 9)]), LEVEL), []);
    assert_eq!(find_rate_changes(&counts(&[(0, 0), (0, 0), (1, 9)]), LEVEL), []);
}

#[test]
fn false_alarms_are_as_rare_as_the_level() {
    let mut random = random("no change");
    for (rate, episodes, length) in [(0.95, 60, 12), (0.5, 25, 30), (0.99, 200, 6)] {
        let series = 2000;
        let has_change = |_: &u32| {
            let counts = campaigns(&mut random, &vec![(rate, episodes); length]);
            !find_rate_changes(&counts, 0.05).is_empty()
        };
        let alarms = f64::from((0..series).filter(has_change).count() as u32);
        // 5 % with three standard deviations.
        let most = f64::from(series) * 0.05 + 3.0 * (f64::from(series) * 0.05 * 0.95).sqrt();
        assert!(alarms <= most, "{alarms} of {series} with rate {rate}");
    }
}

#[test]
fn planted_drops_are_found_at_the_right_campaign() {
    let mut random = random("drop");
    let rates = [vec![(0.97, 300); 10], vec![(0.85, 300); 8], vec![(0.98, 300); 6]].concat();
    let series = 200;
    let (mut right, mut extra) = (0, 0);
    for _ in 0..series {
        let changes = find_rate_changes(&campaigns(&mut random, &rates), LEVEL);
        let at: Vec<_> = changes.iter().map(|change| change.index).collect();
        right += usize::from(at.contains(&10)) + usize::from(at.contains(&18));
        extra += usize::from(changes.len() != 2);
    }
    assert!(right * 100 >= 2 * series * 95, "{right} of {}", 2 * series);
    assert!(extra * 100 <= 2 * series, "{extra} of {series} have another number of changes");
}

#[test]
fn a_drop_is_found_in_the_first_bad_campaign() {
    let found = find_rate_changes(&counts(&[(9, 500), (12, 500), (8, 500), (60, 500)]), LEVEL);
    assert_eq!(found.iter().map(|it| it.index).collect::<Vec<_>>(), [3]);
    let small = find_rate_changes(&counts(&[(9, 500), (12, 500), (8, 500), (14, 500)]), LEVEL);
    assert_eq!(small, []);
}

/// Under a sequential rule, the number of episodes depends on the results: the test is then not
/// exact.
#[test]
fn false_alarms_of_campaigns_that_stopped_early_are_bounded() {
    let mut random = random("sequential");
    let sequence = ConfidenceSequence::new(0.95).unwrap();
    for rate in [0.97, 0.99, 0.8] {
        let mut campaign = || {
            let mut count = Counts::default();
            for bits in random.by_ref().take(1000) {
                if unit(bits) < rate {
                    count.passed += 1;
                } else {
                    count.failed += 1;
                }
                if sequence.excludes(0.9, count.passed, count.trials()) {
                    break;
                }
            }
            count
        };
        let series = 400;
        let mut alarms = [0, 0];
        for _ in 0..series {
            let counts: Vec<_> = (0..10).map(|_| campaign()).collect();
            for (alarms, level) in alarms.iter_mut().zip([0.05, LEVEL]) {
                *alarms += u32::from(!find_rate_changes(&counts, level).is_empty());
            }
        }
        assert!(f64::from(alarms[1]) <= f64::from(series) * 0.01, "{alarms:?}, rate {rate}");
    }
}
