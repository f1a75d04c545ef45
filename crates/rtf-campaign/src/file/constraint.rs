//! `<constraint>`: a comparison of two expressions of parameters.

use std::ops::Range;

use roxmltree::Node;
use rtf_plan::suite::{ElementReader, Span, Spanned};

mod parser;

/// The value of `require`.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// The position of the value.
    pub span: Span,
    pub left: Expression,
    pub comparison: Comparison,
    pub right: Expression,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    Less,
    LessOrEqual,
    Greater,
    GreaterOrEqual,
    Equal,
    Different,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Operation {
    Add,
    Subtract,
    Multiply,
    Divide,
}

#[derive(Clone, Debug, PartialEq)]
pub enum Expression {
    Number(f64),
    Parameter(Spanned<String>),
    Negative(Box<Expression>),
    Binary(Operation, Box<[Expression; 2]>),
}

impl Constraint {
    /// Whether the values of parameters meet the constraint.
    pub fn holds(&self, value: &mut impl FnMut(&str) -> f64) -> bool {
        let (left, right) = (self.left.evaluate(value), self.right.evaluate(value));
        // Nothing holds for a value that is not a number.
        left.partial_cmp(&right).is_some_and(|order| match self.comparison {
            Comparison::Less => order.is_lt(),
            Comparison::LessOrEqual => order.is_le(),
            Comparison::Greater => order.is_gt(),
            Comparison::GreaterOrEqual => order.is_ge(),
            Comparison::Equal => order.is_eq(),
            Comparison::Different => order.is_ne(),
        })
    }

    /// Returns the parameters of both sides, in order.
    #[must_use]
    pub fn parameters(&self) -> Vec<&Spanned<String>> {
        let mut found = Vec::new();
        self.left.collect(&mut found);
        self.right.collect(&mut found);
        found
    }
}

impl Expression {
    fn evaluate(&self, value: &mut impl FnMut(&str) -> f64) -> f64 {
        match self {
            Self::Number(number) => *number,
            Self::Parameter(name) => value(&name.value),
            Self::Negative(inner) => -inner.evaluate(value),
            Self::Binary(operation, sides) => {
                let (left, right) = (sides[0].evaluate(value), sides[1].evaluate(value));
                match operation {
                    Operation::Add => left + right,
                    Operation::Subtract => left - right,
                    Operation::Multiply => left * right,
                    Operation::Divide => left / right,
                }
            }
        }
    }

    fn collect<'a>(&'a self, found: &mut Vec<&'a Spanned<String>>) {
        match self {
            Self::Number(_) => {}
            Self::Parameter(name) => found.push(name),
            Self::Negative(inner) => inner.collect(found),
            Self::Binary(_, sides) => sides.iter().for_each(|side| side.collect(found)),
        }
    }
}

/// Reads a `<constraint>`; `None` if it is invalid, which is reported.
pub(super) fn read(reader: &mut ElementReader<'_>, node: Node<'_, '_>) -> Option<Constraint> {
    let Some(require) = reader.attribute(node, "require") else {
        reader.missing(node, "the attribute `require`");
        return None;
    };
    // Entities shift the positions of the parts.
    let raw = reader.source.text().get(require.span.range());
    let is_exact = raw == Some(require.value.as_str());
    let span = |part: Range<usize>| if is_exact { require.span.part(part) } else { require.span };
    match parser::parse(&require.value, &span) {
        Ok((left, comparison, right)) => {
            Some(Constraint { span: require.span, left, comparison, right })
        }
        Err(error) => {
            let message = format!("`require` is not a comparison: {}", error.message);
            let problem = reader
                .error("invalid-value", span(error.at), message)
                .hint("write it like `payload + 0.5 * reach <= 2` (`<` in XML: `&lt;`)");
            reader.report(problem);
            None
        }
    }
}
