//! Starts what is due after each input, in this order:
//!
//! 1. Running tests continue. With `parallel`, further tests start if nothing else has
//!    to come first.
//! 2. A triggered hook runs; nothing else starts. Tests that have their verdict do not
//!    delay it, even if fixtures are still being notified.
//! 3. If the suite ends early (stop request, broken fixture, critical failure, limit) or
//!    has no test left: `end` hooks, tear-down in reverse, the rest is skipped.
//! 4. Failed fixtures and their dependents are torn down; between episodes, also those that are
//!    not reset.
//! 5. Stopped fixtures are set up, others reset for the next episode.
//! 6. Plug-in fixtures execute `check`, subscribed fixtures are notified of the next
//!    tests, and the tests start.

use rtf_model::{EventKind, Trigger};

use super::SuiteMachine;
use crate::run::machine::context::Context;
use crate::run::machine::io::{Deadline, Effect};

impl SuiteMachine<'_> {
    pub(super) fn advance(&mut self, cx: &mut Context<'_>) {
        if !self.is_started || self.is_finished {
            return;
        }
        if self.scheduler.any_without_verdict() {
            return self.start_more_tests(cx);
        }
        if self.scheduler.any_running() {
            return self.run_hooks_or_more_tests(cx);
        }
        // Tests of other suites may have reached the limit.
        if let Some(reason) = self.fails.reached() {
            self.end_early(reason);
        }
        if self.hooks.run_next(cx) {
            self.is_checked = false;
            return;
        }
        if self.end_reason.is_none() {
            self.scheduler.begin_round(cx.now());
            if self.scheduler.is_done() && self.episodes.any_round_left() && !self.next_episode(cx)
            {
                return;
            }
        }
        if self.end_reason.is_some() || self.scheduler.is_done() {
            return self.finish(cx);
        }
        if !self.fixtures.stop_due(cx) {
            return;
        }
        if self.fixtures.start_next(cx) {
            self.is_checked = false;
            self.scheduler.forget_notifications();
        } else if self.fixtures.all_ready() {
            self.check_then_start(cx);
        }
    }

    /// Fixtures are being notified of tests that have their verdict. Hooks do not wait.
    fn run_hooks_or_more_tests(&mut self, cx: &mut Context<'_>) {
        let runs_hook =
            self.hooks.run_next(cx) || (self.end_reason.is_some() && self.run_end_hooks(cx));
        if runs_hook {
            self.is_checked = false;
        } else {
            self.start_more_tests(cx);
        }
    }

    /// Starts further tests in addition to the running ones, unless a hook, a collapsed
    /// fixture or the end of the suite waits for these.
    fn start_more_tests(&mut self, cx: &mut Context<'_>) {
        if self.end_reason.is_some() || self.hooks.any() || !self.fixtures.all_ready() {
            return;
        }
        match self.fails.reached() {
            Some(reason) if self.scheduler.any_due() => self.end_early(reason),
            _ => self.check_then_start(cx),
        }
    }

    fn check_then_start(&mut self, cx: &mut Context<'_>) {
        if !self.scheduler.any_due() {
            return;
        }
        if !self.is_checked {
            self.is_checked = true;
            self.fixtures.request_checks(cx);
        }
        if self.fixtures.any_check_pending() || !self.notify_then_start(cx) {
            return;
        }
        // The check also holds for tests that wait until fixtures are notified.
        self.is_checked = self.scheduler.any_awaiting_notification();
        self.hooks.on_test_start();
        cx.push(Effect::SpawnAhead(self.scheduler.hosts_ahead(cx.values())));
    }

    /// Triggers the `end` hooks, once; true if one of them runs now.
    fn run_end_hooks(&mut self, cx: &mut Context<'_>) -> bool {
        if std::mem::replace(&mut self.is_ending, true) {
            return false;
        }
        if self.fixtures.any_started() || self.scheduler.any_begun() {
            self.hooks.trigger(Trigger::End, "the suite ends", None);
        }
        self.hooks.run_next(cx)
    }

    fn finish(&mut self, cx: &mut Context<'_>) {
        if self.run_end_hooks(cx) {
            return;
        }
        self.fixtures.stop_all(cx);
        if !self.fixtures.all_stopped() || !self.scheduler.stop_shared_host(cx) {
            return;
        }
        self.finish_episode(cx);
        self.report_unfinished_tests(cx);
        self.is_finished = true;
        cx.clear(Deadline::Suite);
        cx.clear(Deadline::Shutdown);
        cx.emit(EventKind::SuiteFinished { suite: self.plan.id });
        cx.push(Effect::Done);
    }
}
