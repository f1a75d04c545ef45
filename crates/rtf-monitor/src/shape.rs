//! The formula as a combination of components.

use crate::component::{Bounded, Component};
use crate::syntax::{Condition, Quantifier};

/// A combination of components by `not`, `and` and `or`.
#[derive(Clone, Debug)]
pub(crate) enum Shape {
    Component(usize),
    Not(Box<Shape>),
    Junction(Quantifier, Vec<Shape>),
}

impl Shape {
    /// Divides a condition into components; the polarity is -1 if it is negated.
    pub(crate) fn new(condition: &Condition, polarity: f64, parts: &mut Vec<Component>) -> Self {
        match condition {
            Condition::Not(inner, _) if condition.horizon().is_infinite() => {
                Self::Not(Box::new(Self::new(inner, -polarity, parts)))
            }
            Condition::Junction { quantifier, parts: conditions, .. }
                if condition.horizon().is_infinite() =>
            {
                let shapes =
                    conditions.iter().map(|condition| Self::new(condition, polarity, parts));
                Self::Junction(*quantifier, shapes.collect())
            }
            _ => Self::component(condition, polarity, parts),
        }
    }

    fn component(condition: &Condition, polarity: f64, parts: &mut Vec<Component>) -> Self {
        parts.push(Component::new(condition, polarity));
        Self::Component(parts.len() - 1)
    }

    /// Combines a value of each component.
    pub(crate) fn combine(&self, value: &dyn Fn(usize) -> f64) -> f64 {
        match self {
            Self::Component(index) => value(*index),
            Self::Not(inner) => -inner.combine(value),
            Self::Junction(quantifier, parts) => {
                let values = parts.iter().map(|part| part.combine(value));
                values.fold(quantifier.neutral(), |left, right| quantifier.combine(left, right))
            }
        }
    }

    /// Combines the outcomes of the components.
    pub(crate) fn outcome(&self, outcomes: &[Bounded]) -> Bounded {
        let is_judged = outcomes.iter().all(|outcome| outcome.judged.is_some());
        let judged = |index: usize| outcomes[index].judged.unwrap_or_default();
        Bounded {
            judged: is_judged.then(|| self.combine(&judged)),
            bounds: [0, 1].map(|bound| self.combine(&|index| outcomes[index].bounds[bound])),
        }
    }
}
