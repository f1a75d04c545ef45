//! Escapes untrusted text: a plug-in's output must not move the cursor,
//! recolour the terminal, reverse what is read, or break an XML file.

use std::borrow::Cow;
use std::fmt::Write as _;

/// The text with every control character but line ends and tabs written out
/// (`\x1b`), and characters that change the text direction.
/// `\r\n` becomes `\n`.
#[must_use]
pub fn block(text: &str) -> Cow<'_, str> {
    escaped(text, &['\n', '\t'])
}

/// As [`block`], on one line: line breaks and tabs are escaped, too.
#[must_use]
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, &[])
}

/// As [`line()`], but with tabs: a line of a block.
#[must_use]
pub fn line_with_tabs(text: &str) -> Cow<'_, str> {
    escaped(text, &['\t'])
}

/// The text with every harmful character written out except those that are kept.
fn escaped<'a>(text: &'a str, kept: &[char]) -> Cow<'a, str> {
    if !text.chars().any(|c| is_harmful(c) && !kept.contains(&c)) {
        return text.into();
    }
    match kept.contains(&'\n') {
        true => written_out(&text.replace("\r\n", "\n"), kept).into(),
        false => written_out(text, kept).into(),
    }
}

fn is_harmful(c: char) -> bool {
    let changes_direction = matches!(
        c,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    let is_no_character = matches!(c, '\u{fffe}' | '\u{ffff}');
    c.is_control() || changes_direction || is_no_character
}

fn written_out(text: &str, kept: &[char]) -> String {
    let mut safe = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        match c {
            c if kept.contains(&c) || !is_harmful(c) => safe.push(c),
            '\n' => safe.push_str("\\n"),
            '\r' => safe.push_str("\\r"),
            '\t' => safe.push_str("\\t"),
            c => {
                let number = u32::from(c);
                let written = match number {
                    0..=0xFF => write!(safe, "\\x{number:02x}"),
                    _ => write!(safe, "\\u{{{number:x}}}"),
                };
                debug_assert!(written.is_ok(), "a string takes everything");
            }
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_obey_is_written_out() {
        assert_eq!(block("a\x1b[31mred\x07\0\u{9b}2J\x7f"), r"a\x1b[31mred\x07\x00\x9b2J\x7f");
        assert_eq!(block("user\u{202e}txt.exe"), r"user\u{202e}txt.exe");
    }

    #[test]
    fn a_block_keeps_its_lines_and_a_line_does_not() {
        assert_eq!(block("a\r\n\tb\rc"), "a\n\tb\\rc");
        assert_eq!(line("a\r\n\tb"), r"a\r\n\tb");
    }

    #[test]
    fn harmless_text_is_not_copied() {
        assert!(matches!(block("größe ≤ 3\n\tx"), Cow::Borrowed(_)));
        assert!(matches!(line("größe ≤ 3"), Cow::Borrowed(_)));
    }
}
