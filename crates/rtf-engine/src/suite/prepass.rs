//! A pass over the raw text, before the XML parser sees it.
//!
//! The predecessor's parser accepted `--` inside comments, and a quarter of the
//! suite files in the wild have it; XML forbids it, and the parser refuses the
//! file. Such a comment's body is blanked here, byte for byte, so that all
//! positions stay. On the way this finds what the parser would report without
//! a place (a DTD) or could be slow on (very many attributes).

use std::borrow::Cow;

use super::Span;

/// More attributes than this on one element are refused: the parser's search
/// for duplicates is quadratic.
const MAX_ATTRIBUTES: usize = 256;

/// What the pass found.
#[derive(Debug, Default)]
pub(super) struct Scan<'a> {
    /// The text for the parser, as long as the original.
    pub text: Cow<'a, str>,
    /// The first `--` inside of each comment that has one.
    pub dashes: Vec<Span>,
    /// The first `<!DOCTYPE`.
    pub doctype: Option<Span>,
    /// The first tag with too many attributes.
    pub crowded: Option<Span>,
}

/// A piece of markup that starts with `<`.
enum Markup {
    Comment,
    CharacterData,
    Instruction,
    Declaration,
    Tag,
}

/// Looks through the text.
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
            Markup::Tag if found.crowded.is_none() => {
                let tag = &text[open..end.unwrap_or(text.len())];
                if tag.bytes().filter(|byte| *byte == b'=').count() > MAX_ATTRIBUTES
                    && attributes(tag) > MAX_ATTRIBUTES
                {
                    let name = tag.find(char::is_whitespace).unwrap_or(tag.len());
                    found.crowded = Some(Span::new(open..open + name));
                }
            }
            _ => {}
        }
        // What is not closed is the parser's to report.
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

/// The name of the first element, if the text begins like XML. Also reads
/// files that are not well-formed, or only their beginning.
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

/// The value of `encoding="…"` in the XML declaration.
pub(super) fn declared_encoding(text: &str) -> Option<(&str, Span)> {
    let declaration = &text[..text.strip_prefix("<?xml")?.find("?>")? + 5];
    let at = declaration.find("encoding")? + "encoding".len();
    let quote = at + declaration[at..].find(['"', '\''])?;
    let mark = char::from(declaration.as_bytes()[quote]);
    let length = declaration[quote + 1..].find(mark)?;
    let range = quote + 1..quote + 1 + length;
    Some((&text[range.clone()], Span::new(range)))
}

/// What begins at `open`, and the offset after its end.
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

/// The offset after the `>` that ends a tag; one inside quotes does not.
fn tag_end(tag: &str) -> Option<usize> {
    let mut quote = None;
    for (at, byte) in tag.bytes().enumerate() {
        match quote {
            Some(open) if open == byte => quote = None,
            Some(_) => {}
            None if byte == b'"' || byte == b'\'' => quote = Some(byte),
            None if byte == b'>' => return Some(at + 1),
            None => {}
        }
    }
    None
}

/// The number of `=` outside of quotes.
fn attributes(tag: &str) -> usize {
    let mut quote = None;
    let mut count = 0;
    for byte in tag.bytes() {
        match quote {
            Some(open) if open == byte => quote = None,
            Some(_) => {}
            None if byte == b'"' || byte == b'\'' => quote = Some(byte),
            None => count += usize::from(byte == b'='),
        }
    }
    count
}

/// The first `--` in a comment's body, or the `-` that touches its end.
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
    // Whole characters were replaced by spaces, so this is always UTF-8.
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
    fn a_dash_that_touches_the_end() {
        let found = scan("<a><!-- x ---></a>");
        assert_eq!(found.text, "<a><!--    --></a>");
        assert_eq!(found.dashes.len(), 1);
    }

    #[test]
    fn the_root_of_files_that_are_not_well_formed() {
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
        assert_eq!(scan(&format!("<a{many}/>")).crowded, Some(Span::new(0..2)));
        assert_eq!(scan(&format!("<a b='{}'/>", "=".repeat(300))).crowded, None);
    }

    proptest! {
        #[test]
        fn lengths_and_line_breaks_stay(text in "(<!--|-->|--|<a|>|\"|'|<!\\[CDATA\\[|\\]\\]>|ü|\n| |x){0,40}") {
            let found = scan(&text);
            prop_assert_eq!(found.text.len(), text.len());
            prop_assert_eq!(found.text.lines().count(), text.lines().count());
        }
    }
}
