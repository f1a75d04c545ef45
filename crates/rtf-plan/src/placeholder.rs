//! Placeholders in the texts of a suite: `${port:name}`, `${param:name}`.

use std::borrow::Cow;

#[derive(Debug, PartialEq, Eq)]
pub(crate) enum Segment<'a> {
    /// Literal text.
    Text(&'a str),
    /// The name between `${kind:` and `}`, and the offset of the `$`.
    Placeholder(&'a str, usize),
    /// The offset of an unclosed placeholder, which reaches to the end of the text.
    Unclosed(usize),
}

/// Splits a text at its placeholders, which begin with `open`: `${port:`.
/// A second `$` before it (`$${port:`) makes it literal text.
pub(crate) fn segments<'a>(text: &'a str, open: &'static str) -> Vec<Segment<'a>> {
    let mut segments = Vec::new();
    let mut done = 0;
    while let Some(found) = text[done..].find(open) {
        let start = done + found;
        let inside = start + open.len();
        if text[done..start].ends_with('$') {
            segments.push(Segment::Text(&text[done..start - 1]));
            segments.push(Segment::Text(open));
            done = inside;
            continue;
        }
        segments.push(Segment::Text(&text[done..start]));
        let Some(length) = text[inside..].find('}') else {
            segments.push(Segment::Unclosed(start));
            return segments;
        };
        segments.push(Segment::Placeholder(&text[inside..inside + length], start));
        done = inside + length + 1;
    }
    segments.push(Segment::Text(&text[done..]));
    segments
}

/// Replaces each placeholder by the result of `value`, which gets its name. One without a result is
/// kept.
pub(crate) fn replace<'v>(
    text: &str,
    open: &'static str,
    mut value: impl FnMut(&str) -> Option<Cow<'v, str>>,
) -> String {
    let mut replaced = String::with_capacity(text.len());
    for segment in segments(text, open) {
        match segment {
            Segment::Text(text) => replaced += text,
            Segment::Placeholder(name, start) => match value(name) {
                Some(value) => replaced += &value,
                None => replaced += &text[start..start + open.len() + name.len() + 1],
            },
            Segment::Unclosed(start) => replaced += &text[start..],
        }
    }
    replaced
}
