//! The text of a file, and places in it.

use std::sync::Arc;

use rtf_model::Label;

/// A range of bytes of a file. Files are far smaller than 4 GiB.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Span {
    /// The first byte.
    pub start: u32,
    /// The byte after the last one.
    pub end: u32,
}

impl Span {
    /// The span of a range; what lies beyond 4 GiB is cut off.
    #[must_use]
    pub fn new(range: std::ops::Range<usize>) -> Self {
        let cut = |offset| u32::try_from(offset).unwrap_or(u32::MAX);
        Self { start: cut(range.start), end: cut(range.end) }
    }

    /// The bytes, as a range.
    #[must_use]
    pub fn range(self) -> std::ops::Range<usize> {
        self.start as usize..self.end as usize
    }

    /// A part of it, counted from its start.
    #[must_use]
    pub fn part(self, part: std::ops::Range<usize>) -> Self {
        let start = self.start as usize;
        Self::new(start + part.start..start + part.end)
    }
}

/// A value and where it was written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Spanned<T> {
    /// The value.
    pub value: T,
    /// Where it was written.
    pub span: Span,
}

impl<T> Spanned<T> {
    /// A value with its place.
    pub fn new(value: T, span: Span) -> Self {
        Self { value, span }
    }
}

/// A file's text, kept to show places of it.
#[derive(Debug)]
pub struct Source {
    name: String,
    text: String,
    line_starts: Vec<u32>,
}

impl Source {
    /// A text under the name by which the user knows its file.
    #[must_use]
    pub fn new(name: impl Into<String>, text: impl Into<String>) -> Self {
        let text = text.into();
        let after_breaks = text.bytes().enumerate().filter(|(_, byte)| *byte == b'\n');
        let line_starts = std::iter::once(0)
            .chain(after_breaks.map(|(at, _)| u32::try_from(at + 1).unwrap_or(u32::MAX)))
            .collect();
        Self { name: name.into(), text, line_starts }
    }

    /// The file as the user named it.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its text, without a byte order mark.
    #[must_use]
    pub fn text(&self) -> &str {
        &self.text
    }

    /// A label for a place in this file.
    #[must_use]
    pub fn label(&self, span: Span, text: impl Into<String>) -> Label {
        let start = self.boundary(span.start as usize);
        let end = self.boundary(span.end as usize).max(start);
        let (line, column) = self.line_column(start);
        let text = text.into();
        Label { file: self.name.clone(), line, column, start: start as u64, end: end as u64, text }
    }

    /// The span of a whole line, counted from 1, without the white space around it.
    #[must_use]
    pub fn line_span(&self, line: u32) -> Option<Span> {
        let index = (line as usize).checked_sub(1)?;
        let start = *self.line_starts.get(index)? as usize;
        let end = self.line_starts.get(index + 1).map_or(self.text.len(), |end| *end as usize);
        let written = self.text.get(start..end)?;
        let indent = written.len() - written.trim_start().len();
        Some(Span::new(
            start + indent.min(written.trim_end().len())..start + written.trim_end().len(),
        ))
    }

    fn line_column(&self, offset: usize) -> (u32, u32) {
        let line = self.line_starts.partition_point(|start| *start as usize <= offset).max(1);
        let start = self.line_starts[line - 1] as usize;
        let column = self.text.get(start..offset).map_or(0, |before| before.chars().count()) + 1;
        (u32::try_from(line).unwrap_or(u32::MAX), u32::try_from(column).unwrap_or(u32::MAX))
    }

    /// The nearest character boundary that is not after `offset`.
    fn boundary(&self, offset: usize) -> usize {
        self.text.floor_char_boundary(offset)
    }
}

/// The texts that the diagnostics of an [`crate::plan::Outcome`] point at.
#[derive(Clone, Debug, Default)]
pub struct Sources {
    files: Vec<Arc<Source>>,
}

impl Sources {
    /// Keeps a text.
    pub fn add(&mut self, source: Arc<Source>) {
        self.files.push(source);
    }

    /// The text of a file by the name that labels use.
    #[must_use]
    pub fn text(&self, file: &str) -> Option<&str> {
        self.files.iter().find(|source| source.name == file).map(|source| source.text())
    }

    /// Keeps the texts of `more` as well.
    pub fn append(&mut self, more: Self) {
        self.files.extend(more.files);
    }

    /// Forgets the texts that `wanted` does not want.
    pub fn retain(&mut self, wanted: impl Fn(&str) -> bool) {
        self.files.retain(|source| wanted(&source.name));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_count_characters_and_offsets_count_bytes() {
        let source = Source::new("a.xml", "é\nöäü<x/>\n");
        let label = source.label(Span::new(9..11), "");
        assert_eq!((label.line, label.column, label.start, label.end), (2, 4, 9, 11));
        // An offset inside a character is moved to its start.
        assert_eq!(source.label(Span::new(1..1), "").start, 0);
        assert_eq!(source.line_span(2), Some(Span::new(3..13)));
        assert_eq!(source.line_span(9), None);
    }
}
