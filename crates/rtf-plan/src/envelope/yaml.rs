//! YAML with the position of each value.

use rtf_model::Diagnostic;
use saphyr_parser::{Event, Parser, ScalarStyle, ScanError};

use crate::suite::{SourceText, Span, Spanned};

/// The deepest nesting; a file of limits needs five levels.
const MAX_DEPTH: usize = 16;

#[derive(Clone, Debug)]
pub(super) struct Node {
    pub span: Span,
    pub value: Value,
}

#[derive(Clone, Debug)]
pub(super) enum Value {
    /// Nothing, `~` or `null`.
    Null,
    /// A text; numbers are not distinguished.
    Text(String),
    List(Vec<Node>),
    /// A mapping, in order.
    Map(Vec<(Spanned<String>, Node)>),
}

impl Node {
    /// The entries of a mapping.
    pub fn entries(&self) -> &[(Spanned<String>, Node)] {
        match &self.value {
            Value::Map(entries) => entries,
            _ => &[],
        }
    }

    /// What it is, for messages.
    pub fn kind(&self) -> &'static str {
        match self.value {
            Value::Null => "nothing",
            Value::Text(_) => "a text or number",
            Value::List(_) => "a list",
            Value::Map(_) => "a mapping",
        }
    }
}

/// Parses a document; `None` if it is not YAML, which is reported.
pub(super) fn parse(source: &SourceText, problems: &mut Vec<Diagnostic>) -> Option<Node> {
    let mut reader = Reader {
        source,
        offsets: source.text().char_indices().map(|(offset, _)| offset).collect(),
        open: Vec::new(),
        root: None,
        problems,
    };
    for event in Parser::new_from_str(source.text()) {
        match event {
            Ok((event, span)) => {
                let span = reader.span(span);
                reader.event(event, span)?;
            }
            Err(error) => {
                reader.malformed(&error);
                return None;
            }
        }
    }
    let root = reader.root.take();
    if root.is_none() {
        let message = format!("`{}` is empty", source.name());
        let label = source.label(Span::new(0..0), "limits are expected here");
        problems.push(Diagnostic::error("incomplete", message).label(label));
    }
    root
}

/// A list or mapping whose end was not read yet.
struct Open {
    node: Node,
    /// The key whose value follows.
    key: Option<Spanned<String>>,
}

struct Reader<'a> {
    source: &'a SourceText,
    /// The byte offset of each character.
    offsets: Vec<usize>,
    open: Vec<Open>,
    root: Option<Node>,
    problems: &'a mut Vec<Diagnostic>,
}

impl Reader<'_> {
    /// Adds a part of the document; `None` if the rest cannot be read.
    fn event(&mut self, event: Event<'_>, span: Span) -> Option<()> {
        match event {
            Event::Scalar(text, style, anchor, tag) => {
                self.refuse(span, anchor != 0, tag.is_some())?;
                let is_null = style == ScalarStyle::Plain && matches!(&*text, "" | "~" | "null");
                let value = if is_null { Value::Null } else { Value::Text(text.into_owned()) };
                self.add(Node { span, value });
            }
            Event::SequenceStart(anchor, tag) => {
                self.refuse(span, anchor != 0, tag.is_some())?;
                self.start(Node { span, value: Value::List(Vec::new()) })?;
            }
            Event::MappingStart(anchor, tag) => {
                self.refuse(span, anchor != 0, tag.is_some())?;
                self.start(Node { span, value: Value::Map(Vec::new()) })?;
            }
            Event::SequenceEnd | Event::MappingEnd => {
                let mut node = self.open.pop()?.node;
                node.span = Span::new(node.span.range().start..span.range().end);
                self.add(node);
            }
            Event::Alias(_) => self.refuse(span, true, false)?,
            Event::DocumentStart(_) if self.root.is_some() => {
                self.report(span, "a second document", "a file has one document");
                return None;
            }
            _ => {}
        }
        Some(())
    }

    fn start(&mut self, node: Node) -> Option<()> {
        if self.open.len() >= MAX_DEPTH {
            self.report(node.span, "the value is nested too deeply", "limits have few levels");
            return None;
        }
        self.open.push(Open { node, key: None });
        Some(())
    }

    fn add(&mut self, node: Node) {
        let Some(open) = self.open.last_mut() else {
            self.root = Some(node);
            return;
        };
        let problem = match &mut open.node.value {
            Value::List(items) => {
                items.push(node);
                None
            }
            Value::Map(entries) => match open.key.take() {
                Some(key) => add_entry(entries, (key, node), self.source),
                None => {
                    let (key, problem) = key_of(node, self.source);
                    open.key = Some(key);
                    problem
                }
            },
            Value::Null | Value::Text(_) => None,
        };
        self.problems.extend(problem);
    }

    /// Reports anchors, aliases and tags.
    fn refuse(&mut self, span: Span, is_anchor: bool, is_tag: bool) -> Option<()> {
        let what = match (is_anchor, is_tag) {
            (true, _) => "anchors and aliases are not supported",
            (_, true) => "tags are not supported",
            _ => return Some(()),
        };
        self.report(span, what, "write the value itself");
        None
    }

    fn report(&mut self, span: Span, message: &str, hint: &str) {
        self.problems.push(self.source.error("not-limits", span, message).hint(hint));
    }

    fn malformed(&mut self, error: &ScanError) {
        let at = self.offset(error.marker().index());
        let message = format!("`{}` is not YAML: {}", self.source.name(), error.info());
        self.problems.push(self.source.error("not-yaml", Span::new(at..at), message));
    }

    fn span(&self, span: saphyr_parser::Span) -> Span {
        let start = self.offset(span.start.index());
        let end = self.offset(span.end.index()).max(start);
        let text = self.source.text().get(start..end).unwrap_or_default();
        Span::new(start..start + text.trim_end().len())
    }

    fn offset(&self, index: usize) -> usize {
        self.offsets.get(index).copied().unwrap_or(self.source.text().len())
    }
}

/// Adds an entry to a mapping; returns a problem if its key is not new.
fn add_entry(
    entries: &mut Vec<(Spanned<String>, Node)>,
    (key, value): (Spanned<String>, Node),
    source: &SourceText,
) -> Option<Diagnostic> {
    let Some((first, _)) = entries.iter().find(|(known, _)| known.value == key.value) else {
        entries.push((key, value));
        return None;
    };
    let problem = Diagnostic::error("duplicate", format!("the key `{}` twice", key.value))
        .label(source.label(key.span, "the second one"))
        .label(source.label(first.span, "the first one"));
    Some(problem)
}

/// A key of a mapping, and a problem if it is not a text.
fn key_of(node: Node, source: &SourceText) -> (Spanned<String>, Option<Diagnostic>) {
    let (text, problem) = match node.value {
        Value::Text(text) => (text, None),
        _ => {
            let problem = Diagnostic::error("not-limits", "a key is not a text");
            (String::new(), Some(problem.label(source.label(node.span, "write a name"))))
        }
    };
    (Spanned::new(text, node.span), problem)
}
