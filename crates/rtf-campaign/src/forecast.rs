//! How many more episodes an undecided claim needs.

use crate::judgement::{Judge, Judgement, Verdict};

/// A decision that needs more episodes is not forecast.
pub const MAX_FORECAST: u64 = 50_000;

/// Numbers of passes that are less probable do not count.
const NEGLIGIBLE: f64 = 1e-12;

impl Judge {
    /// About how many more episodes decide an undecided claim, if each of them passes with the rate
    /// so far: the median of a sequential rule, computed exactly. With a fixed number of episodes,
    /// at least the planned ones have to run; afterwards, the answer is how many more a new campaign
    /// would need. `None` if the claim is decided, no episode has a result, or more than
    /// [`MAX_FORECAST`] are needed.
    #[must_use]
    #[expect(clippy::cast_precision_loss, reason = "counts of episodes are far below 2^53")]
    pub fn more_episodes(&self, judgement: &Judgement) -> Option<u64> {
        let Judgement { passed, failed, without_result, .. } = *judgement;
        let known = passed + failed;
        if judgement.verdict != Verdict::Undecided || known == 0 {
            return None;
        }
        let rate = passed as f64 / known as f64;
        // Episodes without a result count in the worst way for each verdict.
        let (worst, best) = (passed, passed + without_result);
        let run = known + without_result;
        if self.is_fixed() {
            return self.more_of_fixed((worst, best), run, rate);
        }
        let median = |passed| self.median_until_decided(passed, run, rate);
        Some(median(worst)?.max(median(best)?))
    }

    /// The smallest number after which the interval at this rate excludes the claim.
    #[expect(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "counts of episodes are far below 2^53"
    )]
    fn more_of_fixed(&self, (worst, best): (u64, u64), run: u64, rate: f64) -> Option<u64> {
        let decided = |more: u64| {
            let further = (rate * more as f64).round() as u64;
            let verdict = |passed| self.decide_fixed(passed + further, run + more);
            verdict(worst).is_some() && verdict(worst) == verdict(best)
        };
        let first = self.planned().saturating_sub(run);
        if decided(first) {
            return Some(first);
        }
        let (mut undecided, mut more) = (first, first.max(1));
        while !decided(more) {
            (undecided, more) = (more, 2 * more);
            if undecided > MAX_FORECAST {
                return None;
            }
        }
        while more - undecided > 1 {
            let middle = u64::midpoint(undecided, more);
            if decided(middle) { more = middle } else { undecided = middle }
        }
        Some(more).filter(|more| *more <= MAX_FORECAST)
    }

    /// The number of further episodes after which a sequential rule has decided with a probability
    /// of at least one half.
    fn median_until_decided(&self, passed: u64, run: u64, rate: f64) -> Option<u64> {
        // The probabilities of `first`, `first` + 1, … further passes without a decision.
        let (mut first, mut undecided) = (0_u64, vec![1.0_f64]);
        for more in 1..=MAX_FORECAST {
            let mut next = vec![0.0; undecided.len() + 1];
            for (passes, probability) in undecided.iter().enumerate() {
                next[passes] += probability * (1.0 - rate);
                next[passes + 1] += probability * rate;
            }
            // Without a decision, the number of passes is between two limits.
            let is_decided = |passes: usize| {
                let passed = passed + first + passes as u64;
                self.decide_sequentially(passed, run + more).is_some()
            };
            let ends =
                |passes: usize, probability: f64| probability < NEGLIGIBLE || is_decided(passes);
            let mut range = 0..next.len();
            while !range.is_empty() && ends(range.end - 1, next[range.end - 1]) {
                range.end -= 1;
            }
            while !range.is_empty() && ends(range.start, next[range.start]) {
                range.start += 1;
            }
            first += range.start as u64;
            undecided = next[range].to_vec();
            if undecided.iter().sum::<f64>() <= 0.5 {
                return Some(more);
            }
        }
        None
    }
}

/// The words for a forecast. `None` if there is nothing to forecast.
#[must_use]
pub fn forecast_text(judge: &Judge, judgement: &Judgement) -> Option<String> {
    let known = judgement.passed + judgement.failed;
    if judgement.verdict != Verdict::Undecided || known == 0 {
        return None;
    }
    let needs = "a decision needs";
    Some(match judge.more_episodes(judgement) {
        None => format!("{needs} more than {MAX_FORECAST} more episodes at the present rate"),
        Some(1) => format!("{needs} about 1 more episode at the present rate"),
        Some(more) => {
            let all = rounded(more + known + judgement.without_result);
            let more = rounded(more);
            format!("{needs} about {more} more episodes at the present rate, {all} in all")
        }
    })
}

/// The number with two digits that count.
fn rounded(number: u64) -> u64 {
    let step = 10_u64.pow(number.checked_ilog10().unwrap_or_default().saturating_sub(1));
    (number + step / 2) / step * step
}

#[cfg(test)]
mod tests {
    use rtf_statistics::RandomStream;

    use super::*;
    use crate::EpisodeResult;
    use crate::file::StoppingRule;

    const RUNS: usize = 601;

    fn results(passed: usize, failed: usize) -> Vec<EpisodeResult> {
        let mut results = vec![EpisodeResult::Passed; passed + failed];
        // Failures are spread: at the start, they could decide at once.
        for at in 0..failed {
            results[(at + 1) * (passed + failed) / (failed + 1)] = EpisodeResult::Failed;
        }
        results
    }

    /// The median number of further episodes in simulated campaigns.
    fn simulated(judge: &Judge, start: &[EpisodeResult], rate: f64) -> u64 {
        let before = start.len() as u64;
        let mut numbers = Vec::new();
        for run in 0..RUNS {
            let mut random = RandomStream::new(run as u64, "forecast", "test");
            let mut passed = start.iter().filter(|it| **it == EpisodeResult::Passed).count() as u64;
            let more = (1_u64..).find(|more| {
                passed += u64::from(random.unit(*more) < rate);
                judge.decide_sequentially(passed, before + more).is_some()
            });
            numbers.extend(more);
        }
        numbers.sort_unstable();
        numbers[RUNS / 2]
    }

    #[test]
    fn the_forecast_of_a_sequential_rule_is_the_median_of_simulated_campaigns() {
        let sprt = StoppingRule::Sprt { low: 0.9, high: 0.97, alpha: 0.05, beta: 0.05 };
        let sequence = StoppingRule::ConfidenceSequence;
        for (rule, claim, passed, failed) in [
            (sprt, 0.95, 20, 1),
            (sprt, 0.95, 66, 5),
            (sprt, 0.95, 3, 2),
            (sequence, 0.9, 40, 2),
            (sequence, 0.95, 25, 3),
            (sequence, 0.5, 7, 2),
        ] {
            let judge = Judge::of(claim, Some(0.95), rule, 100_000).expect("valid");
            let start = results(passed, failed);
            let judgement = judge.judge(&start);
            let found = judge.more_episodes(&judgement).expect("a forecast");
            let rate = passed as f64 / (passed + failed) as f64;
            let median = simulated(&judge, &start, rate);
            let error = (found as f64 - median as f64).abs();
            assert!(error <= 2.0 + 0.1 * median as f64, "{rule:?}: {found}, simulated {median}");
        }
    }

    #[test]
    fn a_fixed_number_is_the_smallest_that_decides_at_the_rate() {
        let judge = Judge::of(0.9, Some(0.95), StoppingRule::Fixed, 100).expect("valid");
        let judgement = judge.judge(&results(94, 6));
        assert_eq!(judgement.verdict, Verdict::Undecided);
        let more = judge.more_episodes(&judgement).expect("a forecast");
        let decides = |more: u64| {
            let passed = 94 + (0.94 * more as f64).round() as u64;
            rtf_statistics::exact_rate(passed, 100 + more, 0.95).expect("a rate").low >= 0.9
        };
        assert!(decides(more) && !decides(more - 1), "{more}");
        // The planned ones have to run in any case.
        let judgement = judge.judge(&results(20, 0));
        assert_eq!(judge.more_episodes(&judgement), Some(80));
    }

    #[test]
    fn nothing_is_forecast_of_a_decided_claim_or_without_results_or_at_the_claimed_rate() {
        let judge = Judge::of(0.9, Some(0.95), StoppingRule::Fixed, 200).expect("valid");
        assert_eq!(judge.more_episodes(&judge.judge(&results(200, 0))), None);
        assert_eq!(judge.more_episodes(&judge.judge(&[])), None);
        assert_eq!(forecast_text(&judge, &judge.judge(&[])), None);
        let same = judge.judge(&results(180, 20));
        assert_eq!(judge.more_episodes(&same), None);
        let text = forecast_text(&judge, &same).expect("undecided");
        assert!(text.contains("more than 50000 more episodes"), "{text}");
    }

    #[test]
    fn numbers_in_texts_are_rounded() {
        let found = [0, 7, 42, 99, 104, 105, 2198, 2258, 49_999].map(rounded);
        assert_eq!(found, [0, 7, 42, 99, 100, 110, 2200, 2300, 50_000]);
    }

    #[test]
    fn episodes_without_a_result_have_to_be_outweighed() {
        let rule = StoppingRule::ConfidenceSequence;
        let judge = Judge::of(0.9, Some(0.95), rule, 100_000).expect("valid");
        let with = |without: usize| {
            let mut all = results(40, 1);
            all.extend(vec![EpisodeResult::None; without]);
            judge.more_episodes(&judge.judge(&all)).expect("a forecast")
        };
        assert!(with(3) > with(0), "{} and {}", with(3), with(0));
    }
}
