//! Why nothing could be imported.

/// A message for the user, and what to do.
#[derive(Debug, thiserror::Error)]
#[error("{text}")]
pub struct ImportError {
    text: String,
    pub hint: Option<String>,
}

impl ImportError {
    pub(crate) fn new(text: impl Into<String>) -> Self {
        Self { text: text.into(), hint: None }
    }

    pub(crate) fn hint(self, hint: impl Into<String>) -> Self {
        Self { hint: Some(hint.into()), ..self }
    }
}
