//! A phase of a test is measured in simulated time: how far its clock went, and
//! what is said when a limit was reached.
//!
//! The machine is told what the clock shows; `run/clock.rs` reads it.

use std::time::Duration;

use rtf_model::{EventKind, Phase, StopCause};

use super::TestRun;
use crate::run::machine::io::{Deadline, TestTimer};
use crate::run::machine::suite::Context;

/// The measure of a phase, from its begin on.
#[derive(Debug)]
pub struct Stopwatch {
    limit: Duration,
    /// The limit in wall time.
    backstop: Duration,
    /// From which on the test counts as slow, until that was told.
    slow: Option<Duration>,
    /// When the phase began, in wall time.
    began: Duration,
    /// What the clock showed last, and since when.
    shown: Option<(Duration, Duration)>,
    /// How far it went. What it jumped back is no time.
    passed: Duration,
    /// What passes now does not count: the test waits for the runner.
    is_paused: bool,
}

/// What a look at the clock means for the test.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Passed {
    /// Nothing yet.
    Within,
    /// It counts as slow from now on.
    Slow,
    /// The limit is reached.
    Limit,
}

impl Stopwatch {
    /// Begins at `now`; the limit, and how many times it may take in wall time.
    fn new((limit, backstop): (Duration, u32), slow: Option<Duration>, now: Duration) -> Self {
        let backstop = limit.saturating_mul(backstop);
        let (shown, passed, is_paused) = (None, Duration::ZERO, false);
        Self { limit, backstop, slow, began: now, shown, passed, is_paused }
    }

    /// The clock shows a time.
    fn look(&mut self, time: Duration, now: Duration) -> Passed {
        match self.shown {
            Some((before, _)) if before == time => {}
            before => {
                let before = before.map_or(time, |(before, _)| before);
                if !self.is_paused {
                    self.passed += time.saturating_sub(before);
                }
                self.shown = Some((time, now));
            }
        }
        if self.passed >= self.limit {
            return Passed::Limit;
        }
        match self.slow.take_if(|slow| *slow <= self.passed) {
            Some(_) => Passed::Slow,
            None => Passed::Within,
        }
    }

    /// What took too long, when the limit was reached: "within 10s of simulated time, …".
    fn at_limit(&self, now: Duration) -> String {
        let wall = rounded(now.saturating_sub(self.began));
        format!("within {:?} of simulated time, which took {wall:?}", self.limit)
    }

    /// The same, when so much wall time is over.
    pub fn at_backstop(&self, now: Duration) -> String {
        let Self { limit, backstop, .. } = *self;
        let clock = match self.shown {
            None => "the clock showed no time".to_owned(),
            Some((time, since)) => {
                let (time, passed) = (rounded(time), rounded(self.passed));
                let stood = rounded(now.saturating_sub(since));
                if self.passed.is_zero() {
                    format!("the clock stood at {time:?}")
                } else if stood * 2 >= backstop {
                    format!(
                        "the clock went on for {passed:?}, then stood at {time:?} for {stood:?}"
                    )
                } else {
                    format!("the clock went on for {passed:?} only, to {time:?}")
                }
            }
        };
        format!("within {limit:?} of simulated time, nor within {backstop:?}: {clock}")
    }
}

impl TestRun<'_> {
    /// Sets the limits of a phase: by the clock that the suite follows, and then
    /// also by the wall clock, which goes on in any case.
    pub(super) fn measure(
        &mut self,
        limit: Duration,
        slow: Option<Duration>,
        cx: &mut Context<'_>,
    ) {
        let timer = |timer| Deadline::Test(self.plan.id, timer);
        let Some(backstop) = self.backstop else {
            cx.set(timer(TestTimer::Limit), limit);
            return match slow {
                Some(slow) => cx.set(timer(TestTimer::Slow), slow),
                None => cx.clear(timer(TestTimer::Slow)),
            };
        };
        let stopwatch = Stopwatch::new((limit, backstop), slow, cx.now());
        cx.set(timer(TestTimer::Limit), stopwatch.backstop);
        self.stopwatch = Some(stopwatch);
    }

    /// Lets no time of that clock count, or lets it count again.
    pub(super) fn pause_clock(&mut self, is_paused: bool) {
        self.stopwatch.iter_mut().for_each(|stopwatch| stopwatch.is_paused = is_paused);
    }

    /// Whether it waits for the clock that its suite follows.
    pub fn follows_clock(&self) -> bool {
        self.stopwatch.is_some()
    }

    /// The clock that its suite follows shows a time.
    pub fn clock_shows(&mut self, time: Duration, cx: &mut Context<'_>) {
        let Some(stopwatch) = &mut self.stopwatch else { return };
        match stopwatch.look(time, cx.now()) {
            Passed::Within => {}
            Passed::Slow => cx.emit(EventKind::TestSlow { test: self.plan.id }),
            Passed::Limit => {
                let limit = stopwatch.at_limit(cx.now());
                let reason = format!("{} did not end {limit}", self.measured_step());
                self.stop(StopCause::Timeout, reason, cx);
            }
        }
    }

    /// The step that is measured.
    pub(super) fn measured_step(&self) -> &'static str {
        match self.phase {
            Phase::Setup => "set-up",
            Phase::TearDown => "tear-down",
            _ => "run",
        }
    }
}

fn rounded(time: Duration) -> Duration {
    Duration::from_millis(u64::try_from(time.as_millis()).unwrap_or(u64::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;

    const SECOND: Duration = Duration::from_secs(1);

    fn tenths(number: u32) -> Duration {
        SECOND * number / 10
    }

    #[test]
    fn time_is_what_the_clock_goes_on() {
        let mut watch = Stopwatch::new((SECOND, 10), Some(tenths(5)), Duration::ZERO);
        assert_eq!(watch.look(tenths(1000), SECOND), Passed::Within);
        assert_eq!(watch.look(tenths(1004), SECOND), Passed::Within);
        assert_eq!(watch.look(tenths(1005), SECOND), Passed::Slow);
        assert_eq!(watch.look(tenths(1009), SECOND), Passed::Within);
        assert_eq!(watch.look(tenths(1010), 3 * SECOND), Passed::Limit);
        assert_eq!(watch.at_limit(3 * SECOND), "within 1s of simulated time, which took 3s");
    }

    #[test]
    fn what_passed_before_the_clock_jumped_back_stays_counted() {
        let mut watch = Stopwatch::new((SECOND, 10), None, Duration::ZERO);
        for time in [50, 56, 0, 3] {
            assert_eq!(watch.look(tenths(time), SECOND), Passed::Within);
        }
        assert_eq!(watch.look(tenths(4), SECOND), Passed::Limit);
    }

    #[test]
    fn what_passes_while_the_clock_is_paused_does_not_count() {
        let mut watch = Stopwatch::new((SECOND, 10), None, Duration::ZERO);
        watch.look(tenths(50), SECOND);
        watch.is_paused = true;
        assert_eq!(watch.look(tenths(90), SECOND), Passed::Within);
        watch.is_paused = false;
        assert_eq!(watch.look(tenths(99), SECOND), Passed::Within);
        assert_eq!(watch.look(tenths(100), SECOND), Passed::Limit);
    }

    #[test]
    fn what_stopped_the_clock_is_told() {
        let mut watch = Stopwatch::new((SECOND, 10), None, Duration::ZERO);
        let reason = |watch: &Stopwatch| watch.at_backstop(10 * SECOND);
        let begin = "within 1s of simulated time, nor within 10s: the clock";
        assert_eq!(reason(&watch), format!("{begin} showed no time"));
        watch.look(tenths(70), SECOND);
        assert_eq!(reason(&watch), format!("{begin} stood at 7s"));
        watch.look(tenths(75), 2 * SECOND);
        let stood = "went on for 500ms, then stood at 7.5s for 8s";
        assert_eq!(reason(&watch), format!("{begin} {stood}"));
        watch.look(tenths(76), 9 * SECOND);
        assert_eq!(reason(&watch), format!("{begin} went on for 600ms only, to 7.6s"));
    }
}
