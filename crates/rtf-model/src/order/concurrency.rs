//! Concurrency within a suite: at most `parallel` tests at a time, and hooks only
//! next to tests that are already judged.

/// What currently runs in a suite.
#[derive(Clone, Copy, Debug)]
struct Running {
    parallel: u32,
    tests: u32,
    /// Those of them that are judged, and still notify their fixtures.
    judged: u32,
    hooks: u32,
}

/// What currently runs in each suite. A runner that dies leaves tests and hooks open, and
/// its guard, or another run's part of a merged suite, continues next to them. A violation
/// is therefore reported only at the end of a stream in which no runner died.
#[derive(Clone, Debug, Default)]
pub(super) struct Concurrency {
    suites: Vec<Running>,
    violation: Option<String>,
}

impl Concurrency {
    pub fn plan(&mut self, parallel: u32) {
        self.suites.push(Running { parallel, tests: 0, judged: 0, hooks: 0 });
    }

    pub fn test_running(&mut self, suite: usize, starts: bool) {
        let Some(running) = self.suites.get_mut(suite) else { return };
        running.tests = adjusted(running.tests, starts);
        if starts && running.tests > running.parallel {
            let Running { parallel, tests, .. } = *running;
            self.record(format!(
                "{tests} tests of suite {suite} run at the same time, at most {parallel} may"
            ));
        }
        self.check_hooks(suite);
    }

    /// A test is judged, or a judged test has finished.
    pub fn test_judged(&mut self, suite: usize, begins: bool) {
        if let Some(running) = self.suites.get_mut(suite) {
            running.judged = adjusted(running.judged, begins);
        }
    }

    pub fn hook_running(&mut self, suite: usize, starts: bool) {
        let Some(running) = self.suites.get_mut(suite) else { return };
        running.hooks = adjusted(running.hooks, starts);
        self.check_hooks(suite);
    }

    fn check_hooks(&mut self, suite: usize) {
        let Running { tests, judged, hooks, .. } = self.suites[suite];
        if hooks > 0 && tests.saturating_sub(judged) + hooks > 1 {
            self.record(format!("a hook of suite {suite} runs next to a test or another hook"));
        }
    }

    fn record(&mut self, rule: String) {
        self.violation.get_or_insert(rule);
    }

    /// The first violation.
    pub fn violation(&self) -> Option<&String> {
        self.violation.as_ref()
    }
}

fn adjusted(count: u32, starts: bool) -> u32 {
    if starts { count + 1 } else { count.saturating_sub(1) }
}
