//! A comparison of the formula, apart from its samples.

use crate::expression::{Expression, Leaf};
use crate::syntax::{Comparison as Sign, Span};

#[derive(Clone, Debug)]
pub(crate) struct Comparison {
    /// The difference of the sides: above 0 if `<` or `>` holds.
    pub expression: Expression,
    pub leaves: Vec<Leaf>,
    pub sign: Sign,
    /// Whether it is a signal as a condition, which is true or false without a size.
    pub is_truth: bool,
    /// 1, or -1 if it is negated as a part of the formula.
    pub polarity: f64,
    pub span: Span,
}

impl Comparison {
    /// Whether the margin is an absolute value.
    pub(crate) fn is_absolute(&self) -> bool {
        matches!(self.sign, Sign::Equal | Sign::Different)
    }

    pub(crate) fn margin(&self, difference: f64) -> f64 {
        match self.sign {
            _ if self.is_truth => self.truth(difference),
            Sign::Equal => -difference.abs(),
            Sign::Different => difference.abs(),
            _ => difference,
        }
    }

    /// The truth of a margin: `inf` or `-inf`.
    pub(crate) fn truth(&self, margin: f64) -> f64 {
        let holds_at_zero =
            matches!(self.sign, Sign::LessOrEqual | Sign::GreaterOrEqual | Sign::Equal);
        let is_true = margin > 0.0 || (margin >= 0.0 && holds_at_zero);
        if is_true { f64::INFINITY } else { f64::NEG_INFINITY }
    }

    /// The margin and truth of a difference. One that is not finite is against the formula.
    pub(crate) fn point(&self, difference: f64) -> (f64, f64) {
        if !difference.is_finite() {
            let margin = f64::NEG_INFINITY * self.polarity;
            return (margin, margin);
        }
        let margin = self.margin(difference);
        (margin, self.truth(margin))
    }
}
