//! How often a test's result changes although its code does not: flaky tests.

use std::collections::HashMap;

use rtf_model::Verdict;
use serde::Serialize;
use utoipa::ToSchema;

use rtf_statistics::{CONFIDENCE, Rate, rate};

/// One judged attempt of a test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Attempt<'a> {
    /// The commit that was tested, or the run. `None` if it is unknown.
    pub commit: Option<&'a str>,
    /// The sources of the test. `None` if they are unknown. An attempt without commit and sources
    /// counts in the rates, but is not compared.
    pub sources: Option<&'a str>,
    /// How the attempt was judged.
    pub verdict: Verdict,
}

/// What an attempt shows about the test.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Outcome {
    /// `passed`.
    Passed,
    /// `failed`, `crashed` or `timed-out`: the test ran and did not hold.
    Failed,
    /// `error` or `collapsed`: the bench prevented a result.
    Bench,
}

impl Outcome {
    /// `None` for `skipped` and `interrupted`, which show nothing.
    #[must_use]
    pub fn of(verdict: Verdict) -> Option<Self> {
        match verdict {
            Verdict::Passed => Some(Self::Passed),
            Verdict::Failed | Verdict::Crashed | Verdict::TimedOut => Some(Self::Failed),
            Verdict::Error | Verdict::Collapsed => Some(Self::Bench),
            Verdict::Skipped | Verdict::Interrupted => None,
        }
    }
}

/// The results of a test over several attempts. All intervals have a confidence of 95 %.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, ToSchema)]
pub struct Flips {
    /// Attempts that passed.
    pub passed: u64,
    /// Attempts that failed, crashed or timed out.
    pub failed: u64,
    /// Attempts without a result because the bench was wrong.
    pub bench: u64,
    /// Attempts that were skipped or interrupted. They count nowhere else.
    pub without_outcome: u64,
    /// Consecutive results of one commit, of one run or of equal sources, of which one passed and
    /// one failed.
    pub flips: u64,
    /// Consecutive results of one commit, of one run or of equal sources, equal or not.
    pub pairs: u64,
    /// Those of `pairs` that are comparable only because their sources are equal.
    #[serde(skip_serializing_if = "crate::is_zero")]
    pub pairs_by_sources: u64,
    /// `passed` of `passed + failed`. `None` without a result.
    pub pass_rate: Option<Rate>,
    /// `flips` of `pairs`. `None` if no two results are comparable.
    pub flip_rate: Option<Rate>,
    /// `bench` of `passed + failed + bench`. `None` without an attempt.
    pub bench_rate: Option<Rate>,
}

impl Flips {
    /// Counts the attempts of one test, which are in the order of their time.
    ///
    /// A result is compared with the previous one of the same commit or with the same sources, also
    /// if others were tested or the bench was wrong in between. Time: O(n).
    #[must_use]
    pub fn count(attempts: &[Attempt<'_>]) -> Self {
        let mut counts = Self::default();
        let (mut of_commits, mut of_sources) = (HashMap::new(), HashMap::new());
        for (position, attempt) in attempts.iter().enumerate() {
            let outcome = Outcome::of(attempt.verdict);
            match outcome {
                Some(Outcome::Passed) => counts.passed += 1,
                Some(Outcome::Failed) => counts.failed += 1,
                Some(Outcome::Bench) => counts.bench += 1,
                None => counts.without_outcome += 1,
            }
            let result = outcome.filter(|outcome| *outcome != Outcome::Bench);
            let Some(result) = result else { continue };
            let found = (position, result);
            let of_commit = attempt.commit.and_then(|commit| of_commits.insert(commit, found));
            let of_source = attempt.sources.and_then(|sources| of_sources.insert(sources, found));
            if let Some((position, before)) =
                [of_commit, of_source].into_iter().flatten().max_by_key(|it| it.0)
            {
                counts.pairs += 1;
                counts.flips += u64::from(before != result);
                let is_by_commit = of_commit.is_some_and(|(other, _)| other == position);
                counts.pairs_by_sources += u64::from(!is_by_commit);
            }
        }
        let results = counts.passed + counts.failed;
        counts.pass_rate = rate(counts.passed, results, CONFIDENCE);
        counts.flip_rate = rate(counts.flips, counts.pairs, CONFIDENCE);
        counts.bench_rate = rate(counts.bench, results + counts.bench, CONFIDENCE);
        counts
    }

    /// Whether the test passed and failed on the same commit, or in one run.
    #[must_use]
    pub fn is_flaky(&self) -> bool {
        self.flips > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// `a+ a- b!`: commit and result; `?` without a commit. Upper-case letters are sources.
    fn count(attempts: &str) -> Flips {
        let attempts: Vec<Attempt<'_>> = attempts
            .split_whitespace()
            .map(|word| {
                let (commit, result) = word.split_at(1);
                let verdict = match result {
                    "+" => Verdict::Passed,
                    "-" => Verdict::Failed,
                    "x" => Verdict::Crashed,
                    "t" => Verdict::TimedOut,
                    "e" => Verdict::Error,
                    "c" => Verdict::Collapsed,
                    "s" => Verdict::Skipped,
                    "i" => Verdict::Interrupted,
                    other => panic!("unknown result `{other}`"),
                };
                let is_source = commit.starts_with(|c: char| c.is_ascii_uppercase());
                let key = (commit != "?").then_some(commit);
                let (commit, sources) = if is_source { (None, key) } else { (key, None) };
                Attempt { commit, sources, verdict }
            })
            .collect();
        Flips::count(&attempts)
    }

    #[test]
    fn results_of_one_commit_are_compared() {
        let found = count("a+ a- a- a+");
        assert_eq!((found.flips, found.pairs), (2, 3));
        assert!(found.is_flaky());
    }

    #[test]
    fn regression_is_no_flip() {
        let found = count("a+ b+ c- d- e-");
        assert_eq!((found.flips, found.pairs, found.failed), (0, 0, 3));
        assert!(!found.is_flaky() && found.flip_rate.is_none());
    }

    #[test]
    fn commits_of_two_branches_alternate() {
        let found = count("a+ b- a+ b- a+ b-");
        assert_eq!((found.flips, found.pairs), (0, 4));
    }

    #[test]
    fn bench_failures_are_no_flips() {
        let found = count("a+ ae a+ ac a+ as ai");
        assert_eq!((found.flips, found.pairs), (0, 2));
        assert_eq!((found.passed, found.failed, found.bench), (3, 0, 2));
        assert_eq!(found.without_outcome, 2);
        assert_eq!(found.pass_rate.map(|rate| rate.value), Some(1.0));
        assert_eq!(found.bench_rate.map(|rate| rate.value), Some(0.4));
    }

    #[test]
    fn crashes_and_time_outs_are_failures() {
        assert_eq!(count("a+ ax at a+").flips, 2);
    }

    #[test]
    fn unknown_commits_are_not_compared() {
        let found = count("?+ ?- ?+");
        assert_eq!((found.flips, found.pairs, found.passed), (0, 0, 2));
    }

    #[test]
    fn equal_sources_are_compared() {
        let found = count("A+ B- A- ?+ A- A+");
        assert_eq!((found.flips, found.pairs, found.pairs_by_sources), (2, 3, 3));
    }

    #[test]
    fn a_result_is_compared_with_the_last_comparable_one() {
        let of = |commit, sources, verdict| Attempt { commit, sources, verdict };
        let found = Flips::count(&[
            of(Some("a"), Some("s"), Verdict::Passed),
            of(Some("a"), Some("t"), Verdict::Failed),
            // The last one of its commit has other sources, and is later than that of its sources.
            of(Some("a"), Some("s"), Verdict::Failed),
            of(None, Some("t"), Verdict::Failed),
            of(None, Some("s"), Verdict::Passed),
        ]);
        assert_eq!((found.flips, found.pairs, found.pairs_by_sources), (2, 4, 2));
    }

    #[test]
    fn no_attempts_have_no_rates() {
        assert_eq!(Flips::count(&[]), Flips::default());
    }

    proptest! {
        #[test]
        fn counts_add_up(results in prop::collection::vec((0_usize..3, 0_usize..8), 0..60)) {
            let commits = ["a", "b", "c"];
            let attempts: Vec<Attempt<'_>> = results
                .iter()
                .map(|(commit, verdict)| Attempt {
                    commit: Some(commits[*commit]),
                    sources: None,
                    verdict: Verdict::ALL[*verdict],
                })
                .collect();
            let found = Flips::count(&attempts);
            let sum = found.passed + found.failed + found.bench + found.without_outcome;
            prop_assert_eq!(sum, attempts.len() as u64);
            prop_assert!(found.flips <= found.pairs);
            prop_assert!(found.pairs <= (found.passed + found.failed).saturating_sub(1));
            // Each flip takes a failure, and a failure takes part in two flips at most.
            prop_assert!(found.flips <= 2 * found.failed.min(found.passed));
        }
    }
}
