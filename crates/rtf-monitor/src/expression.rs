//! Arithmetic of signals on a part of time where each signal is linear.

use crate::function::crossing;
use crate::syntax::{Arithmetic, Comparison, Extreme, Number};

/// The values at the start and end of a line.
pub(crate) type Line = [f64; 2];

/// A crossing closer to an end, relative to the length of the line, is the end.
const RESOLUTION: f64 = 1e-12;

/// How often a line, and a part of it again, may be divided; more would be rounding. A quotient of two
/// signals is not linear, so that its absolute value may have a kink in each part.
const MAX_DIVISIONS: usize = 64;

/// An expression of leaves: signals, either linear or held.
#[derive(Clone, Debug)]
pub(crate) enum Expression {
    Constant(f64),
    Leaf(usize),
    Rate(Box<Expression>),
    Negative(Box<Expression>),
    Absolute(Box<Expression>),
    Extreme(Extreme, Vec<Expression>),
    Operation(Arithmetic, Box<[Expression; 2]>),
}

/// A signal of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Leaf {
    /// Its index in the formula.
    pub signal: usize,
    /// Whether a sample is held until the next one.
    pub is_held: bool,
}

/// A stretch of a line, as fractions of the whole.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    from: f64,
    to: f64,
    /// How often the line was divided for it.
    divisions: usize,
}

/// A part of a line: its end as a fraction of the whole, and the values at its ends.
pub(crate) type Part = (f64, Line);

impl Expression {
    /// The difference of the sides of a comparison: above 0 if `<` or `>` holds.
    pub(crate) fn difference(
        comparison: Comparison,
        sides: &[Number; 2],
        leaves: &mut Vec<Leaf>,
    ) -> Self {
        let [left, right] = [0, 1].map(|index| Self::new(&sides[index], leaves));
        let sides = match comparison {
            Comparison::Greater | Comparison::GreaterOrEqual => [left, right],
            _ => [right, left],
        };
        Self::Operation(Arithmetic::Subtract, Box::new(sides))
    }

    /// The margin of a signal as a condition.
    pub(crate) fn truth(index: usize, leaves: &mut Vec<Leaf>) -> Self {
        let leaf = Self::leaf(Leaf { signal: index, is_held: true }, leaves);
        Self::Operation(Arithmetic::Subtract, Box::new([leaf, Self::Constant(0.5)]))
    }

    fn leaf(leaf: Leaf, leaves: &mut Vec<Leaf>) -> Self {
        let known = leaves.iter().position(|known| *known == leaf);
        Self::Leaf(known.unwrap_or_else(|| {
            leaves.push(leaf);
            leaves.len() - 1
        }))
    }

    fn new(number: &Number, leaves: &mut Vec<Leaf>) -> Self {
        let mut boxed = |inner: &Number| Box::new(Self::new(inner, leaves));
        match number {
            Number::Literal { value, .. } => Self::Constant(*value),
            Number::Signal { index, .. } => {
                Self::leaf(Leaf { signal: *index, is_held: false }, leaves)
            }
            Number::Hold { index, .. } => {
                Self::leaf(Leaf { signal: *index, is_held: true }, leaves)
            }
            Number::Rate { inner, .. } => Self::Rate(boxed(inner)),
            Number::Negative { inner, .. } => Self::Negative(boxed(inner)),
            Number::Absolute { inner, .. } => Self::Absolute(boxed(inner)),
            Number::Extreme { which, parts, .. } => {
                Self::Extreme(*which, parts.iter().map(|part| Self::new(part, leaves)).collect())
            }
            Number::Operation { operation, sides, .. } => {
                let [left, right] = sides.as_ref();
                let sides = [Self::new(left, leaves), Self::new(right, leaves)];
                Self::Operation(*operation, Box::new(sides))
            }
        }
    }

    pub(crate) fn has_rate(&self) -> bool {
        match self {
            Self::Constant(_) | Self::Leaf(_) => false,
            Self::Rate(_) => true,
            Self::Negative(inner) | Self::Absolute(inner) => inner.has_rate(),
            Self::Extreme(_, parts) => parts.iter().any(Self::has_rate),
            Self::Operation(_, sides) => sides.iter().any(Self::has_rate),
        }
    }

    /// The value at a time, from the values of the leaves. A rate is 0.
    pub(crate) fn value(&self, leaves: &[Line]) -> f64 {
        self.line(leaves, 1.0, &mut None)[0]
    }

    /// Divides a line of the leaves, which lasts `duration` seconds, into parts on which the
    /// expression is linear.
    pub(crate) fn parts(&self, leaves: &[Line], duration: f64, parts: &mut Vec<Part>) {
        parts.clear();
        let mut split = None;
        let line = self.line(leaves, duration, &mut split);
        match split {
            None => parts.push((1.0, line)),
            Some(_) => {
                let whole = Stretch { from: 0.0, to: 1.0, divisions: 0 };
                self.divide(leaves, duration, whole, parts);
            }
        }
    }

    fn divide(&self, leaves: &[Line], duration: f64, stretch: Stretch, parts: &mut Vec<Part>) {
        let Stretch { from, to, divisions } = stretch;
        let part: Vec<Line> = leaves
            .iter()
            .map(|[start, end]| {
                let at = |fraction: f64| {
                    if fraction >= 1.0 { *end } else { start + (end - start) * fraction }
                };
                [at(from), at(to)]
            })
            .collect();
        let mut split = None;
        let line = self.line(&part, duration * (to - from), &mut split);
        match split.map(|split| from + (to - from) * split) {
            Some(middle)
                if middle > from && middle < to && parts.len().max(divisions) < MAX_DIVISIONS =>
            {
                let divisions = divisions + 1;
                let halves = [
                    Stretch { to: middle, divisions, ..stretch },
                    Stretch { from: middle, divisions, ..stretch },
                ];
                for half in halves {
                    self.divide(leaves, duration, half, parts);
                }
            }
            _ => parts.push((to, line)),
        }
    }

    /// The values at the ends; `split` is the first fraction at which it has a kink.
    fn line(&self, leaves: &[Line], duration: f64, split: &mut Option<f64>) -> Line {
        match self {
            Self::Constant(value) => [*value; 2],
            Self::Leaf(index) => leaves[*index],
            Self::Rate(inner) => {
                let [start, end] = inner.line(leaves, duration, split);
                [(end - start) / duration; 2]
            }
            Self::Negative(inner) => inner.line(leaves, duration, split).map(|value| -value),
            Self::Absolute(inner) => {
                let line = inner.line(leaves, duration, split);
                *split = split.or_else(|| kink(line, [0.0; 2]));
                line.map(f64::abs)
            }
            Self::Extreme(which, parts) => {
                let mut lines = parts.iter().map(|part| part.line(leaves, duration, split));
                let first = lines.next().unwrap_or([f64::NAN; 2]);
                let rest: Vec<_> = lines.collect();
                rest.into_iter().fold(first, |best, line| {
                    *split = split.or_else(|| kink(best, line));
                    [extreme(*which, best[0], line[0]), extreme(*which, best[1], line[1])]
                })
            }
            Self::Operation(operation, sides) => {
                let left = sides[0].line(leaves, duration, split);
                let right = sides[1].line(leaves, duration, split);
                [apply(*operation, left[0], right[0]), apply(*operation, left[1], right[1])]
            }
        }
    }
}

fn apply(operation: Arithmetic, left: f64, right: f64) -> f64 {
    match operation {
        Arithmetic::Add => left + right,
        Arithmetic::Subtract => left - right,
        Arithmetic::Multiply => left * right,
        Arithmetic::Divide => left / right,
    }
}

/// The least or greatest; not a number if one of them is not.
fn extreme(which: Extreme, left: f64, right: f64) -> f64 {
    if left.is_nan() || right.is_nan() {
        return f64::NAN;
    }
    match which {
        Extreme::Least => left.min(right),
        Extreme::Greatest => left.max(right),
    }
}

/// The fraction at which two lines cross, unless that is at an end.
fn kink(left: Line, right: Line) -> Option<f64> {
    crossing(left, right).filter(|fraction| *fraction > RESOLUTION && *fraction < 1.0 - RESOLUTION)
}
