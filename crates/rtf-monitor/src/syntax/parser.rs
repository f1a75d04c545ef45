//! Tokens → syntax tree: the operators. `primary.rs` has numbers, names, calls and brackets.

use super::ParseError;
use super::lexer::{Token, TokenKind, tokens};
use super::tree::{Arithmetic, Comparison, Condition, Interval, Number, Quantifier, Span, Tense};
use crate::formula::SignalReference;

/// The longest text, in bytes.
pub(super) const MAX_LENGTH: usize = 64 * 1024;

/// The deepest nesting of brackets and prefix operators.
const MAX_DEPTH: usize = 64;

/// The most operators, names and numbers. The tree of `a + b + c …` is as deep as it is long.
const MAX_NODES: usize = 1000;

/// A condition or a number: which of them, the operators around it decide.
pub(super) enum Parsed {
    Condition(Condition),
    Number(Number),
}

impl Parsed {
    /// A condition; a signal is true if its last sample is above 0.5.
    pub(super) fn condition(self) -> Result<Condition, ParseError> {
        match self {
            Self::Condition(condition) => Ok(condition),
            Self::Number(Number::Signal { index, span } | Number::Hold { index, span }) => {
                Ok(Condition::Truth { index, span })
            }
            Self::Number(number) => {
                Err(ParseError::new(number.span(), "expected a condition, found a number")
                    .hint("compare it, for example with `> 0`"))
            }
        }
    }

    pub(super) fn number(self) -> Result<Number, ParseError> {
        match self {
            Self::Number(number) => Ok(number),
            Self::Condition(condition) => {
                Err(ParseError::new(condition.span(), "expected a number, found a condition"))
            }
        }
    }
}

pub(super) struct Parser {
    tokens: Vec<Token>,
    at: usize,
    depth: usize,
    nodes: usize,
    end: usize,
    pub(super) signals: Vec<SignalReference>,
}

/// Parses a formula; the second result lists its signals.
pub(crate) fn parse(text: &str) -> Result<(Condition, Vec<SignalReference>), ParseError> {
    if text.len() > MAX_LENGTH {
        let message = format!("the formula has {} bytes, more than {MAX_LENGTH}", text.len());
        return Err(ParseError::new(0..0, message));
    }
    let end = text.trim_end().len();
    let mut parser =
        Parser { tokens: tokens(text)?, at: 0, depth: 0, nodes: 0, end, signals: Vec::new() };
    if parser.tokens.is_empty() {
        return Err(ParseError::new(0..0, "the formula is empty")
            .hint("write a condition, for example `always(abs(error) < 0.02)`"));
    }
    let formula = parser.implication()?.condition()?;
    match parser.peek() {
        None => Ok((formula, parser.signals)),
        Some(token) => Err(parser.unexpected(token)),
    }
}

impl Parser {
    pub(super) fn peek(&self) -> Option<&Token> {
        self.tokens.get(self.at)
    }

    pub(super) fn advance(&mut self) -> Option<Token> {
        let token = self.tokens.get(self.at).cloned();
        self.at += usize::from(token.is_some());
        token
    }

    /// An empty part at the end of the text.
    pub(super) fn end(&self) -> Span {
        self.end..self.end
    }

    /// The part from a position to the last token that was taken.
    pub(super) fn since(&self, start: usize) -> Span {
        start..self.at.checked_sub(1).map_or(start, |last| self.tokens[last].span.end)
    }

    pub(super) fn unexpected(&self, token: &Token) -> ParseError {
        let error = |text: &str| ParseError::new(token.span.clone(), format!("unexpected {text}"));
        match &token.kind {
            TokenKind::Symbol(symbol @ (")" | "]")) => {
                error(&format!("`{symbol}`")).hint("it closes nothing")
            }
            TokenKind::Symbol(symbol) => error(&format!("`{symbol}`")),
            TokenKind::Word(word) if self.follows_number(token) => error(&format!("`{word}`"))
                .hint("a unit follows its number without a space, for example `5deg`"),
            TokenKind::Word(word) => {
                error(&format!("`{word}`")).hint("an operator is missing, for example `and`")
            }
            TokenKind::Quoted(name) => error(&format!("signal `{name}`")),
            TokenKind::Number(value, _) => error(&format!("number `{value}`")),
        }
    }

    fn follows_number(&self, token: &Token) -> bool {
        let index = self.tokens.partition_point(|other| other.span.start < token.span.start);
        let previous = index.checked_sub(1).map(|previous| &self.tokens[previous].kind);
        matches!(previous, Some(TokenKind::Number(..)))
    }

    /// Takes a symbol if it is next.
    pub(super) fn take(&mut self, symbol: &str) -> bool {
        let found = matches!(self.peek(), Some(Token { kind: TokenKind::Symbol(next), .. }) if *next == symbol);
        self.at += usize::from(found);
        found
    }

    /// Takes a word if it is next.
    pub(super) fn take_word(&mut self, word: &str) -> bool {
        let found =
            matches!(self.peek(), Some(Token { kind: TokenKind::Word(next), .. }) if next == word);
        self.at += usize::from(found);
        found
    }

    /// Counts a node of the tree.
    pub(super) fn count(&mut self) -> Result<(), ParseError> {
        self.nodes += 1;
        if self.nodes <= MAX_NODES {
            return Ok(());
        }
        let span = self.peek().map_or_else(|| self.end(), |token| token.span.clone());
        let message = format!("the formula has more than {MAX_NODES} operators, names and numbers");
        Err(ParseError::new(span, message))
    }

    /// Parses what is nested in brackets or a prefix operator.
    pub(super) fn nested<T>(
        &mut self,
        inner: impl FnOnce(&mut Self) -> Result<T, ParseError>,
    ) -> Result<T, ParseError> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            let span = self.peek().map_or_else(|| self.end(), |token| token.span.clone());
            let message = format!("nested more than {MAX_DEPTH} levels deep");
            return Err(ParseError::new(span, message));
        }
        let parsed = inner(self)?;
        self.depth -= 1;
        Ok(parsed)
    }

    /// `a -> b -> c` is `a -> (b -> c)`.
    pub(super) fn implication(&mut self) -> Result<Parsed, ParseError> {
        let left = self.disjunction()?;
        if !self.take("->") {
            return Ok(left);
        }
        self.count()?;
        let premise = left.condition()?;
        let conclusion = self.nested(Self::implication)?.condition()?;
        let span = premise.span().start..conclusion.span().end;
        let premise_span = premise.span();
        let negated = Condition::Not(Box::new(premise), premise_span);
        let parts = vec![negated, conclusion];
        Ok(Parsed::Condition(Condition::Junction { quantifier: Quantifier::Some, parts, span }))
    }

    fn disjunction(&mut self) -> Result<Parsed, ParseError> {
        self.junction("or", Quantifier::Some, Self::conjunction)
    }

    fn conjunction(&mut self) -> Result<Parsed, ParseError> {
        self.junction("and", Quantifier::All, Self::up_to)
    }

    fn junction(
        &mut self,
        word: &str,
        quantifier: Quantifier,
        operand: fn(&mut Self) -> Result<Parsed, ParseError>,
    ) -> Result<Parsed, ParseError> {
        let first = operand(self)?;
        let mut parts = Vec::new();
        while self.take_word(word) {
            self.count()?;
            parts.push(operand(self)?.condition()?);
        }
        if parts.is_empty() {
            return Ok(first);
        }
        parts.insert(0, first.condition()?);
        let end = parts.last().map_or(0, |last| last.span().end);
        let span = parts[0].span().start..end;
        Ok(Parsed::Condition(Condition::Junction { quantifier, parts, span }))
    }

    fn up_to(&mut self) -> Result<Parsed, ParseError> {
        let left = self.prefix()?;
        let Some(tense) = self.take_up_to() else { return Ok(left) };
        self.count()?;
        let interval = self.interval()?;
        let left = left.condition()?;
        let right = self.prefix()?.condition()?;
        let span = left.span().start..right.span().end;
        if let Some(token) = self.peek().cloned()
            && self.take_up_to().is_some()
        {
            return Err(ParseError::new(token.span, "two `until` or `since` in a row")
                .hint("use parentheses to state which belongs together"));
        }
        let sides = Box::new([left, right]);
        Ok(Parsed::Condition(Condition::UpTo { tense, interval, sides, span }))
    }

    fn take_up_to(&mut self) -> Option<Tense> {
        let future = self.take_word("until").then_some(Tense::Future);
        future.or_else(|| self.take_word("since").then_some(Tense::Past))
    }

    /// `not`, `always` and the like, in front of a comparison or of each other.
    fn prefix(&mut self) -> Result<Parsed, ParseError> {
        let Some(token) = self.peek().cloned() else { return self.comparison() };
        let TokenKind::Word(word) = &token.kind else { return self.comparison() };
        let start = token.span.start;
        let window = match word.as_str() {
            "not" => None,
            "always" => Some((Tense::Future, Quantifier::All)),
            "eventually" => Some((Tense::Future, Quantifier::Some)),
            "historically" => Some((Tense::Past, Quantifier::All)),
            "once" => Some((Tense::Past, Quantifier::Some)),
            _ => return self.comparison(),
        };
        self.advance();
        self.count()?;
        let interval = if window.is_some() { self.interval()? } else { Interval::UNBOUNDED };
        let inner = Box::new(self.nested(Self::prefix)?.condition()?);
        let span = self.since(start);
        Ok(Parsed::Condition(match window {
            None => Condition::Not(inner, span),
            Some((tense, quantifier)) => {
                Condition::Window { tense, quantifier, interval, inner, span }
            }
        }))
    }

    fn comparison(&mut self) -> Result<Parsed, ParseError> {
        let left = self.sum()?;
        let Some(comparison) = self.take_comparison() else { return Ok(left) };
        self.count()?;
        let left = left.number()?;
        let right = self.sum()?.number()?;
        let span = left.span().start..right.span().end;
        if let Some(token) = self.peek().cloned()
            && self.take_comparison().is_some()
        {
            return Err(ParseError::new(token.span, "a comparison has two sides")
                .hint("write `1 < x and x < 2`"));
        }
        let sides = Box::new([left, right]);
        Ok(Parsed::Condition(Condition::Comparison { comparison, sides, span }))
    }

    fn take_comparison(&mut self) -> Option<Comparison> {
        const COMPARISONS: [(&str, Comparison); 6] = [
            ("<=", Comparison::LessOrEqual),
            (">=", Comparison::GreaterOrEqual),
            ("==", Comparison::Equal),
            ("!=", Comparison::Different),
            ("<", Comparison::Less),
            (">", Comparison::Greater),
        ];
        COMPARISONS.iter().find(|(symbol, _)| self.take(symbol)).map(|(_, comparison)| *comparison)
    }

    fn sum(&mut self) -> Result<Parsed, ParseError> {
        self.operations(&[("+", Arithmetic::Add), ("-", Arithmetic::Subtract)], Self::product)
    }

    fn product(&mut self) -> Result<Parsed, ParseError> {
        self.operations(&[("*", Arithmetic::Multiply), ("/", Arithmetic::Divide)], Self::negation)
    }

    /// Operands with these operations between them, from left to right.
    fn operations(
        &mut self,
        operations: &[(&str, Arithmetic)],
        operand: fn(&mut Self) -> Result<Parsed, ParseError>,
    ) -> Result<Parsed, ParseError> {
        let mut left = operand(self)?;
        while let Some((_, operation)) = operations.iter().find(|(symbol, _)| self.take(symbol)) {
            self.count()?;
            let sides = Box::new([left.number()?, operand(self)?.number()?]);
            let span = sides[0].span().start..sides[1].span().end;
            left = Parsed::Number(Number::Operation { operation: *operation, sides, span });
        }
        Ok(left)
    }

    fn negation(&mut self) -> Result<Parsed, ParseError> {
        let start = self.peek().map_or(self.end, |token| token.span.start);
        if !self.take("-") {
            return self.primary();
        }
        self.count()?;
        let inner = Box::new(self.nested(Self::negation)?.number()?);
        Ok(Parsed::Number(Number::Negative { inner, span: self.since(start) }))
    }
}
