//! A pass over the raw text before the XML parser.
//!
//! XML forbids `--` inside comments, and the parser refuses such a file. The
//! predecessor's parser accepted it, and a quarter of the suite files in the
//! wild contain it. The pre-pass overwrites the body of such a comment with
//! spaces, so that all positions stay the same. It also detects a DTD, which the
//! parser reports without a position, and tags with very many attributes, on
//! which the parser is slow.

use std::borrow::Cow;

use super::Span;

/// The maximum number of attributes of an element: the parser's search for
/// duplicates is quadratic.
const MAX_ATTRIBUTES: usize = 256;

/// The result of the pass.
#[derive(Debug, Default)]
pub(super) struct Scan<'a> {
    /// The text for the parser; it has the length of the original.
    pub text: Cow<'a, str>,
    /// The first `--` inside each comment that contains one.
    pub dashes: Vec<Span>,
    /// The first `<!DOCTYPE`.
    pub doctype: Option<Span>,
    /// The first tag with too many attributes.
    pub too_many_attributes: Option<Span>,
}

/// The kinds of markup that start with `<`.
enum Markup {
    Comment,
    CharacterData,
    Instruction,
    Declaration,
    Tag,
}

pub(super) fn scan(text: &str) -> Scan<'_> {
    let mut found = Scan::default();
    let mut blank = Vec::new();
    let mut at = 0;
    while let Some(open) = text[at..].find('<').map(|offset| at + offset) {
        let (markup, end) = markup_at(text, open);
        match markup {
            Markup::Comment => {
                let body = open + 4..end.unwrap_or(text.len()).saturating_sub(3).max(open + 4);
                if end.is_some()
                    && let Some(dashes) = dashes_in(text, body.clone())
                {
                    found.dashes.push(dashes);
                    blank.push(body);
                }
            }
            Markup::Declaration if found.doctype.is_none() && is_doctype(&text[open..]) => {
                found.doctype = Some(Span::new(open..open + DOCTYPE.len()));
            }
            Markup::Tag if found.too_many_attributes.is_none() => {
                let tag = &text[open..end.unwrap_or(text.len())];
                if tag.bytes().filter(|byte| *byte == b'=').count() > MAX_ATTRIBUTES
                    && count_attributes(tag) > MAX_ATTRIBUTES
                {
                    let name = tag.find(char::is_whitespace).unwrap_or(tag.len());
                    found.too_many_attributes = Some(Span::new(open..open + name));
                }
            }
            _ => {}
        }
        // The parser reports unclosed markup.
        let Some(end) = end else { break };
        at = end;
    }
    found.text = blanked(text, &blank);
    found
}

const DOCTYPE: &str = "<!DOCTYPE";

fn is_doctype(declaration: &str) -> bool {
    declaration.get(..DOCTYPE.len()).is_some_and(|start| start.eq_ignore_ascii_case(DOCTYPE))
}

/// Returns the name of the first element. The text may be malformed, or only
/// the beginning of a file.
pub(super) fn root_name(text: &str) -> Option<&str> {
    let mut at = 0;
    while let Some(open) = text[at..].find('<').map(|offset| at + offset) {
        let (markup, end) = markup_at(text, open);
        if let Markup::Tag = markup {
            let name = &text[open + 1..];
            let length = name.find(|c: char| c.is_whitespace() || c == '/' || c == '>');
            return Some(&name[..length?]);
        }
        at = end?;
    }
    None
}

/// Returns the value of `encoding="…"` in the XML declaration.
pub(super) fn declared_encoding(text: &str) -> Option<(&str, Span)> {
    let declaration = &text[..text.strip_prefix("<?xml")?.find("?>")? + 5];
    let at = declaration.find("encoding")? + "encoding".len();
    let quote = at + declaration[at..].find(['"', '\''])?;
    let mark = char::from(declaration.as_bytes()[quote]);
    let length = declaration[quote + 1..].find(mark)?;
    let range = quote + 1..quote + 1 + length;
    Some((&text[range.clone()], Span::new(range)))
}

/// Returns the kind of the markup at `open` and the offset after its end.
fn markup_at(text: &str, open: usize) -> (Markup, Option<usize>) {
    let rest = &text[open..];
    let until = |skip: usize, mark: &str| {
        rest.get(skip..)?.find(mark).map(|offset| open + skip + offset + mark.len())
    };
    if rest.starts_with("<!--") {
        (Markup::Comment, until(4, "-->"))
    } else if rest.starts_with("<![CDATA[") {
        (Markup::CharacterData, until(9, "]]>"))
    } else if rest.starts_with("<?") {
        (Markup::Instruction, until(2, "?>"))
    } else if rest.starts_with("<!") {
        (Markup::Declaration, until(2, ">"))
    } else {
        (Markup::Tag, tag_end(rest).map(|end| open + end))
    }
}

/// Returns the offset after the `>` that ends a tag, skipping quoted text.
fn tag_end(tag: &str) -> Option<usize> {
    unquoted(tag).find(|(_, byte)| *byte == b'>').map(|(at, _)| at + 1)
}

/// Counts the `=` outside of quotes.
fn count_attributes(tag: &str) -> usize {
    unquoted(tag).filter(|(_, byte)| *byte == b'=').count()
}

/// Returns the bytes outside of quoted text, and their offsets.
fn unquoted(tag: &str) -> impl Iterator<Item = (usize, u8)> {
    let mut quote = None;
    tag.bytes().enumerate().filter(move |(_, byte)| {
        match quote {
            Some(open) if open == *byte => quote = None,
            None if matches!(byte, b'"' | b'\'') => quote = Some(*byte),
            open => return open.is_none(),
        }
        false
    })
}

/// Finds the first `--` in a comment's body, or a `-` directly before its end.
fn dashes_in(text: &str, body: std::ops::Range<usize>) -> Option<Span> {
    let inside = text.get(body.clone())?;
    if let Some(offset) = inside.find("--") {
        let start = body.start + offset;
        return Some(Span::new(start..start + 2));
    }
    inside.ends_with('-').then(|| Span::new(body.end - 1..body.end + 2))
}

fn blanked<'a>(text: &'a str, ranges: &[std::ops::Range<usize>]) -> Cow<'a, str> {
    if ranges.is_empty() {
        return Cow::Borrowed(text);
    }
    let mut bytes = text.as_bytes().to_vec();
    for range in ranges {
        for byte in &mut bytes[range.clone()] {
            if *byte != b'\n' && *byte != b'\r' {
                *byte = b' ';
            }
        }
    }
    // Only whole characters were replaced, so this is always UTF-8.
    String::from_utf8(bytes).map_or(Cow::Borrowed(text), Cow::Owned)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn only_comments_with_dashes_are_blanked() {
        let text =
            "<a><!-- ok --><b c=\"<!-- -- -->\"/><!-- x\n--ü y--><![CDATA[<!-- -- -->]]></a>";
        let found = scan(text);
        let expected =
            "<a><!-- ok --><b c=\"<!-- -- -->\"/><!--  \n      --><![CDATA[<!-- -- -->]]></a>";
        assert_eq!(found.text, expected);
        assert_eq!(found.text.len(), text.len());
        assert_eq!(found.dashes, [Span::new(41..43)]);
    }

    #[test]
    fn a_dash_directly_before_the_end() {
        let found = scan("<a><!-- x ---></a>");
        assert_eq!(found.text, "<a><!--    --></a>");
        assert_eq!(found.dashes.len(), 1);
    }

    #[test]
    fn the_root_of_malformed_files() {
        let text = "<?xml version='1.0'?><!-- a -- b --><suite name='x'><test>";
        assert_eq!(root_name(text), Some("suite"));
        assert_eq!(root_name("<robot/>"), Some("robot"));
        assert_eq!(root_name("no markup"), None);
    }

    #[test]
    fn the_declared_encoding() {
        let (encoding, span) =
            declared_encoding("<?xml version='1.0' encoding='latin1'?><a/>").unwrap();
        assert_eq!((encoding, span), ("latin1", Span::new(30..36)));
        assert_eq!(declared_encoding("<a encoding='x'/>"), None);
    }

    #[test]
    fn too_many_attributes() {
        let many: String = (0..300).map(|n| format!(" a{n}='='")).collect();
        assert_eq!(scan(&format!("<a{many}/>")).too_many_attributes, Some(Span::new(0..2)));
        assert_eq!(scan(&format!("<a b='{}'/>", "=".repeat(300))).too_many_attributes, None);
    }

    proptest! {
        #[test]
        fn lengths_and_line_breaks_are_preserved(text in "(<!--|-->|--|<a|>|\"|'|<!\\[CDATA\\[|\\]\\]>|ü|\n| |x){0,40}") {
            let found = scan(&text);
            prop_assert_eq!(found.text.len(), text.len());
            prop_assert_eq!(found.text.lines().count(), text.lines().count());
        }
    }
}
