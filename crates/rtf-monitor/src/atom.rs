//! A comparison of signals: samples → its margin and truth as functions of time.

use crate::comparison::Comparison;
use crate::expression::{Leaf, Line, Part};
use crate::function::{Function, Knot};
use crate::judgement::SignalValue;
use crate::samples::Samples;

/// Which function of a comparison.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Margin,
    /// `inf` where it is true, `-inf` where it is false.
    Truth,
}

/// What is assumed about times without samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Extension {
    /// The value of the comparison is this.
    Value(f64),
    /// Its truth does not change any more.
    Unchanged,
}

/// A comparison with its samples.
#[derive(Clone, Debug)]
pub(crate) struct Atom {
    pub comparison: Comparison,
    slots: Vec<Samples>,
    /// The slot of each leaf.
    places: Vec<usize>,
    has_rate: bool,
    is_held: bool,
    is_linear: bool,
    /// The functions up to the progress; `None` before the start of the trace.
    functions: Option<[Function; 2]>,
    /// How many knots were computed since the start.
    pub knots: u64,
    /// Reused memory.
    lines: Vec<Line>,
    parts: Vec<Part>,
}

impl Atom {
    pub(crate) fn new(comparison: Comparison) -> Self {
        let mut slots: Vec<Samples> = Vec::new();
        let mut places = Vec::new();
        for leaf in &comparison.leaves {
            let known = slots.iter().position(|slot| slot.signal == leaf.signal);
            places.push(known.unwrap_or(slots.len()));
            if known.is_none() {
                slots.push(Samples::new(leaf.signal));
            }
        }
        Self {
            has_rate: comparison.expression.has_rate(),
            is_held: comparison.leaves.iter().all(|leaf| leaf.is_held),
            is_linear: comparison.leaves.iter().all(|leaf| !leaf.is_held),
            slots,
            places,
            functions: None,
            knots: 0,
            lines: Vec::with_capacity(comparison.leaves.len()),
            parts: Vec::new(),
            comparison,
        }
    }

    pub(crate) fn has_signal(&self, signal: usize) -> bool {
        self.slots.iter().any(|slot| slot.signal == signal)
    }

    /// Up to which time it is known. A comparison of constants is always known.
    pub(crate) fn progress(&self) -> f64 {
        match &self.functions {
            _ if self.slots.is_empty() => f64::INFINITY,
            None => f64::NEG_INFINITY,
            Some([margin, _]) => margin.to(),
        }
    }

    /// How many times its truth changes in what is kept.
    pub(crate) fn changes(&self) -> usize {
        self.functions.as_ref().map_or(0, |[_, truth]| truth.knots().len())
    }

    /// How many samples and values are kept.
    pub(crate) fn kept(&self) -> usize {
        let samples: usize = self.slots.iter().map(|slot| slot.len()).sum();
        let functions = self.functions.iter().flatten();
        samples + functions.map(|function| function.knots().len()).sum::<usize>()
    }

    /// How many samples wait for those of another signal.
    pub(crate) fn waiting(&self) -> usize {
        self.slots.iter().map(Samples::waiting).sum()
    }

    /// Starts the trace, with the last sample of each signal that is not after `start`.
    pub(crate) fn begin(&mut self, start: f64, samples: &dyn Fn(usize) -> (f64, f64)) {
        for slot in &mut self.slots {
            slot.push(samples(slot.signal));
        }
        if self.slots.is_empty() {
            let value = self.comparison.expression.value(&[]);
            let (margin, truth) = self.comparison.point(value);
            let functions = [margin, truth];
            self.functions =
                Some(functions.map(|value| Function::starting(Knot::flat(start, value))));
        }
    }

    /// Takes a sample, later than the previous one of its signal. Returns whether the truth changes.
    pub(crate) fn sample(&mut self, start: f64, signal: usize, sample: (f64, f64)) -> bool {
        for slot in &mut self.slots {
            if slot.signal == signal {
                slot.push(sample);
            }
        }
        self.process(start)
    }

    /// Computes the functions up to the last sample of the slowest signal.
    pub(crate) fn process(&mut self, start: f64) -> bool {
        let known = self.slots.iter().map(Samples::last_time).fold(f64::INFINITY, f64::min);
        if !known.is_finite() || known < start {
            return false;
        }
        let mut changed = false;
        if self.functions.is_none() {
            self.slots.iter_mut().for_each(|slot| slot.pass(start));
            self.lines_at(start);
            let value = self.comparison.expression.value(&self.lines);
            let (margin, truth) = self.comparison.point(value);
            self.functions =
                Some([margin, truth].map(|value| Function::starting(Knot::flat(start, value))));
            changed = true;
        }
        loop {
            let time = self.progress();
            if time >= known {
                return changed;
            }
            let next = self.slots.iter().map(Samples::next_time).fold(f64::INFINITY, f64::min);
            if !next.is_finite() {
                return changed;
            }
            changed |= self.piece(time, next);
        }
    }

    /// The functions from one sample to the next.
    fn piece(&mut self, from: f64, to: f64) -> bool {
        self.lines.clear();
        for (leaf, place) in self.comparison.leaves.iter().zip(&self.places) {
            let slot = &self.slots[*place];
            self.lines.push([slot.value(leaf.is_held, from), slot.value(leaf.is_held, to)]);
        }
        let mut parts = std::mem::take(&mut self.parts);
        self.comparison.expression.parts(&self.lines, to - from, &mut parts);
        self.slots.iter_mut().for_each(|slot| slot.pass(to));
        let mut changed = false;
        let mut time = from;
        for (index, (fraction, line)) in parts.iter().enumerate() {
            let is_last = index + 1 == parts.len();
            let end = if is_last { to } else { from + (to - from) * fraction };
            if end > time {
                changed |= self.append(time, end, *line);
                time = end;
            }
        }
        self.parts = parts;
        changed | self.append_point(to)
    }

    /// Appends a line of the difference to the functions.
    fn append(&mut self, from: f64, to: f64, line: Line) -> bool {
        self.knots += 1;
        let line = match line {
            // The value before one that is not finite is held.
            [start, end] if start.is_finite() && !end.is_finite() => [start; 2],
            [start, _] if !start.is_finite() => {
                return self.append_margin((from, to), [self.comparison.point(start).0; 2], None);
            }
            line => line,
        };
        let margin = line.map(|value| self.comparison.margin(value));
        let middle = from + (to - from) * line[0] / (line[0] - line[1]);
        if line[0] * line[1] >= 0.0 || middle <= from || middle >= to {
            return self.append_margin((from, to), margin, None);
        }
        if self.comparison.is_absolute() {
            return self.append_margin((from, middle), [margin[0], 0.0], None)
                | self.append_margin((middle, to), [0.0, margin[1]], None);
        }
        self.append_margin((from, to), margin, Some(middle))
    }

    /// Appends a line of the margin; `crossing` is the time at which it crosses 0.
    fn append_margin(&mut self, range: (f64, f64), line: Line, crossing: Option<f64>) -> bool {
        let (_, to) = range;
        let [start, end] = line;
        // A line that begins or ends at 0 is on one side of it otherwise.
        let left = self.comparison.truth(if start == 0.0 { end } else { start });
        let mut right = self.comparison.truth(if end == 0.0 { start } else { end });
        let [at_zero, at_start, at_end] =
            [0.0, start, end].map(|margin| self.comparison.truth(margin));
        let is_rate = self.has_rate;
        let Some([margin, truth]) = &mut self.functions else { return false };
        let last = margin.last_mut();
        last.right = start;
        if is_rate {
            last.at = start;
        }
        margin.push(Knot::flat(to, end));
        let last = truth.last_mut();
        let before = last.at;
        last.right = left;
        if is_rate {
            last.at = at_start;
        }
        match crossing {
            Some(time) => truth.push(Knot { time, left, at: at_zero, right }),
            None => right = left,
        }
        truth.push(Knot { time: to, left: right, at: at_end, right: at_end });
        [left, right, at_end].iter().any(|side| (*side > 0.0) != (before > 0.0))
    }

    /// Sets the value at the time of the last sample.
    fn append_point(&mut self, time: f64) -> bool {
        if self.has_rate {
            return false;
        }
        let is_continuous = self.is_linear && self.slots.iter().all(Samples::is_finite);
        if is_continuous
            && let Some([margin, _]) = &self.functions
            && margin.last().left.is_finite()
        {
            return false;
        }
        self.lines_at(time);
        let value = self.comparison.expression.value(&self.lines);
        let (value, truth_value) = self.comparison.point(value);
        let Some([margin, truth]) = &mut self.functions else { return false };
        let last = margin.last_mut();
        (last.at, last.right) = (value, value);
        let last = truth.last_mut();
        (last.at, last.right) = (truth_value, truth_value);
        (last.left > 0.0) != (truth_value > 0.0)
    }

    /// The values of the leaves at the time of the current samples, or between them.
    fn lines_at(&mut self, time: f64) {
        self.lines.clear();
        for (leaf, place) in self.comparison.leaves.iter().zip(&self.places) {
            let slot = &self.slots[*place];
            self.lines.push([slot.value(leaf.is_held, time); 2]);
        }
    }

    /// A function on an interval that begins after the start of the trace. For an edge, a held
    /// value is also known directly after the last sample.
    pub(crate) fn function(
        &self,
        kind: Kind,
        range: (f64, f64),
        extension: Option<Extension>,
        is_edge: bool,
    ) -> Function {
        let (from, to) = range;
        let Some(functions) = &self.functions else {
            return Function::constant(from, to, extension_value(extension, f64::NEG_INFINITY));
        };
        let function = &functions[usize::from(kind == Kind::Truth)];
        let known = function.to();
        let last = function.value(known);
        if self.slots.is_empty() {
            return Function::constant(from, to, last);
        }
        let unknown = extension_value(extension, last);
        if from > known {
            return Function::constant(from, to, unknown);
        }
        let mut part = function.slice(from, to.min(known));
        if to < known || extension.is_none() {
            return part.extended(to, last);
        }
        let end = part.last_mut();
        if self.has_rate {
            end.at = unknown;
        }
        let is_known = is_edge && self.is_held;
        end.right = if is_known { end.at } else { unknown };
        let soon = known.next_up();
        if is_known && soon < to {
            part.push(Knot { time: soon, left: last, at: unknown, right: unknown });
        }
        part.extended(to, unknown)
    }

    /// The values of its signals at a time that is kept.
    pub(crate) fn values(&self, time: f64) -> Vec<SignalValue> {
        let value = |(leaf, place): (&Leaf, &usize)| {
            let slot = &self.slots[*place];
            let time = time.min(slot.last_time());
            SignalValue { signal: leaf.signal, time, value: slot.past_value(leaf.is_held, time) }
        };
        self.comparison.leaves.iter().zip(&self.places).map(value).collect()
    }

    /// From which time on the functions are kept.
    pub(crate) fn kept_from(&self, start: f64) -> f64 {
        if self.slots.is_empty() {
            return start;
        }
        self.functions.as_ref().map_or(start, |[margin, _]| margin.from())
    }

    /// Forgets what is before a time.
    pub(crate) fn forget(&mut self, time: f64) {
        for function in self.functions.iter_mut().flatten() {
            function.forget(time);
        }
        for slot in &mut self.slots {
            slot.forget(time);
        }
    }
}

fn extension_value(extension: Option<Extension>, last: f64) -> f64 {
    match extension {
        Some(Extension::Value(value)) => value,
        Some(Extension::Unchanged) | None => last,
    }
}
