//! Judges a formula while samples arrive.

use std::collections::VecDeque;

use crate::atom::Kind;
use crate::component::{Bounded, Component};
use crate::evaluate::Mode;
use crate::explain;
use crate::formula::Formula;
use crate::judgement::{Outcome, Verdict, Violation};
use crate::shape::Shape;

/// How many samples of a signal are kept until each signal has one.
const MAX_EARLY: usize = 65_536;

/// How many samples may wait for those of a slower signal. Then its value counts as unchanged.
const MAX_WAITING: usize = 200_000;

#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MonitorError {
    /// A constant has a unit, and the formula was not converted by [`Formula::check_units`].
    #[error("the units of the constants are not converted")]
    UnitsNotConverted,
}

/// Judges a formula while samples arrive. `spec/monitors.md` lists which samples are kept.
#[derive(Clone, Debug)]
pub struct Monitor {
    shape: Shape,
    components: Vec<Component>,
    /// The last time of each signal.
    last: Vec<Option<(f64, f64)>>,
    /// The samples before the trace starts.
    early: Vec<VecDeque<(f64, f64)>>,
    has_started: bool,
    /// The time of the newest sample.
    now: f64,
    violation: Option<Violation>,
    ignored: u64,
}

impl Monitor {
    /// A monitor without samples.
    ///
    /// # Errors
    /// A constant has a unit that is not converted.
    pub fn new(formula: &Formula) -> Result<Self, MonitorError> {
        let mut components = Vec::new();
        let shape = Shape::new(&formula.condition, 1.0, &mut components);
        Self::with(formula, shape, components)
    }

    /// A monitor that keeps all samples and judges the formula as a whole: the reference.
    pub(crate) fn whole(formula: &Formula) -> Result<Self, MonitorError> {
        let component = Component::whole(&formula.condition);
        Self::with(formula, Shape::Component(0), vec![component])
    }

    fn with(
        formula: &Formula,
        shape: Shape,
        components: Vec<Component>,
    ) -> Result<Self, MonitorError> {
        if formula.condition.has_units() {
            return Err(MonitorError::UnitsNotConverted);
        }
        let signals = formula.signals().len();
        let mut monitor = Self {
            shape,
            components,
            last: vec![None; signals],
            early: vec![VecDeque::new(); signals],
            has_started: false,
            now: f64::NEG_INFINITY,
            violation: None,
            ignored: 0,
        };
        if signals == 0 {
            monitor.now = 0.0;
            monitor.begin(0.0);
        }
        Ok(monitor)
    }

    /// Takes a sample of the signal with this index in [`Formula::signals`]. `time` is in seconds
    /// and increases with each sample of a signal; other samples are ignored and counted, as are
    /// those with another index.
    ///
    /// Returns the violation if this is the first moment when the formula cannot hold any more.
    /// Further samples improve the robustness in the outcome.
    pub fn sample(&mut self, signal: usize, time: f64, value: f64) -> Option<Violation> {
        if !self.record(signal, time, value) || !self.has_started {
            return None;
        }
        if self.components.iter().any(|component| component.waiting() > MAX_WAITING) {
            for signal in 0..self.last.len() {
                self.hold(signal, self.now);
            }
        }
        self.update()
    }

    /// States that no sample of a signal arrives before `time`, so that its last value is held up
    /// to then. A signal that is published only when it changes does not delay the others then.
    pub fn advance(&mut self, signal: usize, time: f64) -> Option<Violation> {
        if !self.has_started || !time.is_finite() || !self.hold(signal, time.next_down()) {
            return None;
        }
        self.update()
    }

    /// Whether the memory has a bound that does not depend on the length of the trace.
    #[must_use]
    pub fn is_bounded(&self) -> bool {
        self.components.iter().all(Component::is_bounded)
    }

    /// How many samples and values between them the monitor keeps.
    #[must_use]
    pub fn kept_samples(&self) -> usize {
        let kept: usize = self.components.iter().map(Component::kept).sum();
        kept + self.early.iter().map(VecDeque::len).sum::<usize>()
    }

    /// Ends the trace at `end`, in seconds, or at the last sample if that is later. The last value
    /// of each signal is held up to the end. Later samples are ignored.
    pub fn finish(&mut self, end: f64) -> Outcome {
        let missing: Vec<_> =
            (0..self.last.len()).filter(|signal| self.last[*signal].is_none()).collect();
        let nothing = Outcome {
            verdict: Verdict::NotEnoughData,
            robustness: None,
            violation: None,
            missing,
            ignored: self.ignored,
        };
        if !self.has_started {
            return nothing;
        }
        let end = if end.is_finite() { end.max(self.now) } else { self.now };
        for signal in 0..self.last.len() {
            self.hold(signal, end);
            self.last[signal] = Some((f64::INFINITY, 0.0));
        }
        self.now = end;
        let outcome = |kind: Kind| {
            let outcomes: Vec<_> =
                self.components.iter().map(|component| component.outcome(kind, end)).collect();
            self.shape.outcome(&outcomes)
        };
        let (verdict, robustness) = verdict(outcome(Kind::Margin), outcome(Kind::Truth));
        if verdict == Verdict::Violated && self.violation.is_none() {
            let mode = self.last_mode(end);
            let margin = robustness.unwrap_or(f64::NEG_INFINITY);
            self.violation = Some(self.violation(mode, margin));
        }
        Outcome { verdict, robustness, violation: self.violation.clone(), ..nothing }
    }

    /// The mode in which the formula is violated at the end.
    fn last_mode(&self, end: f64) -> Mode {
        let outcomes = self.components.iter().map(|component| component.outcome(Kind::Truth, end));
        let outcome = self.shape.outcome(&outcomes.collect::<Vec<_>>());
        if outcome.bounds[1] < 0.0 {
            Mode::Complete { end, sign: 1.0 }
        } else {
            Mode::Judged { end }
        }
    }

    /// Takes a sample without judging it. Returns whether it is not ignored.
    pub(crate) fn record(&mut self, signal: usize, time: f64, value: f64) -> bool {
        let last = self.last.get(signal).copied();
        let is_later = last.is_some_and(|last| last.is_none_or(|(last, _)| time > last));
        if is_later && time.is_finite() {
            self.take(signal, time, value);
            return true;
        }
        self.ignored += 1;
        false
    }

    fn take(&mut self, signal: usize, time: f64, value: f64) {
        self.last[signal] = Some((time, value));
        self.now = self.now.max(time);
        if self.has_started {
            self.feed(signal, (time, value));
            return;
        }
        let early = &mut self.early[signal];
        early.push_back((time, value));
        if early.len() > MAX_EARLY {
            early.pop_front();
        }
        let first = |early: &VecDeque<(f64, f64)>| early.front().map(|first| first.0);
        let firsts: Option<Vec<f64>> = self.early.iter().map(first).collect();
        if let Some(firsts) = firsts {
            self.begin(firsts.into_iter().fold(f64::NEG_INFINITY, f64::max));
        }
    }

    /// Starts the trace when each signal has a sample.
    fn begin(&mut self, start: f64) {
        self.has_started = true;
        let early = std::mem::take(&mut self.early);
        let sample = |signal: usize| {
            let samples: &VecDeque<(f64, f64)> = &early[signal];
            let next = samples.partition_point(|sample| sample.0 <= start);
            samples[next.saturating_sub(1)]
        };
        for component in &mut self.components {
            component.begin(start, &sample);
        }
        for (signal, samples) in early.into_iter().enumerate() {
            for sample in samples.into_iter().filter(|sample| sample.0 > start) {
                self.feed(signal, sample);
            }
        }
    }

    fn feed(&mut self, signal: usize, sample: (f64, f64)) {
        for component in &mut self.components {
            component.sample(signal, sample);
        }
    }

    /// Holds the last value of a signal up to a time. Returns whether this is later than its last
    /// sample.
    fn hold(&mut self, signal: usize, time: f64) -> bool {
        let Some(Some((last, value))) = self.last.get(signal).copied() else { return false };
        if time <= last {
            return false;
        }
        self.last[signal] = Some((time, value));
        self.now = self.now.max(time);
        self.feed(signal, (time, value));
        true
    }

    /// Checks whether the formula is violated, and judges what is complete.
    fn update(&mut self) -> Option<Violation> {
        let now = self.now;
        let mut violation = None;
        if self.violation.is_none() {
            for component in &mut self.components {
                component.check(now);
            }
            let possible = |index: usize| {
                let component = &self.components[index];
                let polarity = component.polarity;
                if component.is_decided { -polarity } else { polarity }
            };
            if self.shape.combine(&possible) < 0.0 {
                let bound = |index: usize| self.components[index].bound(Kind::Margin, now);
                let margin = self.shape.combine(&bound);
                violation = Some(self.violation(Mode::Online { now }, margin));
                self.violation.clone_from(&violation);
            }
        }
        for component in &mut self.components {
            component.judge();
        }
        violation
    }

    fn violation(&self, mode: Mode, margin: f64) -> Violation {
        let now = self.now;
        let value = |index: usize| match mode {
            Mode::Online { now } => self.components[index].bound(Kind::Margin, now),
            Mode::Complete { end, .. } => {
                self.components[index].outcome(Kind::Margin, end).bounds[1]
            }
            _ => {
                let outcome = self.components[index].outcome(Kind::Margin, now);
                outcome.judged.unwrap_or(outcome.bounds[1])
            }
        };
        let component = &self.components[explain::component(&self.shape, &value)];
        let cause = explain::cause(component, mode, now);
        Violation {
            time: now,
            robustness: margin.min(0.0),
            interval: cause.interval,
            responsible: cause.span.unwrap_or_default(),
            values: cause.values,
        }
    }
}

/// The verdict and the robustness of a complete trace.
fn verdict(margin: Bounded, truth: Bounded) -> (Verdict, Option<f64>) {
    let verdict = if truth.bounds[1] < 0.0 {
        Verdict::Violated
    } else if truth.bounds[0] > 0.0 {
        Verdict::Holds
    } else {
        match truth.judged {
            None => Verdict::NotEnoughData,
            Some(judged) if judged < 0.0 => Verdict::Violated,
            Some(_) => Verdict::Holds,
        }
    };
    let [lower, upper] = margin.bounds;
    let robustness = match (margin.judged, verdict) {
        (Some(judged), _) => Some(judged.min(upper).max(lower)),
        (None, Verdict::Violated) => Some(upper),
        (None, Verdict::Holds) => Some(lower),
        (None, Verdict::NotEnoughData) => None,
    };
    // The margins are rounded, so at 0 their sign may be wrong.
    let robustness = robustness.map(|robustness| match verdict {
        Verdict::Violated => robustness.min(0.0),
        _ => robustness.max(0.0),
    });
    (verdict, robustness)
}
