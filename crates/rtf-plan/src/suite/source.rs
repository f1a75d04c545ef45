//! The text of a file, and positions in it.

use std::sync::Arc;

use rtf_model::{Diagnostic, Label};

/// A range of bytes in a file. Files are far smaller than 4 GiB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Span {
    /// The offset of the first byte.
    pub start: u32,
    /// The offset after the last byte.
    pub end: u32,
}

impl Span {
    /// Creates a span from a range; offsets are capped at 4 GiB.
    #[must_use]
    pub fn new(range: std::ops::Range<usize>) -> Self {
        let cut = |offset| u32::try_from(offset).unwrap_or(u32::MAX);
        Self { start: cut(range.start), end: cut(range.end) }
    }

    #[must_use]
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }

    /// Returns a part of the span; `part` is relative to its start.
    #[must_use]
    pub fn part(self, part: std::ops::Range<usize>) -> Self {
        let start = self.start as usize;
        Self::new(start + part.start..start + part.end)
    }
}

/// A value and its position in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spanned<T> {
    pub value: T,
    pub span: Span,
}

impl<T> Spanned<T> {
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

/// The text of a file or of a filter, from which diagnostics quote.
#[derive(Debug)]
pub struct SourceText {
    name: String,
    text: String,
    line_starts: Vec<u32>,
}

impl SourceText {
    /// `name` is the user's name of the file.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let text = text.into();
        let after_breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let line_starts = std::iter::once(0)
            .chain(after_breaks.map(|(at, _)| u32::try_from(at + 1).unwrap_or(u32::MAX)))
            .collect();
        Self { name: name.into(), text, line_starts }
    }

    /// Returns the user's name of the file.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns the text, without a byte order mark.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    #[must_use]
    pub fn label(&self, span: Span, text: impl Into<String>) -> Label {
        let start = self.boundary(span.start as usize);
        let end = self.boundary(span.end as usize).max(start);
        let (line, column) = self.line_column(start);
        let text = text.into();
        Label { file: self.name.clone(), line, column, start: start as u64, end: end as u64, text }
    }

    /// Returns an error at a place that needs no explanation.
    #[must_use]
    pub fn error(&self, code: &str, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic::error(code, message).label(self.label(span, ""))
    }

    /// Adds a place to a problem without one.
    #[must_use]
    pub fn locate(&self, problem: Diagnostic, span: Span) -> Diagnostic {
        if problem.labels.is_empty() { problem.label(self.label(span, "")) } else { problem }
    }

    /// Returns a warning at a place that needs no explanation.
    #[must_use]
    pub fn warning(&self, code: &str, span: Span, message: impl Into<String>) -> Diagnostic {
        Diagnostic::warning(code, message).label(self.label(span, ""))
    }

    /// Returns the line, from 1, in which a span starts.
    #[must_use]
    pub fn line(&self, span: Span) -> u32 {
        self.line_column(self.boundary(span.start as usize)).0
    }

    /// Returns the span of a line without the white space around it. Lines start at 1.
    #[must_use]
    pub fn line_span(&self, line: u32) -> Option<Span> {
        let index = (line as usize).checked_sub(1)?;
        let start = *self.line_starts.get(index)? as usize;
        let end = self.line_starts.get(index + 1).map_or(self.text.len(), |end| *end as usize);
        let raw = self.text.get(start..end)?;
        let indent = raw.len() - raw.trim_start().len();
        Some(Span::new(start + indent.min(raw.trim_end().len())..start + raw.trim_end().len()))
    }

    fn line_column(&self, offset: usize) -> (u32, u32) {
        let line = self.line_starts.partition_point(|start| *start as usize <= offset).max(1);
        let start = self.line_starts[line - 1] as usize;
        let column = self.text.get(start..offset).map_or(0, |before| before.chars().count()) + 1;
        (u32::try_from(line).unwrap_or(u32::MAX), u32::try_from(column).unwrap_or(u32::MAX))
    }

    /// Returns the last character boundary up to `offset`.
    fn boundary(&self, offset: usize) -> usize {
        self.text.floor_char_boundary(offset)
    }
}

/// The texts to which the labels of diagnostics refer.
#[derive(Clone, Debug, Default)]
pub struct SourceMap {
    files: Vec<Arc<SourceText>>,
}

impl SourceMap {
    pub fn add(&mut self, source: Arc<SourceText>) {
        self.files.push(source);
    }

    /// Returns the text of a file by its name in labels.
    #[must_use]
    pub fn text(&self, file: &str) -> Option<&str> {
        self.files.iter().find(|source| source.name == file).map(|source| source.text())
    }

    pub fn append(&mut self, more: Self) {
        self.files.extend(more.files);
    }

    /// Removes the texts for whose names `is_used` returns false.
    pub fn retain(&mut self, is_used: impl Fn(&str) -> bool) {
        self.files.retain(|source| is_used(&source.name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_offsets_count_bytes() {
        let source = SourceText::new("a.xml", "é\nöäü<x/>\n");
        let label = source.label(Span::new(9..11), "");
        assert_eq!((label.line, label.column, label.start, label.end), (2, 4, 9, 11));
        assert_eq!(source.line(Span::new(9..11)), 2);
        // An offset inside a character moves to its start.
        assert_eq!(source.label(Span::new(1..1), "").start, 0);
        assert_eq!(source.line_span(2), Some(Span::new(3..13)));
        assert_eq!(source.line_span(9), None);
    }
}
