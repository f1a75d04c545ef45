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
    /// The name before the text; a line about progress has none.
    about: Option<String>,
    text: String,
    /// The place in the source.
    pub place: Option<String>,
}

impl ResultLine {
    /// A line about the run, a suite or a test; `text` is harmless.
    pub fn progress(text: String) -> Self {
        Self { word: Word::Progress, about: None, text, place: None }
    }

    /// `(about) text`, made harmless.
    pub fn about(word: Word, about: &str, text: &str) -> Self {
        let (about, text) = (about.to_owned(), escape::block(text).into_owned());
        Self { word, about: Some(about), text, place: None }
    }

    /// With the place in the source.
    pub fn at(self, place: Option<String>) -> Self {
        Self { place, ..self }
    }

    /// What stands after the word.
    pub fn text(&self) -> String {
        match &self.about {
            Some(about) => format!("({}) {}", escape::line(about), self.text),
            None => self.text.clone(),
        }
    }

    /// Uses another name for what `name` is.
    pub fn rename(&mut self, name: &str, other: &str) {
        if self.about.as_deref() == Some(name) {
            self.about = Some(other.to_owned());
        }
    }
}
