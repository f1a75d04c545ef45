//! The syntax tree of a formula.

use std::ops::Range;

/// A part of the text, in bytes.
pub(crate) type Span = Range<usize>;

/// A window of time relative to the time of judgement, in seconds: from 0, `to` may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub from: f64,
    pub to: f64,
}

impl Interval {
    /// The interval of an operator without one.
    pub(crate) const UNBOUNDED: Self = Self { from: 0.0, to: f64::INFINITY };
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Different,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arithmetic {
    Add,
    Subtract,
    Multiply,
    Divide,
}

/// `min` or `max`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extreme {
    Least,
    Greatest,
}

/// The direction in which a temporal operator looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Tense {
    Future,
    Past,
}

/// Whether a condition must hold at all times of a window, or at one of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Quantifier {
    All,
    Some,
}

impl Quantifier {
    /// The value of a window without any time.
    pub(crate) fn neutral(self) -> f64 {
        match self {
            Self::All => f64::INFINITY,
            Self::Some => f64::NEG_INFINITY,
        }
    }

    /// The value of two times.
    pub(crate) fn combine(self, left: f64, right: f64) -> f64 {
        match self {
            Self::All => left.min(right),
            Self::Some => left.max(right),
        }
    }
}

/// An expression with a number as its value.
#[derive(Clone, Debug)]
pub(crate) enum Number {
    /// A constant. A unit that remains after parsing is not converted yet.
    Literal { value: f64, unit: Option<String>, span: Span },
    /// A signal, linear between samples.
    Signal { index: usize, span: Span },
    /// A signal that keeps its value until the next sample.
    Hold { index: usize, span: Span },
    /// The slope of an expression, per second.
    Rate { inner: Box<Number>, span: Span },
    /// The negative of an expression.
    Negative { inner: Box<Number>, span: Span },
    /// The absolute value.
    Absolute { inner: Box<Number>, span: Span },
    /// The least or greatest of at least two expressions.
    Extreme { which: Extreme, parts: Vec<Number>, span: Span },
    /// `+`, `-`, `*` or `/`.
    Operation { operation: Arithmetic, sides: Box<[Number; 2]>, span: Span },
}

impl Number {
    pub(crate) fn span(&self) -> Span {
        match self {
            Self::Literal { span, .. }
            | Self::Signal { span, .. }
            | Self::Hold { span, .. }
            | Self::Rate { span, .. }
            | Self::Negative { span, .. }
            | Self::Absolute { span, .. }
            | Self::Extreme { span, .. }
            | Self::Operation { span, .. } => span.clone(),
        }
    }

    /// Its direct parts.
    pub(crate) fn parts(&self) -> &[Number] {
        match self {
            Self::Literal { .. } | Self::Signal { .. } | Self::Hold { .. } => &[],
            Self::Rate { inner, .. }
            | Self::Negative { inner, .. }
            | Self::Absolute { inner, .. } => std::slice::from_ref(inner),
            Self::Extreme { parts, .. } => parts,
            Self::Operation { sides, .. } => sides.as_slice(),
        }
    }

    /// Whether it or one of its parts meets a condition.
    pub(crate) fn contains(&self, is_meant: &dyn Fn(&Number) -> bool) -> bool {
        is_meant(self) || self.parts().iter().any(|part| part.contains(is_meant))
    }
}

/// An expression that is true or false.
#[derive(Clone, Debug)]
pub(crate) enum Condition {
    /// `true` or `false`.
    Constant(bool, Span),
    /// A comparison of two numbers.
    Comparison { comparison: Comparison, sides: Box<[Number; 2]>, span: Span },
    /// A signal as a condition: its last sample is above 0.5.
    Truth { index: usize, span: Span },
    /// The negation.
    Not(Box<Condition>, Span),
    /// All or some of at least two conditions.
    Junction { quantifier: Quantifier, parts: Vec<Condition>, span: Span },
    /// `always`, `eventually`, `historically`, `once`.
    Window {
        tense: Tense,
        quantifier: Quantifier,
        interval: Interval,
        inner: Box<Condition>,
        span: Span,
    },
    /// `until`, `since`: the first condition up to the second.
    UpTo { tense: Tense, interval: Interval, sides: Box<[Condition; 2]>, span: Span },
    /// `rise`, `fall`: the condition becomes true or false.
    Edge { rises: bool, inner: Box<Condition>, span: Span },
}

impl Condition {
    pub(crate) fn span(&self) -> Span {
        match self {
            Self::Constant(_, span)
            | Self::Comparison { span, .. }
            | Self::Truth { span, .. }
            | Self::Not(_, span)
            | Self::Junction { span, .. }
            | Self::Window { span, .. }
            | Self::UpTo { span, .. }
            | Self::Edge { span, .. } => span.clone(),
        }
    }

    /// Its direct conditions.
    pub(crate) fn parts(&self) -> &[Condition] {
        match self {
            Self::Constant(..) | Self::Comparison { .. } | Self::Truth { .. } => &[],
            Self::Not(inner, _) | Self::Window { inner, .. } | Self::Edge { inner, .. } => {
                std::slice::from_ref(inner)
            }
            Self::Junction { parts, .. } => parts,
            Self::UpTo { sides, .. } => sides.as_slice(),
        }
    }

    /// How far into the future a judgement may need samples, in seconds; may be infinite.
    pub(crate) fn horizon(&self) -> f64 {
        let inner = self.parts().iter().map(Condition::horizon).fold(0.0, f64::max);
        match self {
            Self::Window { tense: Tense::Future, interval, .. }
            | Self::UpTo { tense: Tense::Future, interval, .. } => inner + interval.to,
            _ => inner,
        }
    }

    /// Whether it has a temporal operator or an edge.
    pub(crate) fn is_temporal(&self) -> bool {
        matches!(self, Self::Window { .. } | Self::UpTo { .. } | Self::Edge { .. })
            || self.parts().iter().any(Condition::is_temporal)
    }

    /// Whether a constant has a unit that is not converted.
    pub(crate) fn has_units(&self) -> bool {
        let has_unit = |part: &Number| matches!(part, Number::Literal { unit: Some(_), .. });
        match self {
            Self::Comparison { sides, .. } => sides.iter().any(|side| side.contains(&has_unit)),
            _ => self.parts().iter().any(Condition::has_units),
        }
    }
}
