//! Text → syntax tree. The grammar is in `spec/monitors.md`.

mod error;
mod lexer;
mod parser;
mod primary;
mod tree;

pub use error::ParseError;
pub(crate) use parser::parse;
pub(crate) use tree::{
    Arithmetic, Comparison, Condition, Extreme, Interval, Number, Quantifier, Span, Tense,
};
