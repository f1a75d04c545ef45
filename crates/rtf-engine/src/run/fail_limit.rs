//! Decides when failed tests end the run.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};

use rtf_model::{TestFinished, TestId, Verdict};

/// Counts the tests that did not pass. Each suite has a clone; all clones share the counter.
#[derive(Clone, Debug, Default)]
pub struct FailLimit {
    /// The limit; `None` for no limit.
    limit: Option<u32>,
    /// The number counted by all clones.
    failed: Arc<AtomicU32>,
    /// The reason why no suite continues.
    stopped: Arc<OnceLock<String>>,
    /// The tests that this clone has counted: each counts once.
    counted: BTreeSet<TestId>,
}

impl FailLimit {
    #[must_use]
    pub fn new(limit: Option<u32>) -> Self {
        Self { limit, ..Self::default() }
    }

    pub fn count(&mut self, finished: &TestFinished) {
        let did_not_run = matches!(finished.verdict, Verdict::Skipped | Verdict::Interrupted);
        if finished.verdict.is_green() || finished.rerun || did_not_run {
            return;
        }
        if self.counted.insert(finished.test) {
            self.failed.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// Ends all suites. The first reason is reported.
    pub fn stop(&self, reason: String) {
        let _ = self.stopped.set(reason);
    }

    /// Returns why nothing more runs, once the limit is reached.
    #[must_use]
    pub fn reached(&self) -> Option<String> {
        if let Some(reason) = self.stopped.get() {
            return Some(reason.clone());
        }
        let limit = self.limit.filter(|limit| self.failed.load(Ordering::Relaxed) >= *limit)?;
        let tests =
            if limit == 1 { "1 test has".to_owned() } else { format!("{limit} tests have") };
        Some(format!("{tests} not passed (--max-fail {limit})"))
    }
}
