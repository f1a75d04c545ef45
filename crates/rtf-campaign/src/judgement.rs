//! Results of episodes → a verdict.

use rtf_statistics::{Accepted, ConfidenceSequence, Rate, Sprt, exact_rate};
use serde::{Deserialize, Serialize};

use crate::Campaign;
use crate::file::StoppingRule;

/// The result of an episode, after its repetitions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum EpisodeResult {
    /// The suite was green.
    Passed,
    /// A test failed, crashed or timed out.
    Failed,
    /// The bench's: only errors and collapses.
    None,
}

/// The verdict about a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Verdict {
    Passed,
    Failed,
    /// More episodes are necessary.
    Undecided,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Judgement {
    /// The verdict. With a fixed number of episodes, `undecided` until all have results.
    pub verdict: Verdict,
    /// Whether the campaign may end.
    pub is_final: bool,
    /// The number of episodes on which the verdict is based, from the first one on.
    pub episodes: usize,
    pub passed: u64,
    pub failed: u64,
    pub without_result: u64,
    /// The rate of passed episodes with its interval, from the case that all episodes without a
    /// result failed to the case that all passed. `None` if no episode has a result.
    pub rate: Option<Rate>,
}

#[derive(Clone, Copy, Debug)]
pub struct Judge {
    claimed: f64,
    planned: usize,
    rule: Rule,
}

#[derive(Clone, Copy, Debug)]
enum Rule {
    Fixed {
        confidence: f64,
    },
    Sequence(ConfidenceSequence),
    Sprt(Sprt, ConfidenceSequence),
    /// Versions are compared: there is no claim about the rate of all trials.
    Trials,
}

impl Judge {
    /// A judge for a campaign with a list of `planned` episodes. `None` if the claim or the
    /// stopping rule is invalid, which [`parse`](crate::parse) reports.
    #[must_use]
    pub fn new(campaign: &Campaign, planned: usize) -> Option<Self> {
        let Some(claim) = campaign.claim() else { return Some(Self::of_trials(planned)) };
        let confidence = claim.confidence.as_ref().map(|confidence| confidence.value);
        Self::of(claim.rate, confidence, campaign.stop, planned)
    }

    /// A judge that ends a campaign when all trials of versions have results: the comparison
    /// decides, not the rate of all trials.
    #[must_use]
    pub fn of_trials(planned: usize) -> Self {
        Self { claimed: 0.0, planned, rule: Rule::Trials }
    }

    #[must_use]
    pub fn of(
        claimed: f64,
        confidence: Option<f64>,
        stop: StoppingRule,
        planned: usize,
    ) -> Option<Self> {
        let rule = match stop {
            StoppingRule::Fixed => Rule::Fixed { confidence: confidence? },
            StoppingRule::ConfidenceSequence => {
                Rule::Sequence(ConfidenceSequence::new(confidence?)?)
            }
            StoppingRule::Sprt { low, high, alpha, beta } => {
                let sequence = ConfidenceSequence::new(1.0 - alpha)?;
                Rule::Sprt(Sprt::new(low, high, alpha, beta)?, sequence)
            }
        };
        Some(Self { claimed, planned, rule })
    }

    /// Judges the results of the first episodes, in the order of their ids. The judgement of
    /// more results is the same once it is final.
    #[must_use]
    pub fn judge(&self, results: &[EpisodeResult]) -> Judgement {
        let results = &results[..results.len().min(self.planned)];
        // Episodes without a result count in the worst way for each verdict.
        let (worst, best) = (self.decide(results, false), self.decide(results, true));
        let verdict = match (worst, best) {
            (Some((worst, _)), Some((best, _))) if worst == best => worst,
            _ => Verdict::Undecided,
        };
        let episodes = match (worst, best) {
            (Some((_, a)), Some((_, b))) if verdict != Verdict::Undecided => a.max(b),
            _ => results.len(),
        };
        let used = &results[..episodes];
        let count = |wanted| used.iter().filter(|result| **result == wanted).count() as u64;
        let (passed, failed) = (count(EpisodeResult::Passed), count(EpisodeResult::Failed));
        let without_result = count(EpisodeResult::None);
        Judgement {
            verdict,
            is_final: verdict != Verdict::Undecided || results.len() == self.planned,
            episodes,
            passed,
            failed,
            without_result,
            rate: self.rate(passed, failed, without_result),
        }
    }

    /// The first verdict, and after how many episodes, if those without a result passed or not.
    fn decide(&self, results: &[EpisodeResult], others_pass: bool) -> Option<(Verdict, usize)> {
        let is_pass = |result: &EpisodeResult| match result {
            EpisodeResult::Passed => true,
            EpisodeResult::Failed => false,
            EpisodeResult::None => others_pass,
        };
        if self.is_fixed() {
            let passed = results.iter().filter(|result| is_pass(result)).count() as u64;
            let is_complete = results.len() == self.planned;
            let verdict = self.decide_fixed(passed, results.len() as u64);
            return Some((verdict.filter(|_| is_complete)?, results.len()));
        }
        let (mut passed, mut episodes) = (0, 0);
        results.iter().find_map(|result| {
            passed += u64::from(is_pass(result));
            episodes += 1;
            let verdict = self.decide_sequentially(passed, episodes)?;
            usize::try_from(episodes).ok().map(|episodes| (verdict, episodes))
        })
    }

    /// Whether the number of episodes is fixed.
    pub(crate) fn is_fixed(&self) -> bool {
        matches!(self.rule, Rule::Fixed { .. } | Rule::Trials)
    }

    pub(crate) fn planned(&self) -> u64 {
        self.planned as u64
    }

    pub(crate) fn decide_fixed(&self, passed: u64, episodes: u64) -> Option<Verdict> {
        let Rule::Fixed { confidence } = self.rule else { return None };
        self.verdict_of(&exact_rate(passed, episodes, confidence)?)
    }

    pub(crate) fn decide_sequentially(&self, passed: u64, episodes: u64) -> Option<Verdict> {
        match &self.rule {
            Rule::Fixed { .. } | Rule::Trials => None,
            Rule::Sequence(sequence) => {
                if !sequence.excludes(self.claimed, passed, episodes) {
                    return None;
                }
                #[expect(clippy::cast_precision_loss, reason = "at most a million episodes")]
                let is_above = passed as f64 > self.claimed * episodes as f64;
                Some(if is_above { Verdict::Passed } else { Verdict::Failed })
            }
            Rule::Sprt(test, _) => {
                test.accepted(passed, episodes - passed).map(|accepted| match accepted {
                    Accepted::High => Verdict::Passed,
                    Accepted::Low => Verdict::Failed,
                })
            }
        }
    }

    fn verdict_of(&self, rate: &Rate) -> Option<Verdict> {
        if rate.low >= self.claimed {
            Some(Verdict::Passed)
        } else if rate.high < self.claimed {
            Some(Verdict::Failed)
        } else {
            None
        }
    }

    fn rate(&self, passed: u64, failed: u64, without_result: u64) -> Option<Rate> {
        let interval = |passed, trials| match &self.rule {
            Rule::Fixed { confidence } => exact_rate(passed, trials, *confidence),
            Rule::Sequence(sequence) | Rule::Sprt(_, sequence) => sequence.rate(passed, trials),
            Rule::Trials => None,
        };
        let known = passed + failed;
        let value = interval(passed, known)?.value;
        let low = interval(passed, known + without_result)?.low;
        let high = interval(passed + without_result, known + without_result)?.high;
        Some(Rate { value, low, high })
    }
}
