//! Text as a terminal shows it: without escape sequences and other control characters.

use std::borrow::Cow;

const ESCAPE: char = '\u{1b}';

/// Returns the text without escape sequences and control characters; line ends and tabs are
/// kept. A backspace removes the character before it. An incomplete sequence at the end is
/// removed, too.
#[must_use]
pub fn plain_text(text: &str) -> Cow<'_, str> {
    if !text.contains(is_removed) {
        return Cow::Borrowed(text);
    }
    let mut plain = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((at, control)) = rest.char_indices().find(|(_, c)| is_removed(*c)) {
        plain.push_str(&rest[..at]);
        rest = &rest[at + control.len_utf8()..];
        match control {
            ESCAPE => rest = after_escape(rest),
            '\u{9b}' => rest = after_control_sequence(rest),
            '\u{90}' | '\u{98}' | '\u{9d}' | '\u{9e}' | '\u{9f}' => rest = after_string(rest),
            '\u{8}' => drop(plain.pop()),
            _ => {}
        }
    }
    plain.push_str(rest);
    Cow::Owned(plain)
}

fn is_removed(c: char) -> bool {
    c.is_control() && !matches!(c, '\n' | '\t')
}

/// The text after a sequence; `rest` follows its ESC. The sequences are those of ECMA-48.
fn after_escape(rest: &str) -> &str {
    let mut following = rest.chars();
    match following.next() {
        Some('[') => after_control_sequence(following.as_str()),
        Some(']' | 'P' | 'X' | '^' | '_') => after_string(following.as_str()),
        Some(' '..='/') => {
            let end = rest.trim_start_matches(|c| matches!(c, ' '..='/'));
            end.strip_prefix(|c| matches!(c, '0'..='~')).unwrap_or(end)
        }
        Some('0'..='~') => following.as_str(),
        _ => rest,
    }
}

/// Parameters, intermediate characters and a final one.
fn after_control_sequence(rest: &str) -> &str {
    let rest = rest.trim_start_matches(|c| matches!(c, '0'..='?'));
    let rest = rest.trim_start_matches(|c| matches!(c, ' '..='/'));
    rest.strip_prefix(|c| matches!(c, '@'..='~')).unwrap_or(rest)
}

/// A text that BEL or ST ends, such as the title of the window.
fn after_string(rest: &str) -> &str {
    let Some(end) = rest.find(|c: char| c.is_control()) else { return "" };
    let end = &rest[end..];
    let terminated = ["\u{7}", "\u{1b}\\", "\u{9c}"].iter().find_map(|st| end.strip_prefix(*st));
    terminated.unwrap_or(end)
}

#[cfg(test)]
mod tests {
    use super::plain_text;

    #[test]
    fn a_terminal_would_show_the_same() {
        for (text, plain) in [
            ("plain \u{e9}\tx\n", "plain \u{e9}\tx\n"),
            ("\x1b[1;32mREADY\x1b[0m on \x1b[4m5000\x1b[m", "READY on 5000"),
            ("\x1b[2K\x1b[1Gpxh> ", "pxh> "),
            ("\x1b]0;sim\x07up", "up"),
            ("\x1b]8;;http://x\x1b\\link\x1b]8;;\x1b\\ y", "link y"),
            ("\x1b(Bup\x1b7\x1b=!", "up!"),
            ("\u{9b}31mred\u{9c}\x1bPq#1\x1b\\.", "red."),
            ("|\x08/\x08-\x08done", "done"),
            ("\x07ding\0", "ding"),
            // Cut anywhere.
            ("up\x1b", "up"),
            ("up\x1b[", "up"),
            ("up\x1b[1;3", "up"),
            ("up\x1b]0;si", "up"),
            ("up\x1b]0;si\x1b", "up"),
            // A sequence that is none ends where it does.
            ("\x1b[1\u{e9}x", "\u{e9}x"),
        ] {
            assert_eq!(plain_text(text), plain, "{text:?}");
        }
    }
}
