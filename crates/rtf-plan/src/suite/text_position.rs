//! Where a part of a decoded text is in the file, in which entities are longer.

use std::ops::Range;

use super::{SourceText, Span, Spanned};

/// Returns the position of a part of a value; of the whole value if the part cannot be found.
#[must_use]
pub fn position_of(source: &SourceText, value: &Spanned<String>, part: Range<usize>) -> Span {
    let raw = source.text().get(value.span.range()).unwrap_or_default();
    raw_range(raw, &value.value, &part).map_or(value.span, |range| value.span.part(range))
}

/// Finds the range of `raw` that was decoded to `part` of `value`. White space at both ends of
/// `raw` may be missing in `value`.
fn raw_range(raw: &str, value: &str, part: &Range<usize>) -> Option<Range<usize>> {
    let mut at = raw.len() - raw.trim_start().len();
    if value.starts_with(char::is_whitespace) {
        at = 0;
    }
    let mut start = (part.start == 0).then_some(at);
    for (offset, decoded) in value.char_indices() {
        if offset == part.start {
            start = Some(at);
        }
        if offset >= part.end {
            return start.map(|start| start..at);
        }
        at += raw_length(raw.get(at..)?, decoded)?;
    }
    Some(start.unwrap_or(at)..at)
}

/// The length of the text that was decoded to one character.
fn raw_length(raw: &str, decoded: char) -> Option<usize> {
    if raw.starts_with('&') {
        return raw.find(';').map(|end| end + 1);
    }
    if raw.starts_with("\r\n") {
        return Some(2);
    }
    let first = raw.chars().next()?;
    let is_same = first == decoded || (first.is_whitespace() && decoded.is_whitespace());
    is_same.then_some(first.len_utf8())
}

#[cfg(test)]
mod tests {
    use super::raw_range;

    #[test]
    fn a_part_is_found_behind_entities() {
        let (raw, value) = (" q &lt; 2 &amp;&#x26; ü > 1\r\n ", "q < 2 && ü > 1");
        let part = |text: &str| {
            let start = value.find(text).unwrap();
            raw_range(raw, value, &(start..start + text.len())).map(|range| &raw[range])
        };
        assert_eq!(part("q"), Some("q"));
        assert_eq!(part("<"), Some("&lt;"));
        assert_eq!(part("&& ü"), Some("&amp;&#x26; ü"));
        assert_eq!(part("> 1"), Some("> 1"));
        assert_eq!(raw_range(raw, value, &(value.len()..value.len())).unwrap().len(), 0);
        assert_eq!(raw_range("<![CDATA[q]]>", "q", &(0..1)), None);
    }
}
