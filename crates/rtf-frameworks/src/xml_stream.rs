//! Parses an XML document that arrives in pieces while a program writes it. Elements are
//! reported as they begin and end; what is no XML is an error with its line.

use std::borrow::Cow;

use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::framework::Garbage;

/// The longest text or tag.
const MAX_TOKEN_BYTES: usize = 16 << 20;

/// The mark with which a document in UTF-8 may begin.
const BYTE_ORDER_MARK: &str = "\u{feff}";

/// How much of a bad line an error quotes.
const QUOTED_CHARS: usize = 200;

#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Attributes(Vec<(String, String)>);

impl Attributes {
    /// The value of an attribute; empty if the element does not have it.
    #[must_use]
    pub fn get(&self, name: &str) -> &str {
        self.0.iter().find(|(known, _)| known == name).map_or("", |(_, value)| value)
    }
}

/// The beginning or the end of an element.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum XmlEvent {
    Start {
        name: String,
        attributes: Attributes,
    },
    End {
        name: String,
        /// The text in it, without that of the elements in it.
        text: String,
    },
}

/// A parser for one document.
#[derive(Debug, Default)]
pub struct XmlStream {
    /// Whether the document has begun, with or without a byte order mark.
    has_begun: bool,
    /// The end of the input that is no complete tag yet, and the text before it.
    buffer: Vec<u8>,
    /// How many bytes of the buffer were searched.
    searched: usize,
    /// How many lines precede the buffer.
    lines: usize,
    /// The open elements and their texts.
    open: Vec<(String, String)>,
    /// Whether the document's element has ended.
    is_complete: bool,
}

impl XmlStream {
    /// Reads the next bytes. Events that precede an error are added, too.
    ///
    /// # Errors
    /// The document is not well-formed, or something follows it.
    pub fn feed(&mut self, bytes: &[u8], events: &mut Vec<XmlEvent>) -> Result<(), Garbage> {
        self.buffer.extend_from_slice(bytes);
        if !self.has_begun && !self.begin() {
            return Ok(());
        }
        let mut at = 0;
        while let Some(end) = self.token_end(at) {
            // Each token has a parser, so that the size of the pieces cannot matter.
            let token = String::from_utf8_lossy(&self.buffer[at..end]).into_owned();
            self.parse(&token, events)?;
            self.lines += newlines(&self.buffer[at..end]);
            at = end;
        }
        self.buffer.drain(..at);
        self.searched -= at;
        let is_outside = self.open.is_empty();
        let start = self.buffer.trim_ascii_start();
        if is_outside && start.first().is_some_and(|first| *first != b'<') {
            let blank = self.buffer.len() - start.len();
            return Err(self.garbage(&String::from_utf8_lossy(&self.buffer), blank));
        }
        if self.buffer.len() > MAX_TOKEN_BYTES {
            let message = format!("line {}: a tag or text is too long", self.lines + 1);
            return Err(Garbage(message));
        }
        Ok(())
    }

    /// Whether the document has ended, and nothing follows it.
    #[must_use]
    pub fn is_complete(&self) -> bool {
        self.is_complete && self.buffer.trim_ascii().is_empty()
    }

    /// Skips a byte order mark; false if it cannot yet be known whether there is one.
    fn begin(&mut self) -> bool {
        let mark = BYTE_ORDER_MARK.as_bytes();
        if self.buffer.len() < mark.len() && mark.starts_with(&self.buffer) {
            return false;
        }
        self.has_begun = true;
        if self.buffer.starts_with(mark) {
            self.buffer.drain(..mark.len());
        }
        true
    }

    /// The end of the tag in the buffer after this position; `None` if it has not arrived.
    fn token_end(&mut self, from: usize) -> Option<usize> {
        let start = find(&self.buffer, b"<", self.searched.max(from));
        let end = start.and_then(|start| tag_end(&self.buffer, start));
        self.searched = end.or(start).unwrap_or(self.buffer.len());
        end
    }

    /// Parses a tag and the text before it.
    fn parse(&mut self, text: &str, events: &mut Vec<XmlEvent>) -> Result<(), Garbage> {
        // The parser would skip the mark, because it does not know what precedes the token.
        if text.starts_with(BYTE_ORDER_MARK) && !self.text(BYTE_ORDER_MARK) {
            return Err(self.garbage(text, 0));
        }
        let mut reader = Reader::from_str(text);
        let config = reader.config_mut();
        // Elements are open across tokens.
        config.allow_unmatched_ends = true;
        config.check_end_names = false;
        loop {
            let at = position(&reader, text);
            let event = reader.read_event().map_err(|_| self.garbage(text, at))?;
            let is_good = match event {
                Event::Eof => return Ok(()),
                Event::Start(tag) => self.start(&tag, events),
                Event::Empty(tag) => self.start(&tag, events) && self.end(&name(&tag), events),
                Event::End(tag) => self.end(tag.name().as_ref(), events),
                Event::Text(part) => self.text(&part.xml10_content()),
                Event::CData(part) => self.text(&part.xml10_content()),
                Event::GeneralRef(part) => match resolve(&part) {
                    Some(part) if !self.open.is_empty() => self.text(&part),
                    _ => false,
                },
                Event::Decl(_) | Event::PI(_) | Event::DocType(_) => self.open.is_empty(),
                Event::Comment(_) => true,
            };
            if !is_good {
                return Err(self.garbage(text, at));
            }
        }
    }

    /// An element begins; false if it must not be here.
    fn start(&mut self, tag: &BytesStart<'_>, events: &mut Vec<XmlEvent>) -> bool {
        let mut attributes = Vec::new();
        for attribute in tag.attributes() {
            let Ok(attribute) = attribute else { return false };
            let Ok(value) = quick_xml::escape::unescape(&attribute.value) else { return false };
            attributes.push((attribute.key.as_ref().to_owned(), value.into_owned()));
        }
        let name = name(tag).into_owned();
        if self.is_complete || name.is_empty() {
            return false;
        }
        self.open.push((name.clone(), String::new()));
        events.push(XmlEvent::Start { name, attributes: Attributes(attributes) });
        true
    }

    /// An element ends; false if it is not the one that began last.
    fn end(&mut self, name: &str, events: &mut Vec<XmlEvent>) -> bool {
        let Some((open, text)) = self.open.pop() else { return false };
        self.is_complete = self.open.is_empty();
        let is_right = open == name.trim_ascii_end();
        if is_right {
            events.push(XmlEvent::End { name: open, text });
        }
        is_right
    }

    /// Text; false if it is outside of the document and not blank.
    fn text(&mut self, part: &str) -> bool {
        match self.open.last_mut() {
            Some((_, text)) => text.push_str(part),
            None => return part.trim_ascii().is_empty(),
        }
        true
    }

    /// An error that quotes the line of the buffer at this position.
    fn garbage(&self, text: &str, at: usize) -> Garbage {
        let skipped = text[at..].len() - text[at..].trim_ascii_start().len();
        let at = at + skipped;
        let line = self.lines + newlines(&text.as_bytes()[..at]) + 1;
        let start = text[..at].rfind('\n').map_or(0, |newline| newline + 1);
        let quote = text[start..].lines().next().unwrap_or_default().trim();
        let quote: String = quote.chars().take(QUOTED_CHARS).collect();
        Garbage(format!("line {line} of the XML report: `{quote}`"))
    }
}

fn name<'a>(tag: &'a BytesStart<'_>) -> Cow<'a, str> {
    Cow::Borrowed(&tag[..tag.name().as_ref().len()])
}

fn position(reader: &Reader<&[u8]>, text: &str) -> usize {
    let at = usize::try_from(reader.buffer_position()).unwrap_or_default().min(text.len());
    (0..=at).rev().find(|at| text.is_char_boundary(*at)).unwrap_or_default()
}

/// The text of a reference such as `&lt;` or `&#10;`.
fn resolve(reference: &str) -> Option<String> {
    let text = format!("&{reference};");
    quick_xml::escape::unescape(&text).ok().map(Cow::into_owned)
}

fn newlines(bytes: &[u8]) -> usize {
    bytes.iter().filter(|byte| **byte == b'\n').count()
}

/// The position of `text` at or after `from`.
fn find(bytes: &[u8], text: &[u8], from: usize) -> Option<usize> {
    let found = bytes.get(from..)?.windows(text.len()).position(|window| window == text)?;
    Some(from + found)
}

/// The end of the tag, comment or section that begins here; `None` if it has not arrived.
fn tag_end(bytes: &[u8], start: usize) -> Option<usize> {
    const SPECIAL: [(&[u8], &[u8]); 3] =
        [(b"<!--", b"-->"), (b"<![CDATA[", b"]]>"), (b"<?", b"?>")];
    let tag = &bytes[start..];
    for (open, close) in SPECIAL {
        if tag.starts_with(open) {
            return Some(find(bytes, close, start + open.len())? + close.len());
        }
        if tag.len() < open.len() && open.starts_with(tag) {
            return None;
        }
    }
    let mut quote = None;
    for (at, byte) in tag.iter().enumerate() {
        match (quote, byte) {
            (None, b'>') => return Some(start + at + 1),
            (None, b'"' | b'\'') => quote = Some(*byte),
            (Some(open), close) if open == *close => quote = None,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests;
