//! The host of a test: a new one, or one that has served other tests.

use rtf_model::Source;
use rtf_model::protocol::{Plugin, Request};

use super::{Process, RUN_TEST, TestRun};
use crate::run::machine::io::{Deadline, Effect, HostId, TestTimer};
use crate::run::machine::suite::Context;
use rtf_plan::plan::{SuitePlan, TestPlan};

impl TestRun<'_> {
    /// Whether its host can be asked for a further test.
    pub fn shares(&self) -> bool {
        self.shares && self.process == Process::Alive && self.evidence.stopped.is_none()
    }

    /// Whether its host has outlived it, and still lives.
    pub fn is_released(&self) -> bool {
        self.released
    }

    /// Its host has ended after it, while the test is still looked at.
    pub fn lose_host(&mut self) {
        self.released = false;
    }

    /// The host that it joined has ended without it: it gets one of its own.
    pub fn begin_anew(&mut self, suite: &SuitePlan, wanted: (u32, bool), cx: &mut Context<'_>) {
        if self.evidence.stopped.is_some() {
            self.process = Process::Over;
            return;
        }
        self.host = spawn(suite, self.plan, wanted, cx);
        (self.request, self.shares) = (RUN_TEST, false);
        cx.set(Deadline::Test(self.plan.id, TestTimer::Limit), self.plan.limits.load);
    }
}

/// Starts a host for a test, this repetition of it; whether it is the last one
/// that the host gets.
pub(super) fn spawn(
    suite: &SuitePlan,
    plan: &TestPlan,
    wanted: (u32, bool),
    cx: &mut Context<'_>,
) -> HostId {
    let (host, source) = (cx.new_host(), Source::Test(plan.id));
    cx.out(Effect::Spawn { host, source, start: TestRun::host_start(suite, plan) });
    let request = Request::RunTest(plugin(suite, plan, wanted));
    cx.out(Effect::Send(host, Some(RUN_TEST), request));
    host
}

/// Asks a host for a test, in which it begins when it has done with the present
/// one; its id from then on.
pub fn ask(
    suite: &SuitePlan,
    plan: &TestPlan,
    wanted: (u32, bool),
    on: HostId,
    cx: &mut Context<'_>,
) -> HostId {
    let (host, source) = (cx.new_host(), Source::Test(plan.id));
    let (request, plugin) = (request_of(host), plugin(suite, plan, wanted));
    cx.out(Effect::Join { host, on, source, request, plugin });
    host
}

/// The number of the request for a test that joins a host.
pub(super) fn request_of(host: HostId) -> u64 {
    RUN_TEST + host.0
}

fn plugin(suite: &SuitePlan, plan: &TestPlan, (repetition, last): (u32, bool)) -> Plugin {
    Plugin {
        file: plan.plugin.file.to_string_lossy().into_owned(),
        name: plan.name.clone(),
        param: plan.plugin.param.clone(),
        args: plan.plugin.args.clone(),
        environment: suite.environment.clone(),
        repetition,
        is_last: last,
        // The mark is known to the task around the process.
        end_marker: plan.shared.then(String::new),
        attachments_dir: None,
    }
}
