//! What passed only after a retry: tests, and cases that their framework ran again.

use rtf_model::{Record, TestRecord, Verdict};

use crate::cases::TestCases;

/// A test or a case that passed only after a retry.
#[derive(Debug)]
pub(crate) struct Retried<'r> {
    /// Its full name.
    pub name: String,
    pub attempts: u64,
    /// The verdicts and reasons of the attempts that did not pass.
    pub before: Vec<(Verdict, &'r str)>,
}

impl<'r> Retried<'r> {
    /// Those of a flaky test: itself, if the runner retried it, and its cases.
    pub fn of(record: &Record, test: &'r TestRecord) -> Vec<Self> {
        let name = record.full_name(test.plan.test);
        let finished = test.attempts.iter().filter_map(|attempt| attempt.finished.as_ref());
        let failed = finished.filter(|(_, finished)| !finished.verdict.is_green());
        let reason = |reason: &'r Option<String>| reason.as_deref().unwrap_or_default();
        let before: Vec<_> =
            failed.map(|(_, finished)| (finished.verdict, reason(&finished.reason))).collect();
        let mut retried = Vec::new();
        let cases = TestCases::of(test);
        for case in cases.iter().flat_map(|cases| &cases.results) {
            let flaky = case.record.filter(|case| case.is_flaky());
            let (Some(flaky), Some(cases)) = (flaky, &cases) else { continue };
            let before = cases.earlier_attempts(case).into_iter().filter_map(|attempt| {
                let record = attempt.record?;
                Some((record.verdict()?, record.reason().unwrap_or_default()))
            });
            retried.push(Self {
                name: format!("{name}/{}", case.path),
                attempts: u64::from(flaky.start.earlier_attempts) + 1,
                before: before.filter(|(verdict, _)| !verdict.is_green()).collect(),
            });
        }
        if !before.is_empty() || retried.is_empty() {
            retried.insert(0, Self { name, attempts: test.attempts.len() as u64, before });
        }
        retried
    }
}
