//! How many tests may fail before the rest of the run is skipped, and which one suffices.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, OnceLock};

use rtf_model::{TestFinished, TestId, Verdict};

/// Counts tests that did not pass, over all suites of a run: each suite has a
/// clone, and all of them count together.
#[derive(Clone, Debug, Default)]
pub struct FailLimit {
    /// The number at which it is enough; none is never enough.
    most: Option<u32>,
    /// How many were counted by any clone.
    seen: Arc<AtomicU32>,
    /// What happened in some suite after which none goes on.
    stopped: Arc<OnceLock<String>>,
    /// The tests that this suite has counted: each is counted once.
    counted: BTreeSet<TestId>,
}

impl FailLimit {
    /// A limit at which nothing was counted yet.
    #[must_use]
    pub fn new(most: Option<u32>) -> Self {
        Self { most, ..Self::default() }
    }

    /// Takes the end of an attempt in.
    pub fn count(&mut self, finished: &TestFinished) {
        let says_nothing = matches!(finished.verdict, Verdict::Skipped | Verdict::Interrupted);
        if finished.verdict.is_green() || finished.rerun || says_nothing {
            return;
        }
        if self.counted.insert(finished.test) {
            self.seen.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// No suite goes on after this; the first reason counts.
    pub fn stop(&self, reason: String) {
        let _ = self.stopped.set(reason);
    }

    /// Why nothing more is run, once it is enough.
    #[must_use]
    pub fn reached(&self) -> Option<String> {
        if let Some(reason) = self.stopped.get() {
            return Some(reason.clone());
        }
        let most = self.most.filter(|most| self.seen.load(Ordering::Relaxed) >= *most)?;
        let tests = if most == 1 { "1 test has".to_owned() } else { format!("{most} tests have") };
        Some(format!("{tests} not passed (--max-fail {most})"))
    }
}
