//! The supremum of a function over a window that slides with time.
//!
//! Between two times at which an end of the window meets a knot, the supremum is the greatest of
//! two lines (the function at the ends of the window) and a constant (the knots inside). A queue of
//! decreasing values has the knots inside, as in D. Lemire, *Streaming maximum-minimum filter using
//! no more than three comparisons per element*, 2006.

use std::collections::VecDeque;

use super::{Function, Knot};

/// A window relative to the time, which may begin and end before it; and the times of the result.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Bounds {
    /// Where the window begins, in seconds relative to the time.
    pub start: f64,
    /// Where it ends; not less than `start`.
    pub end: f64,
    /// The first time of the result.
    pub from: f64,
    /// The last time of the result.
    pub to: f64,
}

/// The supremum over the part of the window that is within the interval of the function; `-inf` if
/// there is none.
pub(crate) fn supremum(function: &Function, bounds: Bounds) -> Function {
    let mut sweep = Sweep {
        knots: &function.knots,
        function,
        bounds,
        entered: 0,
        left: 0,
        inside: VecDeque::new(),
    };
    sweep.skip_to(bounds.from);
    sweep.run()
}

/// What determines the supremum on a part of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Source {
    /// The line after this knot, at the start of the window.
    Start(usize),
    /// The line after this knot, at the end of the window.
    End(usize),
    /// The knots inside.
    Inside(f64),
}

/// A line on the time between two events.
#[derive(Clone, Copy, Debug)]
struct Line {
    source: Source,
    start: f64,
    end: f64,
}

struct Sweep<'a> {
    knots: &'a [Knot],
    function: &'a Function,
    bounds: Bounds,
    /// How many knots the end of the window has passed.
    entered: usize,
    /// How many knots the start of the window has passed.
    left: usize,
    /// The knots inside the window that may become the greatest, and their values.
    inside: VecDeque<(usize, f64)>,
}

impl Sweep<'_> {
    /// Moves the window to a time; knots at its ends are not passed.
    fn skip_to(&mut self, time: f64) {
        while self.entry(self.entered) < time {
            self.enter();
        }
        while self.exit(self.left) < time {
            self.leave();
        }
    }

    /// When the end of the window meets a knot.
    fn entry(&self, index: usize) -> f64 {
        let Some(knot) = self.knots.get(index) else { return f64::INFINITY };
        let Bounds { end, from, .. } = self.bounds;
        let time = knot.time - end;
        // The function begins where the first window ends, apart from rounding.
        let is_first =
            index == 0 && (time - from).abs() <= 4.0 * f64::EPSILON * (knot.time.abs() + end.abs());
        if is_first { from } else { time }
    }

    /// When the start of the window meets a knot.
    fn exit(&self, index: usize) -> f64 {
        let Some(knot) = self.knots.get(index) else { return f64::INFINITY };
        let time = knot.time - self.bounds.start;
        // No window begins after the function ends, apart from rounding.
        if index + 1 == self.knots.len() { time.max(self.bounds.to) } else { time }
    }

    fn enter(&mut self) {
        let knot = &self.knots[self.entered];
        let mut value = knot.at;
        if self.entered > 0 {
            value = value.max(knot.left);
        }
        if self.entered + 1 < self.knots.len() {
            value = value.max(knot.right);
        }
        while self.inside.back().is_some_and(|(_, last)| *last <= value) {
            self.inside.pop_back();
        }
        self.inside.push_back((self.entered, value));
        self.entered += 1;
    }

    fn leave(&mut self) {
        if self.inside.front().is_some_and(|(index, _)| *index == self.left) {
            self.inside.pop_front();
        }
        self.left += 1;
    }

    fn run(&mut self) -> Function {
        let Bounds { from, to, .. } = self.bounds;
        let first = self.point(from);
        self.pass(from);
        let mut result = Function::starting(Knot::flat(from, first));
        let mut time = from;
        let mut pending: Option<(Knot, Source)> = None;
        while time < to {
            let next = self.entry(self.entered).min(self.exit(self.left)).min(to);
            let envelope = Envelope::new(self.lines(time, next));
            if let Some((knot, source)) = pending.take() {
                // A limit may leave the window when another one enters it.
                if knot.at != knot.left || envelope.first.source != source {
                    result.push(Knot { right: envelope.first.start, ..knot });
                }
            } else {
                result.last_mut().right = envelope.first.start;
            }
            for (fraction, value) in envelope.bends() {
                result.push(Knot::flat(time + (next - time) * fraction, *value));
            }
            let Line { end, source, .. } = envelope.last;
            let at = self.point(next);
            self.pass(next);
            pending = Some((Knot { time: next, left: end, at, right: at }, source));
            time = next;
        }
        if let Some((knot, _)) = pending {
            result.push(knot);
        }
        result
    }

    /// Passes the knots at the ends of the window.
    fn pass(&mut self, time: f64) {
        while self.entry(self.entered) <= time {
            self.enter();
        }
        while self.exit(self.left) <= time {
            self.leave();
        }
    }

    /// The supremum at a time, at which the ends of the window may be at knots not yet passed.
    fn point(&self, time: f64) -> f64 {
        let mut value = f64::NEG_INFINITY;
        let meets_entry = self.entry(self.entered) <= time;
        let meets_exit = self.exit(self.left) <= time;
        let first = self.left + usize::from(meets_exit);
        for (index, inside) in self.inside.iter().take(2) {
            if *index >= first {
                value = value.max(*inside);
            }
        }
        if meets_exit {
            let knot = &self.knots[self.left];
            value = value.max(knot.at);
            if self.bounds.end > self.bounds.start && self.left + 1 < self.knots.len() {
                value = value.max(knot.right);
            }
        } else if let Some(line) = self.start_line() {
            value = value.max(self.function.between(line, time + self.bounds.start));
        }
        if meets_entry {
            let knot = &self.knots[self.entered];
            value = value.max(knot.at);
            if self.bounds.end > self.bounds.start && self.entered > 0 {
                value = value.max(knot.left);
            }
        } else if let Some(line) = self.end_line() {
            value = value.max(self.function.between(line, time + self.bounds.end));
        }
        value
    }

    /// The line at the start of the window, as the index of the knot before it.
    fn start_line(&self) -> Option<usize> {
        (self.left > 0 && self.left < self.knots.len()).then(|| self.left - 1)
    }

    fn end_line(&self) -> Option<usize> {
        (self.entered > 0 && self.entered < self.knots.len()).then(|| self.entered - 1)
    }

    /// The lines between two events.
    fn lines(&self, time: f64, next: f64) -> [Option<Line>; 3] {
        let line = |index: usize, offset: f64, source: Source| Line {
            source,
            start: self.function.between(index, time + offset),
            end: self.function.between(index, next + offset),
        };
        let Bounds { start, end, .. } = self.bounds;
        [
            self.start_line().map(|index| line(index, start, Source::Start(index))),
            self.end_line().map(|index| line(index, end, Source::End(index))),
            self.inside.front().map(|(_, value)| Line {
                source: Source::Inside(*value),
                start: *value,
                end: *value,
            }),
        ]
    }
}

/// The supremum over an empty window.
const NOTHING: Line = Line {
    source: Source::Inside(f64::NEG_INFINITY),
    start: f64::NEG_INFINITY,
    end: f64::NEG_INFINITY,
};

/// The greatest of lines.
struct Envelope {
    /// The line that is the greatest at the start.
    first: Line,
    /// The line that is the greatest at the end.
    last: Line,
    /// Where another line becomes the greatest: the fraction of the time, and the value.
    bends: [(f64, f64); 2],
    /// How many of them there are.
    count: usize,
}

impl Envelope {
    fn new(lines: [Option<Line>; 3]) -> Self {
        let order = |left: &Line, right: &Line| {
            left.start.total_cmp(&right.start).then(left.end.total_cmp(&right.end))
        };
        let first = lines.iter().flatten().copied().max_by(order).unwrap_or(NOTHING);
        let mut envelope = Self { first, last: first, bends: [(0.0, 0.0); 2], count: 0 };
        while envelope.count < 2 {
            let current = envelope.last;
            // Of the lines that are greater at the end, the one that crosses first.
            let crossing = |line: &Line| {
                let (below, above) = (current.start - line.start, line.end - current.end);
                (if below > 0.0 { below / (below + above) } else { 0.0 }, *line)
            };
            let greater = lines.iter().flatten().filter(|line| line.end > current.end);
            let next = greater.map(crossing).min_by(|left, right| {
                left.0.total_cmp(&right.0).then(right.1.end.total_cmp(&left.1.end))
            });
            let Some((fraction, line)) = next else { break };
            let reached = envelope.bends().last().map_or(0.0, |bend| bend.0);
            if fraction > reached && fraction < 1.0 {
                let value = current.start + (current.end - current.start) * fraction;
                envelope.bends[envelope.count] = (fraction, value);
                envelope.count += 1;
            } else if envelope.count == 0 {
                envelope.first = line;
            }
            envelope.last = line;
        }
        envelope
    }

    fn bends(&self) -> &[(f64, f64)] {
        &self.bends[..self.count]
    }
}
