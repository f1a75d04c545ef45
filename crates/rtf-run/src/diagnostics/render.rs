//! Renders diagnostics as text, in the form of rustc's.

use std::io::{self, Write};
use std::ops::Range;

use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Renderer, Snippet};
use rtf_model::{Diagnostic, Label, Severity};
use rtf_plan::suite::SourceMap;

#[cfg(test)]
mod tests;

/// Labels of one file that are further apart get separate snippets.
const NEAR_LINES: u32 = 50;

/// Writes each diagnostic, followed by an empty line.
///
/// # Errors
/// `out` cannot be written.
pub fn write(
    out: &mut dyn Write,
    diagnostics: &[Diagnostic],
    sources: &SourceMap,
    color: bool,
) -> io::Result<()> {
    let renderer = if color { Renderer::styled() } else { Renderer::plain() };
    for diagnostic in diagnostics {
        writeln!(out, "{}\n", renderer.render(&[group(diagnostic, sources)]))?;
    }
    Ok(())
}

fn group<'a>(diagnostic: &'a Diagnostic, sources: &'a SourceMap) -> Group<'a> {
    let level = match diagnostic.severity {
        Severity::Error => Level::ERROR,
        Severity::Warning => Level::WARNING,
    };
    let mut group = Group::with_title(level.primary_title(printable(&diagnostic.message)));
    for (number, labels) in nearby(&diagnostic.labels).into_iter().enumerate() {
        if let Some(snippet) = snippet(labels, number == 0, sources) {
            group = group.element(snippet);
        }
    }
    for note in &diagnostic.notes {
        group = group.element(Level::NOTE.message(printable(note)));
    }
    if let Some(hint) = &diagnostic.hint {
        group = group.element(Level::HELP.message(printable(hint)));
    }
    group
}

/// Groups consecutive labels that can share a snippet.
fn nearby(labels: &[Label]) -> Vec<&[Label]> {
    labels.chunk_by(|a, b| a.file == b.file && a.line.abs_diff(b.line) <= NEAR_LINES).collect()
}

/// The lines of a file that a group of labels spans.
fn snippet<'a>(
    labels: &'a [Label],
    first: bool,
    sources: &'a SourceMap,
) -> Option<Snippet<'a, Annotation<'a>>> {
    let file = labels.first()?.file.as_str();
    let text = sources.text(file).unwrap_or_default();
    let range = |label: &Label| span(text, label);
    let start = labels.iter().map(|label| range(label).start).min()?;
    let end = labels.iter().map(|label| range(label).end).max()?;
    let window_start = text[..start].rfind('\n').map_or(0, |at| at + 1);
    let window_end = text[end..].find('\n').map_or(text.len(), |at| end + at);
    let line = labels.iter().map(|label| label.line).min()?;
    let annotations = labels.iter().enumerate().map(|(index, label)| {
        let kind = match first && index == 0 {
            true => AnnotationKind::Primary,
            false => AnnotationKind::Context,
        };
        let range = range(label);
        let annotation = kind.span(range.start - window_start..range.end - window_start);
        annotation.label(Some(printable(&label.text)).filter(|text| !text.is_empty()))
    });
    let snippet = Snippet::source(&text[window_start..window_end])
        .path(file)
        .line_start(line as usize)
        .annotations(annotations);
    Some(snippet)
}

/// A label's range, limited to the text.
fn span(text: &str, label: &Label) -> Range<usize> {
    let cut = |offset: u64| {
        let offset = usize::try_from(offset).unwrap_or(usize::MAX);
        text.floor_char_boundary(offset.min(text.len()))
    };
    let start = cut(label.start);
    start..cut(label.end).max(start)
}

/// Replaces control characters, which could control the terminal: messages quote
/// files and the output of other programs.
fn printable(text: &str) -> String {
    let is_unsafe = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.chars().map(|c| if is_unsafe(c) { '\u{fffd}' } else { c }).collect()
}
