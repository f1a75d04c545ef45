//! Number of cases by result.

use rtf_model::{Record, Verdict};

use super::TestCases;

/// Number of cases by result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct CaseTotals {
    pub total: u64,
    pub not_run: u64,
    counts: [u64; Verdict::ALL.len()],
}

impl TestCases<'_> {
    pub fn totals(&self) -> CaseTotals {
        let mut totals = CaseTotals::default();
        for result in &self.results {
            match result.verdict() {
                Some(verdict) => totals.counts[verdict as usize] += 1,
                None => totals.not_run += 1,
            }
        }
        totals.counts[Verdict::Passed as usize] += self.omitted;
        totals.total = self.results.len() as u64 + self.omitted;
        totals
    }
}

impl CaseTotals {
    pub fn of(&self, verdict: Verdict) -> u64 {
        self.counts[verdict as usize]
    }

    pub fn of_run(record: &Record) -> Self {
        let mut totals = Self::default();
        let cases = record.tests.iter().filter_map(TestCases::of);
        cases.for_each(|cases| totals += cases.totals());
        totals
    }

    /// `6 passed, 1 crashed, 33 did not run`; empty without cases.
    pub fn describe(&self) -> String {
        describe(|verdict| self.of(verdict), self.not_run)
    }
}

/// `6 passed, 1 crashed, 33 did not run`, without those that are 0.
pub(crate) fn describe(finished: impl Fn(Verdict) -> u64, not_run: u64) -> String {
    let by_verdict = Verdict::ALL.map(|verdict| (finished(verdict), verdict.as_str()));
    let counts = by_verdict.into_iter().chain([(not_run, "did not run")]);
    let counts = counts.filter(|(count, _)| *count > 0);
    counts.map(|(count, word)| format!("{count} {word}")).collect::<Vec<_>>().join(", ")
}

impl std::ops::AddAssign for CaseTotals {
    fn add_assign(&mut self, other: Self) {
        self.total += other.total;
        self.not_run += other.not_run;
        self.counts.iter_mut().zip(other.counts).for_each(|(count, other)| *count += other);
    }
}
