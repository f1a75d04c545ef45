//! `until` and `since` without an interval.
//!
//! From the end backwards: on a line of both operands, the result is the median-like combination of
//! three lines, whose kinks are where two of them cross.

use super::columns::{Column, Columns};
use super::{Function, Knot, crossing, interpolate};

/// `condition until goal` on their common interval. `end` is the value of the result directly after
/// the interval.
pub(crate) fn until(condition: &Function, goal: &Function, end: f64) -> Function {
    // The knots are collected from the last to the first, on the negative time.
    let mut remaining = Columns::new([condition, goal]);
    let mut columns = Vec::with_capacity(condition.knots.len() + goal.knots.len());
    while remaining.has_next() {
        columns.push(remaining.advance());
    }
    let last = columns.len() - 1;
    let mut value = at(&columns[last], end);
    let knot = Knot { time: -columns[last].time, left: end, at: value, right: value };
    let mut result = Function::starting(knot);
    for index in (0..last).rev() {
        let (near, far) = (&columns[index], &columns[index + 1]);
        let piece = Piece {
            condition: [near.knots[0].right, far.knots[0].left],
            goal: [near.knots[1].right, far.knots[1].left],
            after: value,
        };
        let duration = far.time - near.time;
        let lines = piece.lines();
        result.last_mut().right = piece.value(&lines, 1.0);
        for fraction in bends(&lines).into_iter().filter(|fraction| *fraction > 0.0) {
            let time = near.time + duration * fraction;
            result.push(Knot::flat(-time, piece.value(&lines, fraction)));
        }
        let limit = piece.value(&lines, 0.0);
        value = at(near, limit);
        // In reversed time, the limit from the right comes first.
        result.push(Knot { time: -near.time, left: limit, at: value, right: value });
    }
    result.reversed()
}

/// `condition since goal`; `before` is the value of the result directly before the interval.
pub(crate) fn since(condition: &Function, goal: &Function, before: f64) -> Function {
    until(&condition.clone().reversed(), &goal.clone().reversed(), before).reversed()
}

/// The value at a knot, if `after` is the limit of the result from the right.
fn at(column: &Column, after: f64) -> f64 {
    let [condition, goal] = &column.knots;
    goal.at.max(after).min(condition.at)
}

/// The functions between two knots.
struct Piece {
    condition: [f64; 2],
    goal: [f64; 2],
    /// The result at the end of the piece, which is not part of it.
    after: f64,
}

impl Piece {
    /// Lines whose combination is the result: the condition, the goal or the constant that replaces
    /// it, and a constant.
    fn lines(&self) -> [[f64; 2]; 3] {
        let [start, end] = self.condition;
        if end >= start {
            // The least value of the condition is at the time of judgement.
            return [self.condition, self.goal, [self.goal[1].max(self.after); 2]];
        }
        let rest = end.min(self.after);
        let goal = if self.goal[1] > self.goal[0] { [self.peak(); 2] } else { self.goal };
        [self.condition, goal, [rest; 2]]
    }

    /// The result at a fraction of the time.
    fn value(&self, lines: &[[f64; 2]; 3], fraction: f64) -> f64 {
        let [condition, goal, rest] =
            lines.map(|[start, end]| interpolate((0.0, start), (1.0, end), fraction));
        if self.condition[1] >= self.condition[0] {
            condition.min(goal.max(rest))
        } else {
            condition.min(goal).max(rest)
        }
    }

    /// The greatest of min(goal, condition), if the condition falls and the goal rises: where they
    /// cross, or beyond each value of the condition.
    fn peak(&self) -> f64 {
        if self.goal[1] <= self.condition[1] {
            return self.goal[1];
        }
        match crossing(self.condition, self.goal) {
            Some(fraction) => interpolate((0.0, self.goal[0]), (1.0, self.goal[1]), fraction),
            None => f64::INFINITY,
        }
    }
}

/// Where two of the lines cross, as decreasing fractions of the time; 0 if they do not.
fn bends(lines: &[[f64; 2]; 3]) -> [f64; 3] {
    let [first, second, third] = *lines;
    let mut bends = [(first, second), (first, third), (second, third)]
        .map(|(left, right)| crossing(left, right).unwrap_or(0.0));
    bends.sort_unstable_by(|left, right| right.total_cmp(left));
    bends
}
