//! Reads the text and the attribute values of elements, and reports invalid ones.

use std::ops::RangeInclusive;
use std::time::Duration;

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::fixture_reference::{FixtureReferences, ReferenceUser};
use super::port_reference::Ports;
use super::{DurationError, SourceText, Span, Spanned, parse_duration};
use crate::wording::{nearest, quoted};

/// The state shared by the readers of all elements.
pub struct ElementReader<'a> {
    pub source: &'a SourceText,
    pub problems: &'a mut Vec<Diagnostic>,
    pub(super) ports: Ports,
    /// The element that is being read.
    pub(super) user: ReferenceUser,
    pub(super) fixture_references: FixtureReferences,
}

impl ElementReader<'_> {
    /// Returns an error at a place that needs no explanation.
    pub fn error(&self, code: &str, span: Span, message: impl Into<String>) -> Diagnostic {
        self.source.error(code, span, message)
    }

    pub fn report(&mut self, problem: Diagnostic) {
        self.problems.push(problem);
    }

    /// Returns the position of an element's `<name`.
    pub fn tag(node: Node<'_, '_>) -> Span {
        let start = node.range().start;
        // Includes a namespace prefix.
        let name = node.document().input_text()[start + 1..]
            .find(|c: char| c.is_whitespace() || c == '/' || c == '>')
            .unwrap_or_default();
        Span::new(start..start + 1 + name)
    }

    /// Returns the position of an attribute's name.
    pub fn name_span(node: Node<'_, '_>, name: &str) -> Option<Span> {
        Some(Span::new(node.attribute_node(name)?.range_qname()))
    }

    /// Returns the position of a text without the white space around it.
    pub fn trimmed(&self, text: Node<'_, '_>) -> Option<Span> {
        let range = text.range();
        let raw = self.source.text().get(range.clone())?;
        let start = range.start + (raw.len() - raw.trim_start().len());
        let end = range.start + raw.trim_end().len();
        (start < end).then(|| Span::new(start..end))
    }

    /// Reads the trimmed text of an element. Child elements may precede and
    /// follow it, but not divide it.
    pub fn text(&mut self, node: Node<'_, '_>) -> Option<Spanned<String>> {
        let mut found: Option<Spanned<String>> = None;
        for child in node.children().filter(Node::is_text) {
            let Some(span) = self.trimmed(child) else { continue };
            let text = child.text().unwrap_or_default().trim();
            match &found {
                None => found = Some(Spanned::new(text.to_owned(), span)),
                Some(first) => {
                    let name = node.tag_name().name();
                    let message = format!("the text of `<{name}>` is in several pieces");
                    let problem = Diagnostic::error("divided-text", message)
                        .label(self.source.label(span, "a further piece"))
                        .label(self.source.label(first.span, "the first piece"));
                    self.report(problem);
                    break;
                }
            }
        }
        found
    }

    pub fn attribute(&self, node: Node<'_, '_>, name: &str) -> Option<Spanned<String>> {
        let attribute = node.attribute_node(name)?;
        let span = Span::new(attribute.range_value());
        Some(Spanned::new(attribute.value().to_owned(), span))
    }

    /// Reads a trimmed attribute that must not be empty.
    pub fn word(&mut self, node: Node<'_, '_>, name: &str) -> Option<Spanned<String>> {
        let attribute = self.blank_preserving(node, name)?;
        Some(Spanned::new(attribute.value.trim().to_owned(), attribute.span))
    }

    /// Reads a word, and reports a missing attribute; `detail` follows its name in the message.
    pub fn required(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        detail: &str,
    ) -> Option<Spanned<String>> {
        if !node.has_attribute(name) {
            self.missing(node, &format!("the attribute `{name}`{detail}"));
        }
        self.word(node, name)
    }

    /// Reads a word that `parse` accepts, and reports another one: what it is, and a hint.
    pub fn parsed<T>(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        parse: impl FnOnce(&str) -> Option<T>,
        (what, hint): (&str, Option<&str>),
    ) -> Option<T> {
        let text = self.word(node, name)?;
        let value = parse(&text.value);
        if value.is_none() {
            self.wrong(name, &text, what, hint);
        }
        value
    }

    /// Reads an attribute that must not be blank, with the blanks at its ends.
    pub fn blank_preserving(&mut self, node: Node<'_, '_>, name: &str) -> Option<Spanned<String>> {
        let attribute = self.attribute(node, name)?;
        if attribute.value.trim().is_empty() {
            self.wrong(name, &attribute, "is empty", None);
            return None;
        }
        Some(attribute)
    }

    pub fn duration(&mut self, node: Node<'_, '_>, name: &str) -> Option<Duration> {
        let attribute = self.attribute(node, name)?;
        let parsed = parse_duration(&attribute.value);
        match &parsed {
            Ok(_) => {}
            Err(DurationError::Malformed) => {
                let hint = "write it like `250ms`, `1.5s`, `2min` or `1h 30m`; \
                            a bare number is seconds";
                self.wrong(name, &attribute, "is not a duration", Some(hint));
            }
            Err(error) => self.wrong(name, &attribute, &error.to_string(), None),
        }
        parsed.ok()
    }

    pub fn boolean(&mut self, node: Node<'_, '_>, name: &str) -> Option<bool> {
        self.choice(node, name, &[("true", true), ("false", false)])
    }

    /// Reads a whole number from `min` to one million.
    pub fn number(&mut self, node: Node<'_, '_>, name: &str, min: u32) -> Option<u32> {
        self.number_in(node, name, min..=1_000_000)
    }

    pub fn number_in(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        range: RangeInclusive<u32>,
    ) -> Option<u32> {
        let attribute = self.attribute(node, name)?;
        let number = attribute.value.trim().parse::<u32>().ok();
        let valid = number.filter(|number| range.contains(number));
        if valid.is_none() {
            let (min, max) = (range.start(), range.end());
            let expected = format!("is not a whole number from {min} to {max}");
            self.wrong(name, &attribute, &expected, None);
        }
        valid
    }

    /// Reads one of a fixed set of words.
    pub fn choice<T: Copy>(
        &mut self,
        node: Node<'_, '_>,
        name: &str,
        words: &[(&str, T)],
    ) -> Option<T> {
        let attribute = self.attribute(node, name)?;
        let word = attribute.value.trim();
        let found = words.iter().find(|(known, _)| *known == word).map(|(_, value)| *value);
        if found.is_none() {
            let list = quoted(words.iter().map(|(word, _)| *word), " or ");
            let expected = format!("has to be {list}");
            let nearest = nearest(word, words.iter().map(|(word, _)| *word));
            let hint = nearest.map(|word| format!("did you mean `{word}`?"));
            self.wrong(name, &attribute, &expected, hint.as_deref());
        }
        found
    }

    /// Reads words that are separated by white space or commas, each with its position.
    pub fn words(&self, node: Node<'_, '_>, name: &str) -> Vec<Spanned<String>> {
        let Some(attribute) = node.attribute_node(name) else { return Vec::new() };
        let range = attribute.range_value();
        let raw = self.source.text().get(range.clone()).unwrap_or_default();
        if raw != attribute.value() {
            // Entities or line breaks hide the positions of single words.
            let span = Span::new(range);
            let whole = |word: &str| Spanned::new(word.to_owned(), span);
            return split_words(attribute.value()).map(whole).collect();
        }
        split_words(raw)
            .map(|word| {
                let start = range.start + (word.as_ptr() as usize - raw.as_ptr() as usize);
                Spanned::new(word.to_owned(), Span::new(start..start + word.len()))
            })
            .collect()
    }

    /// Reports an invalid value: "`timeout` is not a duration: `soon`".
    pub fn wrong(&mut self, name: &str, value: &Spanned<String>, what: &str, hint: Option<&str>) {
        let message = if value.value.trim().is_empty() {
            format!("`{name}` is empty")
        } else {
            format!("`{name}` {what}: `{}`", value.value.trim())
        };
        let problem = self.error("invalid-value", value.span, message);
        self.report(Diagnostic { hint: hint.map(str::to_owned), ..problem });
    }

    /// Reports a repeated element. `seen` is the position of the first one.
    pub fn once(&mut self, node: Node<'_, '_>, seen: &mut Option<Span>) {
        let span = Self::tag(node);
        if let Some(first) = seen.replace(span) {
            let parent = node.parent_element().map_or("suite", |parent| parent.tag_name().name());
            let message = format!("`<{}>` twice in one {parent}", node.tag_name().name());
            let problem = Diagnostic::error("repeated-element", message)
                .label(self.source.label(span, "the second one"))
                .label(self.source.label(first, "the first one"));
            self.report(problem);
        }
    }

    /// Reports a missing part of an element.
    pub fn missing(&mut self, node: Node<'_, '_>, what: &str) {
        let name = node.tag_name().name();
        let message = format!("`<{name}>` needs {what}");
        self.report(self.error("incomplete", Self::tag(node), message));
    }
}

fn split_words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty())
}
