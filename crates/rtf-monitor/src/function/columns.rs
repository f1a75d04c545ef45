//! The times at which one of two functions has a knot.

use super::{Function, Knot};

/// The knots of both functions at a time, some of which are within lines.
pub(super) struct Column {
    pub time: f64,
    pub knots: [Knot; 2],
    /// Whether the functions have a knot here.
    pub own: [bool; 2],
}

/// Goes through the knots of two functions on the same interval, apart from rounding.
pub(super) struct Columns<'a> {
    functions: [&'a Function; 2],
    /// The next knot of each function.
    next: [usize; 2],
}

impl<'a> Columns<'a> {
    pub fn new(functions: [&'a Function; 2]) -> Self {
        Self { functions, next: [0, 0] }
    }

    pub fn has_next(&self) -> bool {
        (0..2).any(|index| self.next[index] < self.functions[index].knots.len())
    }

    /// The next time at which a function has a knot.
    pub fn advance(&mut self) -> Column {
        let time_of = |index: usize| {
            let knots = &self.functions[index].knots;
            knots.get(self.next[index]).map_or(f64::INFINITY, |knot| knot.time)
        };
        let time = time_of(0).min(time_of(1));
        let own = [time_of(0) <= time, time_of(1) <= time];
        let knots = [0, 1].map(|index| {
            let (function, next) = (self.functions[index], self.next[index]);
            let last = function.knots.len() - 1;
            if own[index] {
                function.knots[next]
            } else if next == 0 || next > last {
                Knot { time, ..function.knots[next.min(last)] }
            } else {
                Knot::flat(time, function.between(next - 1, time))
            }
        });
        for (next, own) in self.next.iter_mut().zip(own) {
            *next += usize::from(own);
        }
        Column { time, knots, own }
    }
}
