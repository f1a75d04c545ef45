//! Checks in the XML reports of Catch2 and doctest, which name their elements alike.

use rtf_model::{Location, Message, MessageKind};

use super::assertion;
use crate::xml_stream::Attributes;

/// The original text of an exception that no check of Catch2 caught.
const UNKNOWN: &str = "{Unknown expression after the reported line}";

/// A check whose element is open, and the messages that belong to it.
#[derive(Debug, Default)]
pub(super) struct Expression {
    pub kind: String,
    passed: bool,
    pub location: Option<Location>,
    pub original: String,
    expanded: String,
    exception: Option<String>,
    is_open: bool,
    pub infos: Vec<String>,
}

impl Expression {
    /// A check whose element begins, with the messages before it.
    pub fn begin(attributes: &Attributes, location: Option<Location>, infos: Vec<String>) -> Self {
        let kind = attributes.get("type").to_owned();
        let passed = attributes.get("success") == "true";
        Self { kind, passed, location, is_open: true, infos, ..Self::default() }
    }

    /// Takes the text of an element; false if the element is not a part of a check.
    pub fn take_text(&mut self, element: &str, text: &str) -> bool {
        match element {
            "Original" => text.clone_into(&mut self.original),
            "Expanded" => text.clone_into(&mut self.expanded),
            "Info" => self.infos.push(text.to_owned()),
            "Exception" if self.is_open => self.exception = Some(text.to_owned()),
            _ => return false,
        }
        true
    }

    /// The message of the complete check.
    pub fn message(self) -> Message {
        let Self { kind, passed, location, original, expanded, exception, infos, .. } = self;
        let text = match &exception {
            Some(exception) if original == UNKNOWN => format!("exception: {exception}"),
            Some(exception) => format!("{kind}({original}) threw: {exception}"),
            None if passed => format!("{kind}({original}): {expanded}"),
            None => assertion::failed_check(&kind, &original, &expanded),
        };
        // An exception in a check of exceptions is a failure; otherwise it is an error.
        let message_kind = match (passed, exception) {
            (true, _) => MessageKind::Check,
            (false, Some(_)) if !kind.contains("THROW") => MessageKind::Error,
            (false, _) => MessageKind::Failure,
        };
        let text = assertion::with_lines(text, &infos);
        let mut message = assertion::message(message_kind, &text, location);
        let compares = !passed && !kind.contains("FALSE");
        message.comparison = compares.then(|| assertion::comparison(&expanded)).flatten();
        message
    }
}
