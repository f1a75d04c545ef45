//! Tests of a suite with episodes: each run has other episodes, and so other repetitions of the
//! same tests. In the merged run, the repetitions continue from one part to the next.

use std::collections::BTreeMap;

use rtf_model::{CaseFinished, CaseId, EventKind, Phase, TestFinished, TestId, Verdict};

/// The reason of tests, fixtures and hooks that the death of a runner left open.
pub(super) const DIED: &str = "the runner died";

/// The tests of a suite with episodes.
#[derive(Debug, Default)]
pub(super) struct EpisodeTests {
    tests: BTreeMap<TestId, EpisodeTest>,
}

#[derive(Debug, Default)]
struct EpisodeTest {
    /// The number of its repetitions in earlier parts.
    before: u32,
    /// The numbers of the last repetition and attempt.
    last: Option<(u32, u32)>,
    is_open: bool,
    /// Whether the last attempt announced another one.
    is_rerun: bool,
    /// The cases that have not finished.
    cases: Vec<CaseId>,
    /// Why it was skipped in the first part that did.
    skipped: Option<String>,
}

impl EpisodeTests {
    /// Numbers repetitions in the merged run; false for an event that [`Self::ends`] replaces.
    pub fn follow(&mut self, kind: &mut EventKind) -> bool {
        match kind {
            EventKind::TestStarted { test, repetition, attempt } => {
                self.state(*test).start(repetition, *attempt);
            }
            EventKind::CaseStarted(started) => {
                self.state(started.test).cases.push(started.start.case);
            }
            EventKind::CaseFinished(end) => {
                self.state(end.test).cases.retain(|case| *case != end.case);
            }
            EventKind::TestFinished(finished) => {
                let test = self.state(finished.test);
                (test.is_open, test.is_rerun) = (false, finished.rerun);
            }
            EventKind::TestSkipped { test, reason } => {
                self.state(*test).skipped.get_or_insert_with(|| std::mem::take(reason));
                return false;
            }
            EventKind::TestRepeated { .. } => return false,
            _ => {}
        }
        true
    }

    fn state(&mut self, test: TestId) -> &mut EpisodeTest {
        self.tests.entry(test).or_default()
    }

    /// The ends of attempts that a runner that died left open. The next part follows.
    pub fn end_part(&mut self) -> Vec<EventKind> {
        self.tests.iter_mut().flat_map(|(test, state)| state.end_part(*test)).collect()
    }

    /// The ends of all tests, after the last part.
    pub fn ends(self) -> impl Iterator<Item = EventKind> {
        self.tests.into_iter().map(|(test, state)| match state.last {
            Some((repetitions, _)) if !state.is_rerun => {
                EventKind::TestRepeated { test, repetitions }
            }
            _ => EventKind::TestSkipped { test, reason: state.skipped.unwrap_or_default() },
        })
    }
}

impl EpisodeTest {
    fn start(&mut self, repetition: &mut u32, attempt: u32) {
        *repetition += self.before;
        self.last = Some((*repetition, attempt));
        self.is_open = true;
        self.cases.clear();
    }

    fn end_part(&mut self, test: TestId) -> Vec<EventKind> {
        let mut events = Vec::new();
        if let (true, false, Some((repetition, last))) = (self.is_rerun, self.is_open, self.last) {
            let attempt = last + 1;
            events.push(EventKind::TestStarted { test, repetition, attempt });
            self.last = Some((repetition, attempt));
            self.is_open = true;
        }
        if self.is_open {
            let cases = self.cases.drain(..).rev();
            events.extend(cases.map(|case| interrupted_case(test, case)));
            events.push(interrupted(test));
        }
        (self.is_open, self.is_rerun) = (false, false);
        self.before = self.last.map_or(0, |(repetition, _)| repetition);
        events
    }
}

fn interrupted_case(test: TestId, case: CaseId) -> EventKind {
    EventKind::CaseFinished(CaseFinished {
        test,
        case,
        verdict: Verdict::Interrupted,
        reason: Some(DIED.to_owned()),
        decided_by: None,
        duration_us: None,
        carried: false,
        rerun: false,
        episode: None,
    })
}

fn interrupted(test: TestId) -> EventKind {
    EventKind::TestFinished(TestFinished {
        test,
        verdict: Verdict::Interrupted,
        reason: Some(DIED.to_owned()),
        phase: Phase::Run,
        decided_by: None,
        exit: None,
        rerun: false,
    })
}
