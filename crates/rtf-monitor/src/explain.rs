//! Which comparison is responsible for the value of the formula, and when.

use crate::atom::Kind;
use crate::component::Component;
use crate::evaluate::{Evaluation, Mode};
use crate::function::Function;
use crate::judgement::SignalValue;
use crate::node::{Node, Temporal};
use crate::shape::Shape;
use crate::syntax::{Quantifier, Span, Tense};

/// What is responsible for a violation.
#[derive(Clone, Debug)]
pub(crate) struct Cause {
    pub interval: (f64, f64),
    /// `None` if no comparison is: the formula is constant.
    pub span: Option<Span>,
    pub values: Vec<SignalValue>,
}

/// The component that determines the value, if each has a value.
pub(crate) fn component(shape: &Shape, value: &dyn Fn(usize) -> f64) -> usize {
    match shape {
        Shape::Component(index) => *index,
        Shape::Not(inner) => component(inner, value),
        Shape::Junction(quantifier, parts) => {
            let order = |left: &&Shape, right: &&Shape| {
                left.combine(value).total_cmp(&right.combine(value))
            };
            let part = match quantifier {
                Quantifier::All => parts.iter().min_by(order),
                Quantifier::Some => parts.iter().max_by(order),
            };
            part.map_or(0, |part| component(part, value))
        }
    }
}

pub(crate) fn cause(component: &Component, mode: Mode, now: f64) -> Cause {
    let sign = component.polarity;
    let oriented = |kind: Kind| {
        let function = component.function(kind, mode, now);
        let function =
            function.unwrap_or_else(|| Function::constant(component.start, now, f64::INFINITY));
        if sign > 0.0 { function } else { function.negated() }
    };
    let truth = oriented(Kind::Truth);
    let violated = truth.negative_around(truth.minimum().0);
    let margin = oriented(Kind::Margin).slice(violated.0, violated.1);
    let time = margin.minimum().0;
    let kept = component.atoms.iter().map(|atom| atom.kept_from(component.start));
    let memories = vec![None; component.program.memories];
    let mut search = Search {
        evaluation: Evaluation {
            start: kept.fold(component.start, f64::max),
            memories: &memories,
            ..component.evaluation(Kind::Margin, mode)
        },
        now,
    };
    let found = search.responsible(&component.program.node, time);
    let Some((index, at)) = found else {
        return Cause { interval: violated, span: None, values: Vec::new() };
    };
    let atom = &component.atoms[index];
    let interval = if component.is_at_start() {
        let truth = atom.function(Kind::Truth, (search.evaluation.start, now.max(at)), None, false);
        let truth = if atom.comparison.polarity > 0.0 { truth } else { truth.negated() };
        truth.negative_around(at)
    } else {
        violated
    };
    Cause { interval, span: Some(atom.comparison.span.clone()), values: atom.values(at) }
}

struct Search<'a> {
    evaluation: Evaluation<'a>,
    now: f64,
}

impl Search<'_> {
    /// The comparison that determines the value of a part at a time, and when.
    fn responsible(&mut self, node: &Node, time: f64) -> Option<(usize, f64)> {
        match node {
            Node::Atom(index) => Some((*index, time)),
            Node::Constant(_) => None,
            Node::Not(inner) => self.responsible(inner, time),
            Node::Junction(quantifier, parts) => {
                let part = self.extreme_part(*quantifier, parts, time)?;
                self.responsible(part, time)
            }
            Node::Window(temporal, quantifier, inner) => {
                let (from, to) = self.range(temporal, time);
                let function = self.evaluation.function(inner, from, to);
                self.responsible(inner, function.extreme(*quantifier).0)
            }
            Node::UpTo(temporal, sides) => {
                let (from, to) = self.range(temporal, time);
                let goal = self.evaluation.function(&sides[1], from, to);
                let (first, last) = (from.min(time), to.max(time));
                let condition = self.evaluation.function(&sides[0], first, last);
                let (best, worst) = (goal.maximum(), condition.minimum());
                let is_goal = best.1 <= worst.1;
                let at = if is_goal { best.0 } else { worst.0 };
                self.responsible(&sides[usize::from(is_goal)], at)
            }
            Node::Edge(sides) => self.responsible(&sides[0], time),
        }
    }

    /// The part with the least or greatest value.
    fn extreme_part<'n>(
        &mut self,
        quantifier: Quantifier,
        parts: &'n [Node],
        time: f64,
    ) -> Option<&'n Node> {
        let values = parts.iter().map(|part| {
            let value = self.evaluation.function(part, time, time).value(time);
            (if quantifier == Quantifier::All { value } else { -value }, part)
        });
        let least = values.min_by(|left, right| left.0.total_cmp(&right.0));
        least.map(|(_, part)| part)
    }

    /// The window of an operator, within the trace.
    fn range(&self, temporal: &Temporal, time: f64) -> (f64, f64) {
        let interval = temporal.interval;
        let (from, to) = match temporal.tense {
            Tense::Future => (time + interval.from, time + interval.to),
            Tense::Past => (time - interval.to, time - interval.from),
        };
        let from = from.max(self.evaluation.start);
        (from, to.min(self.now).max(from))
    }
}
