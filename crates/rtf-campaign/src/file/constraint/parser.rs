//! Text → [`Expression`]s.

use std::ops::Range;

use rtf_plan::suite::{Span, Spanned};

use super::{Comparison, Expression, Operation};

/// The deepest nesting of parentheses and signs.
const MAX_DEPTH: usize = 64;

/// The most operations: each one is a level of the tree, whose left side they share.
const MAX_OPERATIONS: usize = 1000;

#[derive(Debug)]
pub(super) struct SyntaxError {
    /// What is expected or found.
    pub message: String,
    pub at: Range<usize>,
}

/// Parses `EXPRESSION COMPARISON EXPRESSION`. `span` is the position of a part of the text.
pub(super) fn parse(
    text: &str,
    span: &dyn Fn(Range<usize>) -> Span,
) -> Result<(Expression, Comparison, Expression), SyntaxError> {
    let mut parser = Parser { text, at: 0, depth: 0, operations: 0, span };
    let left = parser.sum()?;
    let comparison = parser.comparison()?;
    let right = parser.sum()?;
    parser.skip_space();
    if parser.at < text.len() {
        return Err(parser.error("unexpected"));
    }
    Ok((left, comparison, right))
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    depth: usize,
    operations: usize,
    span: &'a dyn Fn(Range<usize>) -> Span,
}

impl Parser<'_> {
    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn skip_space(&mut self) {
        self.at += self.rest().len() - self.rest().trim_start().len();
    }

    /// Skips space and then `token`, if it is next.
    fn take(&mut self, token: &str) -> bool {
        self.skip_space();
        let found = self.rest().starts_with(token);
        self.at += if found { token.len() } else { 0 };
        found
    }

    /// An error at the next character.
    fn error(&self, what: &str) -> SyntaxError {
        match self.rest().chars().next() {
            Some(next) => SyntaxError {
                message: format!("{what} `{next}`"),
                at: self.at..self.at + next.len_utf8(),
            },
            None => SyntaxError { message: "it ends too early".into(), at: self.at..self.at },
        }
    }

    fn comparison(&mut self) -> Result<Comparison, SyntaxError> {
        const COMPARISONS: [(&str, Comparison); 6] = [
            ("<=", Comparison::LessOrEqual),
            (">=", Comparison::GreaterOrEqual),
            ("==", Comparison::Equal),
            ("!=", Comparison::Different),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ];
        let found = COMPARISONS.into_iter().find(|(token, _)| self.take(token));
        found.map(|(_, comparison)| comparison).ok_or_else(|| self.error("no comparison at"))
    }

    fn sum(&mut self) -> Result<Expression, SyntaxError> {
        self.operations(&[("+", Operation::Add), ("-", Operation::Subtract)], Self::product)
    }

    fn product(&mut self) -> Result<Expression, SyntaxError> {
        self.operations(&[("*", Operation::Multiply), ("/", Operation::Divide)], Self::operand)
    }

    /// Operands with these operations between them, evaluated from left to right.
    fn operations(
        &mut self,
        operations: &[(&str, Operation)],
        operand: fn(&mut Self) -> Result<Expression, SyntaxError>,
    ) -> Result<Expression, SyntaxError> {
        let mut left = operand(self)?;
        while let Some((_, operation)) = operations.iter().find(|(token, _)| self.take(token)) {
            self.operations += 1;
            if self.operations > MAX_OPERATIONS {
                return Err(self.error("more than 1000 operations at"));
            }
            left = Expression::Binary(*operation, Box::new([left, operand(self)?]));
        }
        Ok(left)
    }

    fn operand(&mut self) -> Result<Expression, SyntaxError> {
        self.skip_space();
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(self.error("nested too deeply at"));
        }
        let expression = if self.take("-") {
            Expression::Negative(Box::new(self.operand()?))
        } else if self.take("(") {
            let inner = self.sum()?;
            if !self.take(")") {
                return Err(self.error("a `)` is missing at"));
            }
            inner
        } else {
            self.leaf()?
        };
        self.depth -= 1;
        Ok(expression)
    }

    /// A number or the name of a parameter.
    fn leaf(&mut self) -> Result<Expression, SyntaxError> {
        let start = self.at;
        let first = self.rest().chars().next();
        if first.is_some_and(|first| first.is_ascii_alphabetic()) {
            let is_part = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
            let length = self.rest().find(|c| !is_part(c)).unwrap_or(self.rest().len());
            self.at += length;
            let name = self.text[start..self.at].to_owned();
            return Ok(Expression::Parameter(Spanned::new(name, (self.span)(start..self.at))));
        }
        let length = number_length(self.rest());
        let number = self.rest()[..length].parse::<f64>().ok().filter(|number| number.is_finite());
        let number = number.ok_or_else(|| self.error("no number or parameter at"))?;
        self.at += length;
        Ok(Expression::Number(number))
    }
}

/// The length of a number at the start of a text: `12`, `0.5`, `1e-3`.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let is_part = |index: usize| match bytes[index] {
        b'0'..=b'9' | b'.' => true,
        b'e' | b'E' => index > 0,
        b'+' | b'-' => index > 0 && matches!(bytes[index - 1], b'e' | b'E'),
        _ => false,
    };
    (0..bytes.len()).find(|index| !is_part(*index)).unwrap_or(bytes.len())
}
