//! Text → tokens.

use super::ParseError;
use super::tree::Span;
use crate::unit;

#[derive(Clone, Debug)]
pub(super) struct Token {
    pub kind: TokenKind,
    pub span: Span,
}

#[derive(Clone, Debug, PartialEq)]
pub(super) enum TokenKind {
    /// A finite number, and the unit that follows it without a space.
    Number(f64, Option<String>),
    /// A keyword or the name of a signal.
    Word(String),
    /// The name of a signal in quotes.
    Quoted(String),
    /// An operator or a bracket.
    Symbol(&'static str),
}

/// The longest come first.
const SYMBOLS: [&str; 16] =
    ["->", "<=", ">=", "==", "!=", "<", ">", "+", "-", "*", "/", "(", ")", "[", "]", ","];

/// What other languages write.
const FOREIGN: [(&str, &str); 8] = [
    ("&&", "write `and`"),
    ("&", "write `and`"),
    ("||", "write `or`"),
    ("|", "write `or`, or `abs(…)`"),
    ("!", "write `not`"),
    ("=>", "write `->`"),
    ("=", "write `==`"),
    ("~", "write `not`"),
];

pub(super) fn tokens(text: &str) -> Result<Vec<Token>, ParseError> {
    let mut tokens = Vec::new();
    let mut at = 0;
    loop {
        at += text[at..].len() - text[at..].trim_start().len();
        let rest = &text[at..];
        let Some(first) = rest.chars().next() else { return Ok(tokens) };
        let (kind, length) = if first.is_ascii_digit() || is_fraction(rest) {
            number(rest, at)?
        } else if is_name_start(first) {
            let length = name_length(rest);
            (TokenKind::Word(rest[..length].to_owned()), length)
        } else if first == '"' || first == '\'' {
            quoted(rest, first, at)?
        } else {
            symbol(rest, first, at)?
        };
        tokens.push(Token { kind, span: at..at + length });
        at += length;
    }
}

fn is_fraction(text: &str) -> bool {
    let bytes = text.as_bytes();
    bytes.len() > 1 && bytes[0] == b'.' && bytes[1].is_ascii_digit()
}

fn is_name_start(character: char) -> bool {
    character.is_alphabetic() || character == '_'
}

/// The length of a name: letters, digits, `_`, and `.` between these.
fn name_length(text: &str) -> usize {
    let mut end = 0;
    let mut characters = text.char_indices().peekable();
    while let Some((index, character)) = characters.next() {
        let is_part = character.is_alphanumeric() || character == '_';
        let next = characters.peek().map(|(_, next)| *next);
        let is_dot =
            character == '.' && next.is_some_and(|next| next.is_alphanumeric() || next == '_');
        if !is_part && !is_dot {
            break;
        }
        end = index + character.len_utf8();
    }
    end
}

fn number(text: &str, at: usize) -> Result<(TokenKind, usize), ParseError> {
    let length = digits_length(text);
    let value = text[..length].parse::<f64>().ok().filter(|value| value.is_finite());
    let Some(value) = value else {
        return Err(ParseError::new(at..at + length, "this number is too large or malformed"));
    };
    let unit = unit::literal_length(&text[length..]);
    let name = (unit > 0).then(|| text[length..length + unit].to_owned());
    let end = length + unit;
    let next = text[end..].chars().next().filter(|next| next.is_alphanumeric() || *next == '.');
    if let Some(next) = next {
        return Err(ParseError::new(at..at + end + next.len_utf8(), "malformed number"));
    }
    Ok((TokenKind::Number(value, name), end))
}

/// The length of `12`, `0.5`, `.5`, `1e-3`.
fn digits_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |mut from: usize| {
        while bytes.get(from).is_some_and(u8::is_ascii_digit) {
            from += 1;
        }
        from
    };
    let mut end = digits(0);
    if bytes.get(end) == Some(&b'.') {
        end = digits(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        let exponent = digits(end + 1 + sign);
        end = if exponent > end + 1 + sign { exponent } else { end };
    }
    end
}

fn quoted(text: &str, quote: char, at: usize) -> Result<(TokenKind, usize), ParseError> {
    let Some(length) = text[1..].find(quote) else {
        return Err(ParseError::new(at..at + 1, format!("the closing `{quote}` is missing")));
    };
    if length == 0 {
        return Err(ParseError::new(at..at + 2, "the name of a signal is empty"));
    }
    Ok((TokenKind::Quoted(text[1..=length].to_owned()), length + 2))
}

fn symbol(text: &str, first: char, at: usize) -> Result<(TokenKind, usize), ParseError> {
    let known = SYMBOLS.iter().find(|symbol| text.starts_with(**symbol));
    if let Some(symbol) = known {
        return Ok((TokenKind::Symbol(symbol), symbol.len()));
    }
    let error =
        |length| ParseError::new(at..at + length, format!("unexpected `{}`", &text[..length]));
    match FOREIGN.iter().find(|(foreign, _)| text.starts_with(foreign)) {
        Some((foreign, hint)) => Err(error(foreign.len()).hint(*hint)),
        None => Err(error(first.len_utf8())),
    }
}
