//! A part of the formula as a function of time.
//!
//! Each operator asks its operands for the interval that it needs. Identities that are used:
//!
//! - `p until[a,b] q` is `eventually[a,b] q and always[0,a] (p until q)`, where the last `until` may
//!   end at any time not before t + b;
//! - `p until[a,inf] q` is `always[0,a] p`, and `p until q` at t + a;
//! - the mirror images for `since`.

use crate::atom::{Atom, Extension, Kind};
use crate::function::{Bounds, Function, greatest, least, since, supremum, until};
use crate::node::{Node, Temporal};
use crate::syntax::{Quantifier, Tense};

/// Which samples are there, and what is assumed about others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Mode {
    /// Only times at which all windows are complete, in a trace that ends at `end`.
    Judged { end: f64 },
    /// The trace ends at `end`. Values after it range from `-inf` to `inf`: the bound of the
    /// robustness in the direction of `sign`.
    Complete { end: f64, sign: f64 },
    /// The trace reached `now` and continues: the upper bound.
    Online { now: f64 },
    /// The same if the truth of no comparison changes any more.
    Settled { now: f64 },
}

pub(crate) struct Evaluation<'a> {
    pub atoms: &'a [Atom],
    pub kind: Kind,
    /// Whether it is the operand of an edge.
    pub is_edge: bool,
    pub mode: Mode,
    /// The start of the trace.
    pub start: f64,
    /// The values of operators of the past at the start of what is kept.
    pub memories: &'a [Option<f64>],
    /// How much later the next evaluation starts, and the values of the operators there.
    pub next: Option<(f64, Vec<Option<f64>>)>,
}

impl Evaluation<'_> {
    /// The function of a part from `begin`, or the start of the trace if that is later, to `to`.
    pub(crate) fn function(&mut self, node: &Node, begin: f64, to: f64) -> Function {
        let from = begin.max(self.start);
        match node {
            Node::Atom(index) => {
                let atom = &self.atoms[*index];
                let extension = self.extension(atom);
                atom.function(self.kind, (from, to), extension, self.is_edge)
            }
            Node::Constant(value) => Function::constant(from, to, *value),
            Node::Not(inner) => self.function(inner, begin, to).negated(),
            Node::Junction(quantifier, parts) => {
                let functions = parts.iter().map(|part| self.function(part, begin, to));
                let combined = functions.reduce(|left, right| combine(*quantifier)(&left, &right));
                combined.unwrap_or_else(|| Function::constant(from, to, f64::INFINITY))
            }
            Node::Window(temporal, quantifier, inner) => {
                let bound = self.beyond(temporal, *quantifier);
                self.window(temporal, (*quantifier, bound), inner, (begin, to))
            }
            Node::UpTo(temporal, sides) if temporal.interval.to.is_finite() => {
                self.bounded_up_to(temporal, sides, (begin, to))
            }
            Node::UpTo(temporal, sides) if temporal.tense == Tense::Future => {
                self.until(temporal, sides, (begin, to))
            }
            Node::UpTo(temporal, sides) => self.since(temporal, sides, (begin, to)),
            Node::Edge(sides) => self.edge(sides, begin, to),
        }
    }

    fn extension(&self, atom: &Atom) -> Option<Extension> {
        match self.mode {
            Mode::Judged { .. } => None,
            Mode::Complete { sign, .. } => {
                Some(Extension::Value(sign * atom.comparison.polarity * f64::INFINITY))
            }
            Mode::Online { .. } => Some(Extension::Value(atom.comparison.polarity * f64::INFINITY)),
            Mode::Settled { .. } => Some(Extension::Unchanged),
        }
    }

    /// The last time that an unbounded operator of the future considers.
    fn end(&self, inner: &[Node]) -> f64 {
        match self.mode {
            Mode::Judged { end } => end - inner.iter().map(Node::horizon).fold(0.0, f64::max),
            Mode::Complete { end, .. } => end,
            Mode::Online { now } | Mode::Settled { now } => now,
        }
    }

    /// The value that an unbounded operator of the future has because the trace continues: what a
    /// later goal may give. `None` if only known times count.
    fn beyond(&self, temporal: &Temporal, quantifier: Quantifier) -> Option<f64> {
        let continues = matches!(self.mode, Mode::Online { .. } | Mode::Settled { .. });
        let possible = if quantifier == Quantifier::Some { 1.0 } else { -1.0 };
        (continues && temporal.is_unbounded() && temporal.polarity * possible > 0.0)
            .then_some(possible * f64::INFINITY)
    }

    /// The value of an operator whose interval begins after the end of the trace.
    fn unknown(&self, temporal: &Temporal) -> f64 {
        let sign = if let Mode::Complete { sign, .. } = self.mode { sign } else { 1.0 };
        sign * temporal.polarity * f64::INFINITY
    }

    /// `always` and the like. `bound` has the quantifier and the value of [`Self::beyond`].
    fn window(
        &mut self,
        temporal: &Temporal,
        bound: (Quantifier, Option<f64>),
        inner: &Node,
        (begin, to): (f64, f64),
    ) -> Function {
        let from = begin.max(self.start);
        let (quantifier, beyond) = bound;
        if let Some(value) = beyond {
            return Function::constant(from, to, value);
        }
        let interval = temporal.interval;
        if temporal.tense == Tense::Past {
            if to - interval.from < self.start {
                return Function::constant(from, to, quantifier.neutral());
            }
            return self.past_window(temporal, quantifier, inner, (begin, to));
        }
        if interval.to.is_infinite() {
            return self.unbounded_window(temporal, quantifier, inner, (begin, to));
        }
        let function = self.function(inner, begin + interval.from, to + interval.to);
        extremum(function, quantifier, Bounds { start: interval.from, end: interval.to, from, to })
    }

    /// `always` or `eventually` up to the end of the trace.
    fn unbounded_window(
        &mut self,
        temporal: &Temporal,
        quantifier: Quantifier,
        inner: &Node,
        (begin, to): (f64, f64),
    ) -> Function {
        let from = begin.max(self.start);
        let delay = temporal.interval.from;
        let mut end = self.end(std::slice::from_ref(inner));
        if let Mode::Judged { .. } = self.mode {
            // All windows are complete, apart from rounding.
            end = end.max(to + delay);
        }
        if end < from + delay {
            return Function::constant(from, to, self.unknown(temporal));
        }
        let function = self.function(inner, begin + delay, end);
        let last = to.min(end - delay).max(from);
        let window_end = (end - from).max(delay) + 1.0;
        let bounds = Bounds { start: delay, end: window_end, from, to: last };
        extremum(function, quantifier, bounds).extended(to, self.unknown(temporal))
    }

    fn past_window(
        &mut self,
        temporal: &Temporal,
        quantifier: Quantifier,
        inner: &Node,
        (begin, to): (f64, f64),
    ) -> Function {
        let from = begin.max(self.start);
        let interval = temporal.interval;
        let end = to - interval.from;
        let Some(memory) = temporal.memory else {
            let function = self.function(inner, begin - interval.to, end);
            let bounds = Bounds { start: -interval.to, end: -interval.from, from, to };
            return extremum(function, quantifier, bounds);
        };
        let value = self.memories[memory];
        let inner_begin = if value.is_some() { begin - interval.from } else { f64::NEG_INFINITY };
        let function = self.function(inner, inner_begin, end);
        let earlier = value.unwrap_or(quantifier.neutral());
        self.remember(memory, begin - interval.from, |time| {
            let part = function.slice(function.from(), time);
            quantifier.combine(part.extreme(quantifier).1, earlier)
        });
        let reach = (to - function.from()).max(interval.from) + 1.0;
        let bounds = Bounds { start: -reach, end: -interval.from, from, to };
        let function = extremum(function, quantifier, bounds);
        combine(quantifier)(&function, &Function::constant(from, to, earlier))
    }

    /// `until` or `since` with a bounded interval.
    fn bounded_up_to(
        &mut self,
        temporal: &Temporal,
        sides: &[Node; 2],
        (begin, to): (f64, f64),
    ) -> Function {
        let from = begin.max(self.start);
        let interval = temporal.interval;
        let is_past = temporal.tense == Tense::Past;
        if is_past && to - interval.from < self.start {
            return Function::constant(from, to, f64::NEG_INFINITY);
        }
        let (first, last) =
            if is_past { (begin - interval.to, to) } else { (begin, to + interval.to) };
        let condition = self.function(&sides[0], first, last);
        let goal = self.function(&sides[1], first, last);
        let (all, window, delay) = if is_past {
            let all = since(&condition, &goal, f64::NEG_INFINITY);
            let window = Bounds { start: -interval.to, end: -interval.from, from, to };
            (all, window, Bounds { start: -interval.from, end: 0.0, from, to })
        } else {
            let all = until(&condition, &goal, f64::NEG_INFINITY);
            let window = Bounds { start: interval.from, end: interval.to, from, to };
            (all, window, Bounds { start: 0.0, end: interval.from, from, to })
        };
        let goal = supremum(&goal, window);
        let all = if interval.from > 0.0 {
            extremum(all, Quantifier::All, delay)
        } else {
            all.restricted(from, to)
        };
        least(&goal, &all)
    }

    /// `until` without an upper bound.
    fn until(&mut self, temporal: &Temporal, sides: &[Node; 2], range: (f64, f64)) -> Function {
        let (begin, to) = range;
        let from = begin.max(self.start);
        let delay = temporal.interval.from;
        let end = self.end(sides);
        let after = self.beyond(temporal, Quantifier::Some).unwrap_or(f64::NEG_INFINITY);
        let unknown = self.unknown(temporal);
        if end < from {
            return Function::constant(from, to, unknown);
        }
        let condition = self.function(&sides[0], begin, end);
        let goal = self.function(&sides[1], begin, end);
        let all = until(&condition, &goal, after).extended(to + delay, unknown);
        if delay == 0.0 {
            return all.restricted(from, to);
        }
        let condition = condition.extended(to + delay, f64::INFINITY);
        let bounds = Bounds { start: 0.0, end: delay, from, to };
        let condition = extremum(condition, Quantifier::All, bounds);
        let all = supremum(&all, Bounds { start: delay, end: delay, from, to });
        least(&condition, &all)
    }

    /// `since` without an upper bound.
    fn since(&mut self, temporal: &Temporal, sides: &[Node; 2], range: (f64, f64)) -> Function {
        let (begin, to) = range;
        let from = begin.max(self.start);
        let delay = temporal.interval.from;
        if to - delay < self.start {
            return Function::constant(from, to, f64::NEG_INFINITY);
        }
        let value = temporal.memory.and_then(|memory| self.memories[memory]);
        let first = if value.is_some() { begin - delay } else { f64::NEG_INFINITY };
        let condition = self.function(&sides[0], first, to);
        let goal = self.function(&sides[1], first, to);
        let all = since(&condition, &goal, value.unwrap_or(f64::NEG_INFINITY));
        if let Some(memory) = temporal.memory {
            self.remember(memory, begin - delay, |time| all.value(time));
        }
        if delay == 0.0 {
            return all.restricted(from, to);
        }
        let bounds = Bounds { start: -delay, end: 0.0, from, to };
        let condition = extremum(condition, Quantifier::All, bounds);
        let all = supremum(&all, Bounds { start: -delay, end: -delay, from, to });
        least(&condition, &all)
    }

    /// Stores the value of an operator of the past for the next evaluation.
    fn remember(&mut self, memory: usize, begin: f64, value: impl Fn(f64) -> f64) {
        if let Some((advance, memories)) = &mut self.next {
            let time = begin + *advance;
            memories[memory] = (time >= self.start).then(|| value(time));
        }
    }

    fn edge(&mut self, sides: &[Node; 2], begin: f64, to: f64) -> Function {
        let kind = std::mem::replace(&mut self.kind, Kind::Truth);
        self.is_edge = true;
        let after = self.function(&sides[0], begin, to).after();
        let mut before = self.function(&sides[1], begin, to).before();
        (self.kind, self.is_edge) = (kind, false);
        // There is no edge at the start of the trace.
        if before.from() <= self.start {
            before.first_mut().at = f64::INFINITY;
        }
        least(&after, &before.negated())
    }
}

/// What joins conditions.
fn combine(quantifier: Quantifier) -> fn(&Function, &Function) -> Function {
    if quantifier == Quantifier::All { least } else { greatest }
}

fn extremum(function: Function, quantifier: Quantifier, bounds: Bounds) -> Function {
    match quantifier {
        Quantifier::Some => supremum(&function, bounds),
        Quantifier::All => supremum(&function.negated(), bounds).negated(),
    }
}
