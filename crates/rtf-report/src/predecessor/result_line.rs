//! A line of the output, and the word before it.

use crate::escape;

/// What a line means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Word {
    /// The run, a suite or a test begins or ends.
    Progress,
    Info,
    /// A warning, which does not count.
    Warn,
    /// The robot is wrong.
    Fail,
    /// The bench is wrong.
    Error,
}

impl Word {
    /// As it stands at the beginning of a line.
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Progress => "",
            Self::Info => "[INFO]  ",
            Self::Warn => "[WARN]  ",
            Self::Fail => "[FAIL]  ",
            Self::Error => "[ERROR] ",
        }
    }
}

/// One line; a message may have several.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct ResultLine {
    pub word: Word,
    /// What stands after the word.
    pub text: String,
    /// The place in the source.
    pub place: Option<String>,
}

impl ResultLine {
    /// A line about the run, a suite or a test; `text` is harmless.
    pub fn progress(text: String) -> Self {
        Self { word: Word::Progress, text, place: None }
    }

    /// `(about) text`, made harmless.
    pub fn about(word: Word, about: &str, text: &str) -> Self {
        let text = format!("({}) {}", escape::line(about), escape::block(text));
        Self { word, text, place: None }
    }
}
