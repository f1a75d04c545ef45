//! A test that would pass waits until all fixtures were seen to live after its end.
//! Of one that is dying, every test waits for the end, which is a collapse.

use std::collections::BTreeMap;

use rtf_model::TestId;

use super::{Context, SuiteMachine};
use crate::run::machine::io::{Effect, HostId};
use crate::run::machine::test::TestRun;

/// How often each fixture's process was looked at, and was seen to live. Answers
/// come in the order of the questions: a test that ended later than another one
/// is not taken in by the answer to an earlier question.
#[derive(Debug, Default)]
pub(super) struct Looks {
    asked: BTreeMap<HostId, u64>,
    seen: BTreeMap<HostId, u64>,
    /// What each test that is about to pass waits for.
    waiting: Vec<(TestId, Vec<(HostId, u64)>)>,
}

impl Looks {
    fn begin(&mut self, test: TestId, hosts: Vec<HostId>) {
        let mut needs = Vec::with_capacity(hosts.len());
        for host in hosts {
            let asked = self.asked.entry(host).or_default();
            *asked += 1;
            needs.push((host, *asked));
        }
        self.waiting.push((test, needs));
    }

    /// The tests for which all fixtures were seen.
    fn take_done(&mut self) -> Vec<TestId> {
        let Self { seen, waiting, .. } = self;
        let is_seen = |(host, number): &(HostId, u64)| seen.get(host) >= Some(number);
        let done = waiting.extract_if(.., |(_, needs)| needs.iter().all(is_seen));
        done.map(|(test, _)| test).collect()
    }
}

impl SuiteMachine<'_> {
    /// A test is about to be judged. A fixture that died before is told later, since
    /// what it left is swept first: so each of them is looked at.
    pub(super) fn look_alive(&mut self, test: TestId, cx: &mut Context<'_>) {
        let run = self.turns.of_test(test).and_then(|turn| turn.run.as_ref());
        let known = self.looks.waiting.iter().any(|(waiting, _)| *waiting == test);
        if run.is_some_and(TestRun::is_looking) && !known {
            let hosts = self.fixtures.processes();
            hosts.iter().for_each(|host| cx.out(Effect::LookAlive(*host)));
            self.looks.begin(test, hosts);
            self.pass_seen();
        }
    }

    pub(super) fn seen_alive(&mut self, host: HostId) {
        *self.looks.seen.entry(host).or_default() += 1;
        self.pass_seen();
    }

    /// Its end may take a while: a memory image is written, or a descendant holds
    /// its outputs open.
    pub(super) fn seen_dying(&mut self, host: HostId, cx: &mut Context<'_>) {
        let waits = |needs: &[(HostId, u64)]| needs.iter().any(|(needed, _)| *needed == host);
        let tests = self.looks.waiting.iter().filter(|(_, needs)| waits(needs));
        for (test, _) in tests {
            let run = self.turns.of_test(*test).and_then(|turn| turn.run.as_mut());
            run.into_iter().for_each(|run| run.seen_dying(cx));
        }
    }

    fn pass_seen(&mut self) {
        for test in self.looks.take_done() {
            let run = self.turns.of_test(test).and_then(|turn| turn.run.as_mut());
            run.into_iter().for_each(TestRun::seen_alive);
        }
    }

    /// An attempt is over: nothing is looked at for it any more.
    pub(super) fn look_away(&mut self, test: TestId) {
        self.looks.waiting.retain(|(waiting, _)| *waiting != test);
    }
}
