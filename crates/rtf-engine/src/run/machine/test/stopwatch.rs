//! Measures a phase of a test in simulated time. `run/clock.rs` reads the clock.

use std::time::Duration;

use rtf_model::{EventKind, Phase, StopCause};

use super::TestRun;
use crate::run::machine::context::Context;
use crate::run::machine::io::{Deadline, TestTimer};

#[derive(Debug)]
pub struct Stopwatch {
    limit: Duration,
    /// The limit in wall-clock time.
    backstop: Duration,
    /// When the test counts as slow, until that is reported.
    slow: Option<Duration>,
    /// The start of the phase, in wall-clock time.
    started: Duration,
    /// The last reading of the clock, and since when it shows that.
    reading: Option<(Duration, Duration)>,
    /// Simulated time since the start; jumps back do not reduce it.
    elapsed: Duration,
    /// The runner or an operator delays the test: time does not count.
    is_paused: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum LimitStatus {
    Within,
    /// Reported once.
    Slow,
    Reached,
}

impl Stopwatch {
    /// The limit may take `factor` times as long in wall-clock time.
    fn new((limit, factor): (Duration, u32), slow: Option<Duration>, now: Duration) -> Self {
        let backstop = limit.saturating_mul(factor);
        let (reading, elapsed, is_paused) = (None, Duration::ZERO, false);
        Self { limit, backstop, slow, started: now, reading, elapsed, is_paused }
    }

    fn record(&mut self, time: Duration, now: Duration) -> LimitStatus {
        match self.reading {
            Some((before, _)) if before == time => {}
            before => {
                let before = before.map_or(time, |(before, _)| before);
                if !self.is_paused {
                    self.elapsed += time.saturating_sub(before);
                }
                self.reading = Some((time, now));
            }
        }
        if self.elapsed >= self.limit {
            return LimitStatus::Reached;
        }
        match self.slow.take_if(|slow| *slow <= self.elapsed) {
            Some(_) => LimitStatus::Slow,
            None => LimitStatus::Within,
        }
    }

    fn limit_reason(&self, now: Duration) -> String {
        let wall = rounded(now.saturating_sub(self.started));
        format!("within {:?} of simulated time, which took {wall:?}", self.limit)
    }

    /// Why the backstop passed before the limit.
    pub fn backstop_reason(&self, now: Duration) -> String {
        let Self { limit, backstop, .. } = *self;
        let clock = match self.reading {
            None => "the clock showed no time".to_owned(),
            Some((time, since)) => {
                let (time, elapsed) = (rounded(time), rounded(self.elapsed));
                let stood = rounded(now.saturating_sub(since));
                if self.elapsed.is_zero() {
                    format!("the clock stood at {time:?}")
                } else if stood * 2 >= backstop {
                    format!(
                        "the clock advanced by {elapsed:?}, then stood at {time:?} for {stood:?}"
                    )
                } else {
                    format!("the clock advanced by only {elapsed:?}, to {time:?}")
                }
            }
        };
        format!("within {limit:?} of simulated time, nor within {backstop:?}: {clock}")
    }
}

impl TestRun<'_> {
    /// Sets the limits of a phase, by the simulated clock if the suite has one. The wall
    /// clock is the backstop.
    pub(super) fn set_phase_limit(
        &mut self,
        limit: Duration,
        slow: Option<Duration>,
        cx: &mut Context<'_>,
    ) {
        let Some(backstop) = self.backstop else {
            self.set_limit(limit, cx);
            return match slow {
                Some(slow) => cx.set(Deadline::Test(self.plan.id, TestTimer::Slow), slow),
                None => self.clear(TestTimer::Slow, cx),
            };
        };
        let stopwatch = Stopwatch::new((limit, backstop), slow, cx.now());
        self.set_limit(stopwatch.backstop, cx);
        self.stopwatch = Some(stopwatch);
        self.update_stopwatch();
    }

    pub(super) fn set_throttled(&mut self, is_throttled: bool) {
        self.is_throttled = is_throttled;
        self.update_stopwatch();
    }

    /// Pauses the stopwatch while the runner or an operator delays the test.
    pub(super) fn update_stopwatch(&mut self) {
        let is_paused = self.is_throttled || !self.questions.is_empty();
        self.stopwatch.iter_mut().for_each(|stopwatch| stopwatch.is_paused = is_paused);
    }

    /// Whether it needs readings of the simulated clock.
    pub fn follows_clock(&self) -> bool {
        self.stopwatch.is_some()
    }

    /// Takes a reading of the simulated clock.
    pub fn on_clock(&mut self, time: Duration, cx: &mut Context<'_>) {
        let Some(stopwatch) = &mut self.stopwatch else { return };
        match stopwatch.record(time, cx.now()) {
            LimitStatus::Within => {}
            LimitStatus::Slow => cx.emit(EventKind::TestSlow { test: self.plan.id }),
            LimitStatus::Reached => {
                let limit = stopwatch.limit_reason(cx.now());
                let reason = format!("{} did not end {limit}", self.step_name());
                self.stop(StopCause::Timeout, reason, cx);
            }
        }
    }

    pub(super) fn step_name(&self) -> &'static str {
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
    fn elapsed_time_is_the_clocks_progress() {
        let mut watch = Stopwatch::new((SECOND, 10), Some(tenths(5)), Duration::ZERO);
        assert_eq!(watch.record(tenths(1000), SECOND), LimitStatus::Within);
        assert_eq!(watch.record(tenths(1004), SECOND), LimitStatus::Within);
        assert_eq!(watch.record(tenths(1005), SECOND), LimitStatus::Slow);
        assert_eq!(watch.record(tenths(1009), SECOND), LimitStatus::Within);
        assert_eq!(watch.record(tenths(1010), 3 * SECOND), LimitStatus::Reached);
        assert_eq!(watch.limit_reason(3 * SECOND), "within 1s of simulated time, which took 3s");
    }

    #[test]
    fn a_jump_back_does_not_reduce_the_elapsed_time() {
        let mut watch = Stopwatch::new((SECOND, 10), None, Duration::ZERO);
        for time in [50, 56, 0, 3] {
            assert_eq!(watch.record(tenths(time), SECOND), LimitStatus::Within);
        }
        assert_eq!(watch.record(tenths(4), SECOND), LimitStatus::Reached);
    }

    #[test]
    fn time_while_paused_does_not_count() {
        let mut watch = Stopwatch::new((SECOND, 10), None, Duration::ZERO);
        watch.record(tenths(50), SECOND);
        watch.is_paused = true;
        assert_eq!(watch.record(tenths(90), SECOND), LimitStatus::Within);
        watch.is_paused = false;
        assert_eq!(watch.record(tenths(99), SECOND), LimitStatus::Within);
        assert_eq!(watch.record(tenths(100), SECOND), LimitStatus::Reached);
    }

    #[test]
    fn the_reason_describes_the_clock() {
        let mut watch = Stopwatch::new((SECOND, 10), None, Duration::ZERO);
        let reason = |watch: &Stopwatch| watch.backstop_reason(10 * SECOND);
        let begin = "within 1s of simulated time, nor within 10s: the clock";
        assert_eq!(reason(&watch), format!("{begin} showed no time"));
        watch.record(tenths(70), SECOND);
        assert_eq!(reason(&watch), format!("{begin} stood at 7s"));
        watch.record(tenths(75), 2 * SECOND);
        let stood = "advanced by 500ms, then stood at 7.5s for 8s";
        assert_eq!(reason(&watch), format!("{begin} {stood}"));
        watch.record(tenths(76), 9 * SECOND);
        assert_eq!(reason(&watch), format!("{begin} advanced by only 600ms, to 7.6s"));
    }
}
