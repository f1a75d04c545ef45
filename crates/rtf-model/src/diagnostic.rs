//! A problem in the user's files, with the places that show it.

use serde::{Deserialize, Serialize};

/// How bad a [`Diagnostic`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// Accepted, but probably a mistake.
    Warning,
    /// Nothing can run until it is fixed.
    Error,
}

/// One problem, in a form that a terminal, a web page and an editor can show.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Diagnostic {
    /// A stable identifier of this kind of problem: `unknown-attribute`.
    pub code: String,
    /// How bad it is.
    pub severity: Severity,
    /// The problem, as a lower-case fragment without a full stop.
    pub message: String,
    /// The places that show it, the most important one first; empty if it
    /// concerns no particular place.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub labels: Vec<Label>,
    /// Additional facts (the searched paths, the loader's message).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub notes: Vec<String>,
    /// How to fix it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hint: Option<String>,
}

/// A range in a file that a [`Diagnostic`] points to.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Label {
    /// The file as the user named it.
    pub file: String,
    /// The line of the range's start, from 1.
    pub line: u32,
    /// The column of the range's start in characters, from 1.
    pub column: u32,
    /// The start of the range in bytes.
    pub start: u64,
    /// The end of the range in bytes, not included.
    pub end: u64,
    /// A note about this place; may be empty.
    #[serde(default)]
    pub text: String,
}

impl Diagnostic {
    /// A new error without a place.
    #[must_use]
    pub fn error(code: &str, message: impl Into<String>) -> Self {
        Self {
            code: code.to_owned(),
            severity: Severity::Error,
            message: message.into(),
            labels: Vec::new(),
            notes: Vec::new(),
            hint: None,
        }
    }

    /// A new warning without a place.
    #[must_use]
    pub fn warning(code: &str, message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, ..Self::error(code, message) }
    }

    /// Adds a place.
    #[must_use]
    pub fn label(mut self, label: Label) -> Self {
        self.labels.push(label);
        self
    }

    /// Adds a fact.
    #[must_use]
    pub fn note(mut self, note: impl Into<String>) -> Self {
        self.notes.push(note.into());
        self
    }

    /// Sets the hint.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }
}
