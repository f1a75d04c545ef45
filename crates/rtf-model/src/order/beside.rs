//! What may run beside what in a suite: tests as far as it is `parallel`, and
//! hooks beside nothing but tests that are judged.

/// What of a suite runs.
#[derive(Clone, Copy, Debug)]
struct Suite {
    parallel: u32,
    tests: u32,
    /// Those of them that are judged, and of which fixtures are told.
    judged: u32,
    hooks: u32,
}

/// What of each suite runs. A runner that dies leaves open what ran, and its
/// guard, or another run's part of a merged suite, goes on beside it. So a broken
/// rule is told only at the end of a stream in which no runner died.
#[derive(Clone, Debug, Default)]
pub(super) struct Beside {
    suites: Vec<Suite>,
    broken: Option<String>,
}

impl Beside {
    pub fn plan(&mut self, parallel: u32) {
        self.suites.push(Suite { parallel, tests: 0, judged: 0, hooks: 0 });
    }

    pub fn test(&mut self, suite: usize, starts: bool) {
        let Some(running) = self.suites.get_mut(suite) else { return };
        running.tests = turned(running.tests, starts);
        if starts && running.tests > running.parallel {
            let Suite { parallel, tests, .. } = *running;
            self.note(format!("{tests} tests of suite {suite} run at once, of {parallel} at most"));
        }
        self.no_hook_beside(suite);
    }

    /// A test is judged, or one that was is over.
    pub fn judged(&mut self, suite: usize, begins: bool) {
        if let Some(running) = self.suites.get_mut(suite) {
            running.judged = turned(running.judged, begins);
        }
    }

    pub fn hook(&mut self, suite: usize, starts: bool) {
        let Some(running) = self.suites.get_mut(suite) else { return };
        running.hooks = turned(running.hooks, starts);
        self.no_hook_beside(suite);
    }

    fn no_hook_beside(&mut self, suite: usize) {
        let Suite { tests, judged, hooks, .. } = self.suites[suite];
        if hooks > 0 && tests.saturating_sub(judged) + hooks > 1 {
            self.note(format!("a hook of suite {suite} runs beside a test or another hook"));
        }
    }

    fn note(&mut self, rule: String) {
        self.broken.get_or_insert(rule);
    }

    /// The first rule that was broken.
    pub fn broken(&self) -> Option<&String> {
        self.broken.as_ref()
    }
}

fn turned(count: u32, starts: bool) -> u32 {
    if starts { count + 1 } else { count.saturating_sub(1) }
}
