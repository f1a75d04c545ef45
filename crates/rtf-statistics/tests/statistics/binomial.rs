//! Exact probabilities of results: binomial, and of rules that may end after each trial.

/// The probabilities of 0 … `trials` successes.
pub fn probabilities(trials: u64, rate: f64) -> Vec<f64> {
    let log_choose =
        |k: f64, n: f64| libm::lgamma(n + 1.0) - libm::lgamma(k + 1.0) - libm::lgamma(n - k + 1.0);
    let n = trials as f64;
    (0..=trials)
        .map(|successes| {
            let k = successes as f64;
            (log_choose(k, n) + k * rate.ln() + (n - k) * (1.0 - rate).ln()).exp()
        })
        .collect()
}

/// The fewest trials of a test with a fixed number whose error rates are at most `alpha` for the
/// rate `low` and at most `beta` for the rate `high`.
pub fn fixed_trials(low: f64, high: f64, alpha: f64, beta: f64) -> u64 {
    (1..)
        .find(|trials| {
            // Accepts `high` from a number of successes on: the fewest that `alpha` allows.
            let mut false_high = 0.0;
            let mut accepts = |p: &f64| {
                false_high += p;
                false_high <= alpha
            };
            let under_low = probabilities(*trials, low);
            let accepting = under_low.iter().rev().take_while(|p| accepts(p)).count();
            let under_high = probabilities(*trials, high);
            under_high[..under_high.len() - accepting].iter().sum::<f64>() <= beta
        })
        .unwrap()
}

/// What a rule does in the end.
#[derive(Debug, Default)]
pub struct Ends {
    /// The probability that it decides for a low rate.
    pub low: f64,
    /// The probability that it decides for a high rate.
    pub high: f64,
    /// The expected number of trials.
    pub mean: f64,
}

/// The ends of a rule that is asked after each of at most `most` trials with this rate.
pub fn ends(rate: f64, most: u64, rule: impl Fn(u64, u64) -> Option<bool>) -> Ends {
    let mut ends = Ends::default();
    // The probability of each number of successes so far, without those that are decided.
    let mut active = vec![(0_u64, 1.0)];
    for trials in 1..=most {
        ends.mean += active.iter().map(|(_, p)| p).sum::<f64>();
        let mut next: Vec<(u64, f64)> = Vec::with_capacity(active.len() + 1);
        for (successes, probability) in active {
            for (successes, p) in [(successes, 1.0 - rate), (successes + 1, rate)] {
                match next.last_mut().filter(|(last, _)| *last == successes) {
                    Some((_, sum)) => *sum += probability * p,
                    None => next.push((successes, probability * p)),
                }
            }
        }
        next.retain(|(successes, probability)| match rule(*successes, trials) {
            Some(true) => {
                ends.high += probability;
                false
            }
            Some(false) => {
                ends.low += probability;
                false
            }
            None => *probability > 1e-15,
        });
        active = next;
    }
    ends
}
