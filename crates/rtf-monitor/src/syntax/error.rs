//! Invalid formulas.

use std::ops::Range;

/// An invalid formula.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct ParseError {
    /// The part of the text, in bytes, on character boundaries. It is empty if something is missing.
    pub range: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// How to correct it, if that is known.
    pub hint: Option<String>,
}

impl ParseError {
    /// An error without a hint.
    pub(crate) fn new(range: Range<usize>, message: impl Into<String>) -> Self {
        Self { range, message: message.into(), hint: None }
    }

    /// The error with a hint.
    pub(crate) fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}
