//! The least and greatest of two functions.

use super::columns::{Column, Columns};
use super::{Function, Knot};

/// The least of two functions on the same interval.
pub(crate) fn least(left: &Function, right: &Function) -> Function {
    Merge { sign: 1.0, functions: [left, right] }.run()
}

/// The greatest of two functions on the same interval.
pub(crate) fn greatest(left: &Function, right: &Function) -> Function {
    Merge { sign: -1.0, functions: [left, right] }.run()
}

/// A merge of the knots of two functions. With the sign -1, the greatest replaces the least.
struct Merge<'a> {
    sign: f64,
    functions: [&'a Function; 2],
}

impl Merge<'_> {
    fn run(&self) -> Function {
        let mut columns = Columns::new(self.functions);
        let first = columns.advance();
        let mut active = self.lower(first.knots.map(|knot| knot.right), 0);
        let mut result = Function::starting(self.knot(&first));
        let mut previous = first;
        // The last knot, if it was within the line of the lower function.
        let mut omitted = None;
        while columns.has_next() {
            let column = columns.advance();
            let start = previous.knots.map(|knot| knot.right);
            let end = column.knots.map(|knot| knot.left);
            let before = self.lower(start, active);
            let after = self.lower(end, before);
            let mut is_bend = false;
            if before != after {
                // Where the lines cross, the other function continues.
                let (near, far) = (start[after] - start[before], end[before] - end[after]);
                let fraction = near / (near + far);
                let time = previous.time + (column.time - previous.time) * fraction;
                let value = start[before] + (end[before] - start[before]) * fraction;
                if time <= previous.time {
                    omitted.take().into_iter().for_each(|knot| result.push(knot));
                } else if time < column.time {
                    result.push(Knot::flat(time, value));
                } else {
                    is_bend = true;
                }
            }
            let following = self.lower(column.knots.map(|knot| knot.right), after);
            let is_within = following == after
                && !is_bend
                && !column.own[after]
                && self.lower(column.knots.map(|knot| knot.at), after) == after;
            if is_within && columns.has_next() {
                omitted = Some(self.knot(&column));
            } else {
                omitted = None;
                result.push(self.knot(&column));
            }
            active = following;
            previous = column;
        }
        result
    }

    /// The index of the lower value; `tied` if they are equal.
    fn lower(&self, values: [f64; 2], tied: usize) -> usize {
        let other = 1 - tied;
        if self.sign * values[other] < self.sign * values[tied] { other } else { tied }
    }

    fn knot(&self, column: &Column) -> Knot {
        let pick = |values: [f64; 2]| values[self.lower(values, 0)];
        let [first, second] = &column.knots;
        Knot {
            time: column.time,
            left: pick([first.left, second.left]),
            at: pick([first.at, second.at]),
            right: pick([first.right, second.right]),
        }
    }
}
