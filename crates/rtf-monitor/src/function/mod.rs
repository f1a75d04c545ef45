//! Piecewise-linear functions of time with jumps and single points: the robustness of a formula.

mod columns;
mod combine;
mod up_to;
mod window;

pub(crate) use combine::{greatest, least};
pub(crate) use up_to::{since, until};
pub(crate) use window::{Bounds, supremum};

use crate::syntax::Quantifier;

/// A time at which a function may change its slope or jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Knot {
    /// Seconds.
    pub time: f64,
    /// The limit from the left.
    pub left: f64,
    /// The value.
    pub at: f64,
    /// The limit from the right.
    pub right: f64,
}

impl Knot {
    /// A knot without a jump.
    pub(crate) fn flat(time: f64, value: f64) -> Self {
        Self { time, left: value, at: value, right: value }
    }
}

/// A function on a closed interval of time, which may be a single point. Between knots it is
/// linear; a line whose ends are infinite is constant. The limits outside of the interval, `left`
/// of the first and `right` of the last knot, are only used by [`Function::before`] and
/// [`Function::after`].
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Function {
    /// At least one, with increasing times.
    knots: Vec<Knot>,
}

impl Function {
    pub(crate) fn constant(from: f64, to: f64, value: f64) -> Self {
        let mut function = Self::starting(Knot::flat(from, value));
        if from < to {
            function.push(Knot::flat(to, value));
        }
        function
    }

    /// A function at a point; [`Function::push`] continues it.
    pub(crate) fn starting(knot: Knot) -> Self {
        Self { knots: vec![knot] }
    }

    /// Appends a knot, whose time is later than that of the last one, and removes knots within a
    /// constant. Restores the order if rounding made the times equal.
    #[expect(clippy::float_cmp, reason = "only values that are exactly equal are redundant")]
    pub(crate) fn push(&mut self, knot: Knot) {
        let last = self.knots.len() - 1;
        let previous = self.knots[last];
        if knot.time <= previous.time {
            self.knots[last].right = knot.right;
            return;
        }
        let is_flat = previous.left == previous.at && previous.at == previous.right;
        if last > 0
            && is_flat
            && self.knots[last - 1].right == previous.left
            && previous.right == knot.left
        {
            self.knots[last] = knot;
        } else {
            self.knots.push(knot);
        }
    }

    pub(crate) fn knots(&self) -> &[Knot] {
        &self.knots
    }

    pub(crate) fn first_mut(&mut self) -> &mut Knot {
        &mut self.knots[0]
    }

    pub(crate) fn last(&self) -> &Knot {
        &self.knots[self.knots.len() - 1]
    }

    pub(crate) fn last_mut(&mut self) -> &mut Knot {
        let last = self.knots.len() - 1;
        &mut self.knots[last]
    }

    pub(crate) fn from(&self) -> f64 {
        self.knots[0].time
    }

    pub(crate) fn to(&self) -> f64 {
        self.knots[self.knots.len() - 1].time
    }

    /// The value at a time, or at the nearest end of the interval.
    pub(crate) fn value(&self, time: f64) -> f64 {
        let next = self.knots.partition_point(|knot| knot.time < time);
        match self.knots.get(next) {
            None => self.knots[self.knots.len() - 1].at,
            Some(knot) if next == 0 || knot.time <= time => knot.at,
            Some(_) => self.between(next - 1, time),
        }
    }

    /// The line after a knot, at a time.
    pub(crate) fn between(&self, index: usize, time: f64) -> f64 {
        let (start, end) = (&self.knots[index], &self.knots[index + 1]);
        interpolate((start.time, start.right), (end.time, end.left), time)
    }

    pub(crate) fn negated(mut self) -> Self {
        for knot in &mut self.knots {
            (knot.left, knot.at, knot.right) = (-knot.left, -knot.at, -knot.right);
        }
        self
    }

    /// The part in an interval within that of the function.
    pub(crate) fn restricted(self, from: f64, to: f64) -> Self {
        if self.from() >= from && self.to() <= to { self } else { self.slice(from, to) }
    }

    /// A copy of the part in an interval within that of the function.
    pub(crate) fn slice(&self, from: f64, to: f64) -> Self {
        let mut part = Self::starting(self.knot_at(from));
        let first = self.knots.partition_point(|knot| knot.time <= from);
        for knot in self.knots[first..].iter().take_while(|knot| knot.time < to) {
            part.push(*knot);
        }
        if from < to {
            part.push(self.knot_at(to));
        }
        part
    }

    /// Forgets the part before a time, apart from what the value at this time needs.
    pub(crate) fn forget(&mut self, time: f64) {
        let count = self.knots.partition_point(|knot| knot.time <= time).saturating_sub(1);
        self.knots.drain(..count);
    }

    /// A knot at any time of the interval.
    fn knot_at(&self, time: f64) -> Knot {
        let next = self.knots.partition_point(|knot| knot.time < time);
        match self.knots.get(next) {
            None => Knot { time, ..self.knots[self.knots.len() - 1] },
            Some(knot) if next == 0 || knot.time <= time => Knot { time, ..*knot },
            Some(_) => Knot::flat(time, self.between(next - 1, time)),
        }
    }

    /// The same, continued up to a later time with a constant.
    pub(crate) fn extended(mut self, to: f64, value: f64) -> Self {
        if self.to() < to {
            self.last_mut().right = value;
            self.push(Knot::flat(to, value));
        }
        self
    }

    /// The limit from the left, in place of the value.
    pub(crate) fn before(mut self) -> Self {
        for knot in &mut self.knots {
            knot.at = knot.left;
        }
        self
    }

    /// The limit from the right, in place of the value.
    pub(crate) fn after(mut self) -> Self {
        for knot in &mut self.knots {
            knot.at = knot.right;
        }
        self
    }

    /// The function of the negative time.
    pub(crate) fn reversed(mut self) -> Self {
        self.knots.reverse();
        for knot in &mut self.knots {
            knot.time = -knot.time;
            std::mem::swap(&mut knot.left, &mut knot.right);
        }
        self
    }

    /// The values and limits within the interval, with their times.
    pub(crate) fn values(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        let last = self.knots.len() - 1;
        self.knots.iter().enumerate().flat_map(move |(index, knot)| {
            let left = (index > 0).then_some((knot.time, knot.left));
            let right = (index < last).then_some((knot.time, knot.right));
            left.into_iter().chain([(knot.time, knot.at)]).chain(right)
        })
    }

    /// The infimum, and the first time at which it is a value or limit.
    pub(crate) fn minimum(&self) -> (f64, f64) {
        let least = self.values().reduce(|least, next| if next.1 < least.1 { next } else { least });
        least.unwrap_or((self.from(), f64::INFINITY))
    }

    /// The supremum and the first time at which it is a value or limit.
    pub(crate) fn maximum(&self) -> (f64, f64) {
        let most = self.values().reduce(|most, next| if next.1 > most.1 { next } else { most });
        most.unwrap_or((self.from(), f64::NEG_INFINITY))
    }

    /// The infimum for [`Quantifier::All`], otherwise the supremum, with its time.
    pub(crate) fn extreme(&self, quantifier: Quantifier) -> (f64, f64) {
        match quantifier {
            Quantifier::All => self.minimum(),
            Quantifier::Some => self.maximum(),
        }
    }

    /// The interval with negative values or limits that contains a time.
    pub(crate) fn negative_around(&self, time: f64) -> (f64, f64) {
        let (mut from, mut to) = (time, time);
        for pair in self.knots.windows(2) {
            let is_negative = pair[0].right < 0.0 && pair[1].left < 0.0;
            if is_negative && pair[0].time <= to && pair[1].time >= from {
                from = from.min(pair[0].time);
                to = to.max(pair[1].time);
            }
        }
        // Intervals before the time are found from the last to the first.
        for pair in self.knots.windows(2).rev() {
            let is_negative = pair[0].right < 0.0 && pair[1].left < 0.0 && pair[1].at < 0.0;
            if is_negative && pair[1].time >= from && pair[0].time <= from {
                from = pair[0].time;
            }
        }
        (from, to)
    }
}

/// A line through two points, at a time between them.
#[expect(clippy::float_cmp, reason = "equal ends, also infinite ones, are a constant")]
pub(crate) fn interpolate(start: (f64, f64), end: (f64, f64), time: f64) -> f64 {
    if start.1 == end.1 || time <= start.0 {
        return start.1;
    }
    if time >= end.0 {
        return end.1;
    }
    let fraction = (time - start.0) / (end.0 - start.0);
    start.1 + (end.1 - start.1) * fraction
}

/// The fraction of the time at which two lines cross, unless they only meet at an end.
pub(crate) fn crossing(left: [f64; 2], right: [f64; 2]) -> Option<f64> {
    let (start, end) = (left[0] - right[0], left[1] - right[1]);
    let crosses = (start < 0.0 && end > 0.0) || (start > 0.0 && end < 0.0);
    let fraction = start / (start - end);
    (crosses && fraction > 0.0 && fraction < 1.0).then_some(fraction)
}
