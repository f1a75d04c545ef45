//! The XML report of a program, whose document is an element of a known name.

use crate::framework::Garbage;
use crate::xml_stream::{XmlEvent, XmlStream};

/// Reads a report while the program writes it.
#[derive(Debug, Default)]
pub struct XmlReport {
    root: &'static str,
    stream: XmlStream,
    has_begun: bool,
}

impl XmlReport {
    /// A report whose document is this element.
    #[must_use]
    pub fn new(root: &'static str) -> Self {
        Self { root, ..Self::default() }
    }

    /// The events of a whole report; `None` if it is not complete, or not of this element.
    #[must_use]
    pub fn parse(root: &'static str, text: &[u8]) -> Option<Vec<XmlEvent>> {
        let mut report = Self::new(root);
        let (events, result) = report.feed(text);
        result.ok()?;
        report.stream.is_complete().then_some(events)
    }

    /// Reads the next bytes; returns the events, also those that precede an error.
    pub fn feed(&mut self, bytes: &[u8]) -> (Vec<XmlEvent>, Result<(), Garbage>) {
        let mut events = Vec::new();
        let result = self.stream.feed(bytes, &mut events);
        if !self.has_begun
            && let Some(XmlEvent::Start { name, .. }) = events.first()
        {
            if name != self.root {
                let garbage =
                    Garbage(format!("it begins with `<{name}`, not with `<{}`", self.root));
                return (Vec::new(), Err(garbage));
            }
            self.has_begun = true;
        }
        (events, result)
    }

    /// Whether the whole report was read.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.stream.is_complete()
    }

    /// Whether a part of the report was read, but not its end.
    #[must_use]
    pub fn is_incomplete(&self) -> bool {
        self.has_begun && !self.is_complete()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_document_is_the_expected_element() {
        for text in ["<?xml version='1.0'?><other/>", "<other>", "<other><run/></other>"] {
            let (events, result) = XmlReport::new("run").feed(text.as_bytes());
            let message = "it begins with `<other`, not with `<run`";
            assert_eq!((events.len(), result.unwrap_err().0.as_str()), (0, message), "{text}");
        }
        let mut report = XmlReport::new("run");
        for (text, events, is_incomplete) in
            [("<run>", 1, true), ("<other/>", 2, true), ("</run>", 1, false)]
        {
            let (read, result) = report.feed(text.as_bytes());
            assert!(result.is_ok(), "{text}");
            assert_eq!((read.len(), report.is_incomplete()), (events, is_incomplete), "{text}");
        }
        assert!(report.is_complete());
    }

    #[test]
    fn a_report_that_was_cut_is_none() {
        let texts = ["", "<run><case/>", "<run/><", "<other/>"];
        assert!(texts.iter().all(|text| XmlReport::parse("run", text.as_bytes()).is_none()));
        assert_eq!(XmlReport::parse("run", b"<run/>\n").map(|events| events.len()), Some(2));
    }
}
