//! The host of a test: a new one, or one that has served other tests.

use std::time::Duration;

use rtf_model::Source;
use rtf_model::protocol::{Plugin, Request};

use super::{AttemptState, CarriedCases, TestRun};
use crate::fixture_values::FixtureValues;
use crate::plugin_request::plugin;
use crate::run::machine::context::Context;
use crate::run::machine::io::{Effect, HostId, Program, StartRequest, environment};
use rtf_plan::plan::{SuitePlan, TestPlan};

/// The number of the first `run-test` on a host's channel.
const RUN_TEST: u64 = 2;

#[derive(Clone, Copy, Debug)]
pub enum HostChoice {
    New,
    /// An idle shared host.
    Idle(HostId),
    /// A shared host to which the test was assigned before.
    Assigned(HostId),
}

#[derive(Clone, Copy, Debug)]
pub struct TestRequest<'a> {
    pub repetition: u32,
    /// Whether the host will get no further test.
    pub is_last: bool,
    /// The cases that it does not run again after a collapse.
    pub carried: Option<&'a CarriedCases>,
}

impl TestRun<'_> {
    /// Whether its host can be assigned a further test.
    pub fn can_share_host(&self) -> bool {
        self.shares_host && !self.has_exited() && self.evidence.stopped.is_none()
    }

    /// Whether its host outlived it and is still alive.
    pub fn is_released(&self) -> bool {
        self.is_released
    }

    /// The host that outlived it has ended before its verdict.
    pub fn on_released_host_exit(&mut self) {
        self.is_released = false;
    }

    /// Starts it in a new host: the assigned one ended before the test began.
    pub fn restart_in_new_host(
        &mut self,
        suite: &SuitePlan,
        request: TestRequest<'_>,
        cx: &mut Context<'_>,
    ) {
        if self.evidence.stopped.is_some() {
            self.state = AttemptState::Ended;
            return;
        }
        self.host = spawn(suite, self.plan, request, cx);
        (self.request, self.shares_host) = (RUN_TEST, false);
        self.set_limit(self.plan.limits.load, cx);
    }
}

/// Gets the chosen host; returns it and the number of the test's request.
pub(super) fn acquire(
    suite: &SuitePlan,
    plan: &TestPlan,
    (choice, request): (HostChoice, TestRequest<'_>),
    cx: &mut Context<'_>,
) -> (HostId, u64) {
    let host = match choice {
        HostChoice::New => return (spawn(suite, plan, request, cx), RUN_TEST),
        HostChoice::Idle(idle) => assign(suite, plan, request, idle, cx),
        HostChoice::Assigned(host) => host,
    };
    (host, request_number(host))
}

fn spawn(
    suite: &SuitePlan,
    plan: &TestPlan,
    request: TestRequest<'_>,
    cx: &mut Context<'_>,
) -> HostId {
    let (host, source) = (cx.next_host_id(), Source::Test(plan.id));
    cx.push(Effect::Spawn { host, source, start: host_start(suite, plan, cx.values()) });
    let request = Request::RunTest(plugin_of(suite, plan, request, cx.values()));
    cx.send(host, Some(RUN_TEST), request);
    host
}

/// Assigns a test to a host, which begins it after the present one; returns the host's
/// id from then on.
pub fn assign(
    suite: &SuitePlan,
    plan: &TestPlan,
    request: TestRequest<'_>,
    on: HostId,
    cx: &mut Context<'_>,
) -> HostId {
    let (host, source) = (cx.next_host_id(), Source::Test(plan.id));
    let plugin = Box::new(plugin_of(suite, plan, request, cx.values()));
    let request = request_number(host);
    cx.push(Effect::Join { host, on, source, request, plugin });
    host
}

/// How the host of a test is started.
pub fn host_start(suite: &SuitePlan, plan: &TestPlan, values: &FixtureValues) -> StartRequest {
    StartRequest {
        what: Program::Host(values.in_host(&plan.plugin.host)),
        env: environment(suite, &plan.env, ("test", &plan.name), values),
        folder: suite.folder.clone(),
    }
}

fn request_number(host: HostId) -> u64 {
    RUN_TEST + host.0
}

fn plugin_of(
    suite: &SuitePlan,
    plan: &TestPlan,
    request: TestRequest<'_>,
    values: &FixtureValues,
) -> Plugin {
    let programs = plan.cases_in_programs.as_deref();
    let mut plugin = Plugin {
        is_last: request.is_last,
        // The task of the process fills in the marker.
        end_marker: plan.settings.shared.then(String::new),
        parameters: plan.parameters().to_vec(),
        episodes: plan.slots,
        cases: match request.carried {
            Some(carried) => carried.selectors(),
            None => plan.cases.as_ref().map(|cases| cases.selectors.clone()).unwrap_or_default(),
        },
        case_timeout_ms: programs.and_then(|programs| programs.case_timeout).map(milliseconds),
        separate_cases: programs.is_some_and(|programs| programs.separate),
        fork_at_main: programs.is_some_and(|programs| programs.fork_at_main),
        ..plugin(suite, &plan.name, &plan.plugin, request.repetition)
    };
    if plan.settings.shared && values.has_episode() {
        let env = suite.env.iter().chain(&plan.env).chain(&plan.plugin.host.env);
        plugin.variables = values.variables_of_episode(env);
        plugin.continues_after_failure = true;
    }
    values.extend_request(&mut plugin);
    plugin
}

/// A limit, which is not zero.
fn milliseconds(limit: Duration) -> u64 {
    u64::try_from(limit.as_millis()).unwrap_or(u64::MAX).max(1)
}
