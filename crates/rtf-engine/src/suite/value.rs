//! Reads attribute values and text, and reports those of a wrong form.

use std::time::Duration;

use roxmltree::Node;
use rtf_model::Diagnostic;

use super::port::Ports;
use super::shape::nearest;
use super::{DurationError, Source, Span, Spanned, parse_duration};

/// What the readers of the elements share.
pub(super) struct Reader<'a> {
    /// The file.
    pub source: &'a Source,
    /// What is wrong with it so far.
    pub problems: &'a mut Vec<Diagnostic>,
    /// The ports that it names so far.
    pub ports: Ports,
}

impl Reader<'_> {
    /// Notes a problem and goes on.
    pub fn report(&mut self, problem: Diagnostic) {
        self.problems.push(problem);
    }

    /// The name of an element's start tag.
    pub fn tag(node: Node<'_, '_>) -> Span {
        let start = node.range().start;
        // The prefix of a name in a namespace belongs to the tag.
        let name = node.document().input_text()[start + 1..]
            .find(|c: char| c.is_whitespace() || c == '/' || c == '>')
            .unwrap_or_default();
        Span::new(start..start + 1 + name)
    }

    /// The place of a text without the white space around it.
    pub fn trimmed(&self, text: Node<'_, '_>) -> Option<Span> {
        let range = text.range();
        let written = self.source.text().get(range.clone())?;
        let start = range.start + (written.len() - written.trim_start().len());
        let end = range.start + written.trim_end().len();
        (start < end).then(|| Span::new(start..end))
    }

    /// The text of an element: one piece, trimmed. Child elements and comments
    /// may stand before and after it.
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

    /// An attribute's text.
    pub fn attribute(&self, node: Node<'_, '_>, name: &str) -> Option<Spanned<String>> {
        let attribute = node.attribute_node(name)?;
        let span = Span::new(attribute.range_value());
        Some(Spanned::new(attribute.value().to_owned(), span))
    }

    /// An attribute that may not be empty, trimmed.
    pub fn word(&mut self, node: Node<'_, '_>, name: &str) -> Option<Spanned<String>> {
        let attribute = self.attribute(node, name)?;
        let trimmed = attribute.value.trim();
        if trimmed.is_empty() {
            self.wrong(name, &attribute, "is empty", None);
            return None;
        }
        Some(Spanned::new(trimmed.to_owned(), attribute.span))
    }

    /// A duration.
    pub fn duration(&mut self, node: Node<'_, '_>, name: &str) -> Option<Duration> {
        let attribute = self.attribute(node, name)?;
        match parse_duration(&attribute.value) {
            Ok(duration) => Some(duration),
            Err(DurationError::Malformed) => {
                let hint = "write it like `250ms`, `1.5s`, `2min` or `1h 30m`; \
                            a bare number is seconds";
                self.wrong(name, &attribute, "is not a duration", Some(hint));
                None
            }
            Err(error) => {
                self.wrong(name, &attribute, &error.to_string(), None);
                None
            }
        }
    }

    /// `true` or `false`.
    pub fn truth(&mut self, node: Node<'_, '_>, name: &str) -> Option<bool> {
        self.choice(node, name, &[("true", true), ("false", false)])
    }

    /// A whole number from `least` to one million.
    pub fn number(&mut self, node: Node<'_, '_>, name: &str, least: u32) -> Option<u32> {
        const MOST: u32 = 1_000_000;
        let attribute = self.attribute(node, name)?;
        let number = attribute.value.trim().parse::<u32>().ok();
        let fitting = number.filter(|number| (least..=MOST).contains(number));
        if fitting.is_none() {
            let expected = format!("is not a whole number from {least} to {MOST}");
            self.wrong(name, &attribute, &expected, None);
        }
        fitting
    }

    /// One of a few words.
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
            let list: Vec<_> = words.iter().map(|(word, _)| format!("`{word}`")).collect();
            let expected = format!("has to be {}", list.join(" or "));
            let nearest = nearest(word, words.iter().map(|(word, _)| *word));
            let hint = nearest.map(|word| format!("did you mean `{word}`?"));
            self.wrong(name, &attribute, &expected, hint.as_deref());
        }
        found
    }

    /// Words between white space or commas, each with its place.
    pub fn words(&self, node: Node<'_, '_>, name: &str) -> Vec<Spanned<String>> {
        let Some(attribute) = node.attribute_node(name) else { return Vec::new() };
        let range = attribute.range_value();
        let written = self.source.text().get(range.clone()).unwrap_or_default();
        if written != attribute.value() {
            // Entities or line breaks: the places of single words are not known.
            let span = Span::new(range);
            let whole = |word: &str| Spanned::new(word.to_owned(), span);
            return split_words(attribute.value()).map(whole).collect();
        }
        split_words(written)
            .map(|word| {
                let start = range.start + (word.as_ptr() as usize - written.as_ptr() as usize);
                Spanned::new(word.to_owned(), Span::new(start..start + word.len()))
            })
            .collect()
    }

    /// Reports a value of a wrong form: "`timeout` is not a duration: `soon`".
    pub fn wrong(&mut self, name: &str, value: &Spanned<String>, what: &str, hint: Option<&str>) {
        let message = if value.value.trim().is_empty() {
            format!("`{name}` is empty")
        } else {
            format!("`{name}` {what}: `{}`", value.value.trim())
        };
        let problem = Diagnostic::error("invalid-value", message);
        let problem = problem.label(self.source.label(value.span, ""));
        self.report(match hint {
            Some(hint) => problem.hint(hint),
            None => problem,
        });
    }

    /// Reports an element that is there a second time; `seen` is the first one's place.
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

    /// Reports that something required is not there.
    pub fn missing(&mut self, node: Node<'_, '_>, what: &str) {
        let name = node.tag_name().name();
        let problem = Diagnostic::error("incomplete", format!("`<{name}>` needs {what}"));
        let label = self.source.label(Self::tag(node), "");
        self.report(problem.label(label));
    }
}

fn split_words(text: &str) -> impl Iterator<Item = &str> {
    text.split(|c: char| c.is_whitespace() || c == ',').filter(|word| !word.is_empty())
}
