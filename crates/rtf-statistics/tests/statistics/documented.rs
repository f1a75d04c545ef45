//! The tables of `docs/explanation/campaign-statistics.md`: made campaigns with known rates.

use rtf_statistics::random::unit;
use rtf_statistics::{Accepted, ConfidenceSequence, RandomStream, Sprt};

use super::binomial::{ends, fixed_trials};

const CAMPAIGNS: u64 = 2000;

/// What a rule did with all made campaigns.
#[derive(Debug, Default)]
struct Made {
    low: u64,
    high: u64,
    trials: u64,
}

impl Made {
    fn mean(&self) -> f64 {
        self.trials as f64 / CAMPAIGNS as f64
    }

    fn share(count: u64) -> f64 {
        100.0 * count as f64 / CAMPAIGNS as f64
    }
}

/// Runs campaigns with at most `most` episodes that pass with probability `rate`. The rule is
/// asked after each episode. Rows with another name have other results.
fn made(name: &str, rate: f64, most: u64, rule: impl Fn(u64, u64) -> Option<bool>) -> Made {
    let mut made = Made::default();
    for campaign in 0..CAMPAIGNS {
        let results = RandomStream::new(campaign, "made", name).sequence();
        let mut successes = 0;
        for (trials, bits) in (1..=most).zip(results) {
            successes += u64::from(unit(bits) < rate);
            made.trials += 1;
            match rule(successes, trials) {
                Some(true) => made.high += 1,
                Some(false) => made.low += 1,
                None => continue,
            }
            break;
        }
    }
    made
}

fn sprt_table() -> String {
    let mut table = String::from(
        "| `low` | `high` | `alpha` | `beta` | fixed number | rate | passed | failed | wrong, exactly | mean episodes | of the fixed number |\n\
         | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    let mut parts = Vec::new();
    for (low, high, alpha, beta) in [
        (0.80, 0.90, 0.05, 0.05),
        (0.90, 0.97, 0.05, 0.05),
        (0.95, 0.99, 0.05, 0.05),
        (0.95, 0.99, 0.01, 0.01),
    ] {
        let test = Sprt::new(low, high, alpha, beta).unwrap();
        let rule = |successes, trials| {
            let accepted = test.accepted(successes, trials - successes);
            accepted.map(|accepted| accepted == Accepted::High)
        };
        let fixed = fixed_trials(low, high, alpha, beta);
        for (rate, allowed) in [(low, alpha), (high, beta)] {
            let name = format!("{low} {high} {alpha} {beta} {rate}");
            let (found, exact) = (made(&name, rate, 100_000, rule), ends(rate, 5000, rule));
            let (wrong, exactly) =
                if rate == low { (found.high, exact.high) } else { (found.low, exact.low) };
            let share = wrong as f64 / CAMPAIGNS as f64;
            let of = format!("{name}: {found:?}");
            assert_eq!(found.low + found.high, CAMPAIGNS, "{of}");
            assert!(exactly <= allowed, "{of}, exactly {exactly}");
            // Three standard deviations: the share of finitely many campaigns is random.
            let random = 3.0 * (allowed * (1.0 - allowed) / CAMPAIGNS as f64).sqrt();
            assert!((share - exactly).abs() <= random, "{of}, exactly {exactly}");
            parts.push(found.mean() / fixed as f64);
            table += &format!(
                "| {low} | {high} | {alpha} | {beta} | {fixed} | {rate} | {:.1} % | {:.1} % | {:.1} % | {:.0} | {:.0} % |\n",
                Made::share(found.high),
                Made::share(found.low),
                100.0 * exactly,
                found.mean(),
                100.0 * found.mean() / fixed as f64,
            );
        }
    }
    let mean = parts.iter().sum::<f64>() / parts.len() as f64;
    assert!(mean <= 0.6, "{mean}: {parts:?}");
    table
}

fn confidence_sequence_table() -> String {
    let mut table = String::from(
        "| claimed | `confidence` | rate | passed | failed | undecided | mean episodes |\n\
         | ---: | ---: | ---: | ---: | ---: | ---: | ---: |\n",
    );
    let (claimed, confidence, most) = (0.9, 0.95, 1000);
    let sequence = ConfidenceSequence::new(confidence).unwrap();
    for rate in [0.7, 0.8, 0.85, 0.9, 0.95, 0.97, 0.99] {
        let found = made(&format!("{claimed} {rate}"), rate, most, |successes, trials| {
            let is_above = successes as f64 >= claimed * trials as f64;
            sequence.excludes(claimed, successes, trials).then_some(is_above)
        });
        let wrong = if rate < claimed { found.high } else { found.low };
        let of = format!("{rate}: {found:?}");
        assert!(wrong as f64 <= (1.0 - confidence) * CAMPAIGNS as f64, "{of}");
        table += &format!(
            "| {claimed} | {confidence} | {rate} | {:.1} % | {:.1} % | {:.1} % | {:.0} |\n",
            Made::share(found.high),
            Made::share(found.low),
            Made::share(CAMPAIGNS - found.high - found.low),
            found.mean(),
        );
    }
    table
}

#[track_caller]
pub fn assert_documented(table: &str) {
    let page = include_str!("../../../../docs/explanation/campaign-statistics.md");
    assert!(page.contains(table), "the page does not contain:\n{table}");
}

#[test]
fn sequential_tests_keep_their_error_rates_with_fewer_episodes() {
    assert_documented(&sprt_table());
}

#[test]
fn confidence_sequences_decide_when_the_rate_is_clear() {
    assert_documented(&confidence_sequence_table());
}
