//! Tokens → syntax tree: numbers, names, calls, brackets and intervals.

use super::ParseError;
use super::lexer::{Token, TokenKind};
use super::parser::{Parsed, Parser};
use super::tree::{Condition, Extreme, Interval, Number, Span};
use crate::formula::SignalReference;

/// Words that have a meaning in formulas.
const OPERATORS: [&str; 9] =
    ["always", "eventually", "historically", "once", "until", "since", "not", "and", "or"];

/// Functions, which are called with parentheses.
const FUNCTIONS: [&str; 7] = ["abs", "min", "max", "rate", "hold", "rise", "fall"];

/// Units of durations and their length in seconds.
const DURATIONS: [(&str, f64); 4] = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("min", 60.0)];

/// The longest duration in seconds, 366 days.
const MAX_DURATION: f64 = 366.0 * 24.0 * 60.0 * 60.0;

impl Parser {
    pub(super) fn primary(&mut self) -> Result<Parsed, ParseError> {
        self.count()?;
        let Some(token) = self.advance() else {
            return Err(ParseError::new(self.end(), "the formula ends too early"));
        };
        match &token.kind {
            TokenKind::Number(value, unit) => Ok(Parsed::Number(Number::Literal {
                value: *value,
                unit: unit.clone(),
                span: token.span,
            })),
            TokenKind::Quoted(name) => Ok(self.signal(name, token.span)),
            TokenKind::Symbol("(") => {
                let inner = self.nested(Self::implication)?;
                self.close(")", &token)?;
                Ok(inner)
            }
            TokenKind::Symbol(_) => Err(self.unexpected(&token)),
            TokenKind::Word(word) => self.word(word, &token),
        }
    }

    fn word(&mut self, word: &str, token: &Token) -> Result<Parsed, ParseError> {
        let span = token.span.clone();
        match word {
            "true" | "false" => Ok(Parsed::Condition(Condition::Constant(word == "true", span))),
            _ if FUNCTIONS.contains(&word) => self.call(word, token),
            _ if OPERATORS.contains(&word) => {
                Err(ParseError::new(span, format!("unexpected `{word}`"))
                    .hint("a signal with this name is written in quotes"))
            }
            _ => match self.peek().map(|next| &next.kind) {
                Some(TokenKind::Symbol("(" | "[")) => Err(unknown_operator(word, span)),
                _ => Ok(self.signal(word, span)),
            },
        }
    }

    fn signal(&mut self, name: &str, span: Span) -> Parsed {
        let known = self.signals.iter().position(|signal| signal.name == name);
        let index = known.unwrap_or_else(|| {
            self.signals.push(SignalReference { name: name.to_owned(), range: span.clone() });
            self.signals.len() - 1
        });
        Parsed::Number(Number::Signal { index, span })
    }

    fn close(&mut self, bracket: &str, opening: &Token) -> Result<(), ParseError> {
        if self.take(bracket) {
            return Ok(());
        }
        match self.peek() {
            None => Err(ParseError::new(
                opening.span.clone(),
                format!("the closing `{bracket}` is missing"),
            )),
            Some(next) => {
                let error = self.unexpected(next);
                Err(ParseError {
                    message: format!("{}, expected `{bracket}`", error.message),
                    ..error
                })
            }
        }
    }

    fn call(&mut self, function: &str, token: &Token) -> Result<Parsed, ParseError> {
        let opening = self.peek().cloned();
        let (Some(opening), true) = (opening, self.take("(")) else {
            let hint = format!("write `{function}(…)`, or a signal with this name in quotes");
            return Err(ParseError::new(token.span.clone(), format!("`{function}` is a function"))
                .hint(hint));
        };
        let mut arguments = vec![self.nested(Self::implication)?];
        while self.take(",") {
            arguments.push(self.nested(Self::implication)?);
        }
        self.close(")", &opening)?;
        let span = self.since(token.span.start);
        let is_extreme = matches!(function, "min" | "max");
        if is_extreme == (arguments.len() == 1) {
            let expected = if is_extreme { "at least two arguments" } else { "one argument" };
            let found = arguments.len();
            let message = format!("`{function}` has {expected}, found {found}");
            return Err(ParseError::new(span, message));
        }
        if is_extreme {
            let which = if function == "min" { Extreme::Least } else { Extreme::Greatest };
            let parts = arguments.into_iter().map(Parsed::number).collect::<Result<_, _>>()?;
            return Ok(Parsed::Number(Number::Extreme { which, parts, span }));
        }
        apply(function, arguments.swap_remove(0), span)
    }

    /// `[a, b]`, if it is next.
    pub(super) fn interval(&mut self) -> Result<Interval, ParseError> {
        let Some(opening) = self.peek().cloned() else { return Ok(Interval::UNBOUNDED) };
        if !self.take("[") {
            return Ok(Interval::UNBOUNDED);
        }
        let from = self.bound()?;
        if !self.take(",") {
            let span = self.peek().map_or_else(|| self.end(), |token| token.span.clone());
            return Err(
                ParseError::new(span, "an interval has two bounds").hint("write `[0, 0.5s]`")
            );
        }
        let to = self.bound()?;
        self.close("]", &opening)?;
        let span = self.since(opening.span.start);
        if !from.is_finite() {
            return Err(ParseError::new(span, "the first bound of an interval is infinite"));
        }
        if from > to {
            return Err(ParseError::new(
                span,
                "the first bound of the interval is greater than the second",
            )
            .hint("exchange the bounds"));
        }
        Ok(Interval { from, to })
    }

    /// A duration in seconds, or `inf`.
    fn bound(&mut self) -> Result<f64, ParseError> {
        let Some(token) = self.advance() else {
            return Err(ParseError::new(self.end(), "the formula ends within an interval"));
        };
        let error = |message: &str| ParseError::new(token.span.clone(), message);
        let seconds = match &token.kind {
            TokenKind::Word(word) if word == "inf" => return Ok(f64::INFINITY),
            TokenKind::Symbol("-") => {
                return Err(error("a bound of an interval is not negative")
                    .hint("`once`, `historically` and `since` look into the past"));
            }
            TokenKind::Number(value, None) => *value,
            TokenKind::Number(value, Some(unit)) => {
                let known = DURATIONS.iter().find(|(name, _)| name == unit);
                let Some((_, factor)) = known else {
                    return Err(error(&format!("unknown unit of time `{unit}`"))
                        .hint("the units are `s`, `ms`, `us` and `min`"));
                };
                value * factor
            }
            _ => {
                return Err(
                    error("expected a duration").hint("write `0.5s`, `20ms`, `2min` or `inf`")
                );
            }
        };
        if seconds > MAX_DURATION {
            return Err(error("longer than 366 days").hint("write `inf` for no bound"));
        }
        Ok(seconds)
    }
}

fn apply(function: &str, argument: Parsed, span: Span) -> Result<Parsed, ParseError> {
    if let "rise" | "fall" = function {
        let inner = Box::new(argument.condition()?);
        if inner.is_temporal() {
            return Err(ParseError::new(
                inner.span(),
                format!("`{function}` has no temporal operator inside"),
            ));
        }
        return Ok(Parsed::Condition(Condition::Edge { rises: function == "rise", inner, span }));
    }
    let inner = Box::new(argument.number()?);
    let is_step = |part: &Number| matches!(part, Number::Hold { .. } | Number::Rate { .. });
    Ok(Parsed::Number(match (function, *inner) {
        ("abs", inner) => Number::Absolute { inner: Box::new(inner), span },
        ("hold", Number::Signal { index, .. }) => Number::Hold { index, span },
        ("hold", inner) => {
            return Err(ParseError::new(
                inner.span(),
                "`hold` has the name of a signal as its argument",
            ));
        }
        (_, inner) if inner.contains(&is_step) => {
            return Err(ParseError::new(
                inner.span(),
                "the rate of `hold` or `rate` is zero between the samples",
            )
            .hint("use the rate of a signal that is a velocity"));
        }
        (_, inner) => Number::Rate { inner: Box::new(inner), span },
    }))
}

/// A name that is used as a function or operator.
fn unknown_operator(word: &str, span: Span) -> ParseError {
    let known = OPERATORS.iter().chain(&FUNCTIONS);
    let similar = known
        .map(|known| (strsim::damerau_levenshtein(word, known), known))
        .filter(|(distance, known)| *distance <= 2 && *distance < known.len())
        .min();
    let error = ParseError::new(span, format!("unknown function or operator `{word}`"));
    match similar {
        Some((_, known)) => error.hint(format!("did you mean `{known}`?")),
        None => error.hint("a signal name with brackets is written in quotes"),
    }
}
