//! A part of the formula that is judged by itself: `always` or `eventually` of a bounded condition,
//! a bounded condition at the start, or any other condition at the start.

use crate::atom::{Atom, Kind};
use crate::evaluate::{Evaluation, Mode};
use crate::function::Function;
use crate::node::Program;
use crate::syntax::{Condition, Quantifier, Tense};

/// How many knots are collected before they are judged at once.
const MIN_KNOTS: u64 = 64;

/// From this number of changes of truth on, the component is not checked at each sample, but each
/// time this fraction of it arrived.
const FREQUENT_CHANGES: usize = 1024;

/// Samples closer to the last one than this, in seconds, wait: sums of intervals are rounded.
const MARGIN_SECS: f64 = 1e-6;

/// When a component is judged.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Scope {
    Start,
    /// At all or some times from this one on, in seconds after the start.
    Unbounded(Quantifier, f64),
}

/// A part of the formula with its samples.
#[derive(Clone, Debug)]
pub(crate) struct Component {
    scope: Scope,
    pub program: Program,
    horizon: f64,
    pub atoms: Vec<Atom>,
    /// 1, or -1 if it is negated as a part of the formula.
    pub polarity: f64,
    pub start: f64,
    /// Up to which time its operand is judged.
    done: f64,
    /// The least or greatest value up to then, of the margin and the truth.
    collected: [f64; 2],
    /// The values of operators of the past there.
    memories: [Vec<Option<f64>>; 2],
    /// The final values of a bounded condition at the start.
    result: Option<[f64; 2]>,
    /// Whether its truth cannot support the formula any more.
    pub is_decided: bool,
    /// Whether it may be decided without a change of truth.
    is_watched: bool,
    /// Samples since the last check.
    unchecked: usize,
    has_changed: bool,
    judged_knots: u64,
}

impl Component {
    pub(crate) fn new(condition: &Condition, polarity: f64) -> Self {
        let (scope, operand) = match condition {
            Condition::Window { tense: Tense::Future, quantifier, interval, inner, .. }
                if interval.to.is_infinite() && inner.horizon().is_finite() =>
            {
                (Scope::Unbounded(*quantifier, interval.from), inner.as_ref())
            }
            _ => (Scope::Start, condition),
        };
        Self::with(scope, operand, polarity)
    }

    /// A component that judges a whole formula at the start.
    pub(crate) fn whole(condition: &Condition) -> Self {
        Self::with(Scope::Start, condition, 1.0)
    }

    fn with(scope: Scope, operand: &Condition, polarity: f64) -> Self {
        let program = Program::new(operand, polarity);
        let atoms = program.comparisons.iter().cloned().map(Atom::new).collect();
        let neutral = match scope {
            Scope::Unbounded(quantifier, _) => quantifier.neutral(),
            Scope::Start => f64::INFINITY,
        };
        Self {
            scope,
            horizon: program.node.horizon(),
            atoms,
            polarity,
            start: f64::NEG_INFINITY,
            done: f64::NEG_INFINITY,
            collected: [neutral; 2],
            memories: [vec![None; program.memories], vec![None; program.memories]],
            result: None,
            is_decided: false,
            is_watched: true,
            unchecked: 0,
            has_changed: true,
            judged_knots: 0,
            program,
        }
    }

    /// Starts the trace, with the last sample of each signal that is not after `start`.
    pub(crate) fn begin(&mut self, start: f64, samples: &dyn Fn(usize) -> (f64, f64)) {
        self.start = start;
        self.done = start + if let Scope::Unbounded(_, delay) = self.scope { delay } else { 0.0 };
        for atom in &mut self.atoms {
            atom.begin(start, samples);
            atom.process(start);
        }
    }

    pub(crate) fn sample(&mut self, signal: usize, sample: (f64, f64)) {
        if self.result.is_some() {
            return;
        }
        for atom in self.atoms.iter_mut().filter(|atom| atom.has_signal(signal)) {
            self.has_changed |= atom.sample(self.start, signal, sample);
        }
        self.unchecked += 1;
    }

    /// Whether it forgets samples.
    pub(crate) fn is_bounded(&self) -> bool {
        !self.program.node.is_unbounded()
    }

    /// How many samples and values are kept.
    pub(crate) fn kept(&self) -> usize {
        self.atoms.iter().map(Atom::kept).sum()
    }

    /// The greatest number of samples that wait for another signal.
    pub(crate) fn waiting(&self) -> usize {
        self.atoms.iter().map(Atom::waiting).max().unwrap_or(0)
    }

    /// Finds out whether the truth of the component is decided against the formula.
    pub(crate) fn check(&mut self, now: f64) {
        if self.is_decided || self.result.is_some() || !self.is_decidable() {
            return;
        }
        if !self.has_changed && !self.is_watched {
            return;
        }
        let changes: usize = self.atoms.iter().map(Atom::changes).sum();
        if changes > FREQUENT_CHANGES && self.unchecked < changes / FREQUENT_CHANGES {
            return;
        }
        self.unchecked = 0;
        self.is_decided = self.is_against(Mode::Online { now }, now);
        if self.has_changed && !self.is_decided {
            self.has_changed = false;
            let later = now + self.horizon + self.program.reach.max(0.0) + 1.0;
            self.is_watched = self.is_against(Mode::Settled { now: later }, later);
        }
    }

    /// Whether more samples can decide it against the formula.
    fn is_decidable(&self) -> bool {
        match self.scope {
            Scope::Start => true,
            Scope::Unbounded(Quantifier::All, _) => self.polarity > 0.0,
            Scope::Unbounded(Quantifier::Some, _) => self.polarity < 0.0,
        }
    }

    fn is_against(&self, mode: Mode, now: f64) -> bool {
        self.value(Kind::Truth, mode, now) * self.polarity < 0.0
    }

    /// The bound in the direction of the formula while the trace continues.
    pub(crate) fn bound(&self, kind: Kind, now: f64) -> f64 {
        match self.result {
            Some(result) => result[index(kind)],
            None if !self.is_decidable() => f64::INFINITY * self.polarity,
            None => self.value(kind, Mode::Online { now }, now),
        }
    }

    /// The value with a mode, judged up to a time.
    pub(crate) fn value(&self, kind: Kind, mode: Mode, to: f64) -> f64 {
        if let Some(result) = self.result {
            return result[index(kind)];
        }
        let Some(function) = self.function(kind, mode, to) else {
            return self.collected[index(kind)];
        };
        match self.scope {
            Scope::Start => function.value(self.start),
            Scope::Unbounded(quantifier, _) => self.collect(quantifier, kind, &function),
        }
    }

    /// The operand from where it is not judged yet up to a time, or at the start.
    pub(crate) fn function(&self, kind: Kind, mode: Mode, to: f64) -> Option<Function> {
        let (begin, to) = match self.scope {
            Scope::Start => (self.start, self.start),
            Scope::Unbounded(..) if to < self.done => return None,
            Scope::Unbounded(..) => (self.done, to),
        };
        Some(self.evaluation(kind, mode).function(&self.program.node, begin, to))
    }

    pub(crate) fn evaluation(&self, kind: Kind, mode: Mode) -> Evaluation<'_> {
        Evaluation {
            atoms: &self.atoms,
            kind,
            is_edge: false,
            mode,
            start: self.start,
            memories: &self.memories[index(kind)],
            next: None,
        }
    }

    fn collect(&self, quantifier: Quantifier, kind: Kind, function: &Function) -> f64 {
        quantifier.combine(self.collected[index(kind)], function.extreme(quantifier).1)
    }

    /// Judges what is complete, and forgets the samples that are not necessary any more, if there
    /// are enough of them.
    pub(crate) fn judge(&mut self) {
        if self.result.is_some() || !self.is_bounded() {
            return;
        }
        let known = self.atoms.iter().map(Atom::progress).fold(f64::INFINITY, f64::min);
        if !known.is_finite() {
            return;
        }
        let to = known - MARGIN_SECS - self.horizon;
        let mode = Mode::Judged { end: known };
        match self.scope {
            Scope::Start if to > self.start => {
                let result = [Kind::Margin, Kind::Truth].map(|kind| self.value(kind, mode, to));
                self.is_decided |= result[1] * self.polarity < 0.0;
                self.result = Some(result);
                // What is against the formula may have to be explained.
                if result[1] * self.polarity > 0.0 {
                    self.atoms.iter_mut().for_each(|atom| atom.forget(f64::INFINITY));
                }
            }
            Scope::Start => {}
            Scope::Unbounded(quantifier, _) => {
                let knots: u64 = self.atoms.iter().map(|atom| atom.knots).sum();
                let is_long = to - self.done >= self.horizon + self.program.reach;
                if knots - self.judged_knots >= MIN_KNOTS && is_long && to > self.done {
                    self.judged_knots = knots;
                    self.judge_up_to(quantifier, mode, to);
                }
            }
        }
    }

    fn judge_up_to(&mut self, quantifier: Quantifier, mode: Mode, to: f64) {
        for kind in [Kind::Margin, Kind::Truth] {
            let memories = vec![None; self.program.memories];
            let mut evaluation = self.evaluation(kind, mode);
            evaluation.next = Some((to - self.done, memories));
            let function = evaluation.function(&self.program.node, self.done, to);
            let next = evaluation.next.take();
            self.collected[index(kind)] = self.collect(quantifier, kind, &function);
            if let Some((_, memories)) = next {
                self.memories[index(kind)] = memories;
            }
        }
        self.done = to;
        for (atom, shift) in self.atoms.iter_mut().zip(&self.program.shifts) {
            atom.forget(to + shift - MARGIN_SECS);
        }
    }

    /// The value in a trace that ends at `end`, up to which all signals are known: at the times at
    /// which all windows are complete, and the bounds. The first is `None` if there is no such time.
    pub(crate) fn outcome(&self, kind: Kind, end: f64) -> Bounded {
        let delay = if let Scope::Unbounded(_, delay) = self.scope { delay } else { 0.0 };
        let is_complete = self.start + (delay + self.horizon) <= end;
        let last = (end - self.horizon).max(self.start + delay);
        let bound = |sign: f64| {
            if self.result.is_none() && end < self.start + delay {
                return sign * self.polarity * f64::INFINITY;
            }
            self.value(kind, Mode::Complete { end, sign }, end)
        };
        Bounded {
            judged: is_complete.then(|| self.value(kind, Mode::Judged { end }, last)),
            bounds: [bound(-1.0), bound(1.0)],
        }
    }

    pub(crate) fn is_at_start(&self) -> bool {
        self.scope == Scope::Start
    }
}

/// The value of a part of the formula, and its bounds against and for the formula.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounded {
    pub judged: Option<f64>,
    pub bounds: [f64; 2],
}

fn index(kind: Kind) -> usize {
    usize::from(kind == Kind::Truth)
}
