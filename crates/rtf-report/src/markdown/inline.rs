//! Text of plug-ins in Markdown: nothing in it is markup, neither of Markdown nor of HTML.

use std::fmt::Write as _;

use crate::{escape, words};

/// Maximum number of characters of a text on one line.
const CHARACTERS: usize = 300;

/// Maximum number of lines of a block.
const LINES: usize = 60;

/// Text on one line that is shown literally, also in a table. Code hosts find no names of
/// users, issues or emoji in it.
#[must_use]
pub fn code(text: &str) -> String {
    format!("<code>{}</code>", literal(&cut(&escape::line(text))))
}

/// The first line of a text as [`code`].
pub(super) fn first_line(text: &str) -> String {
    code(&words::first_line(text))
}

/// Text of the runner, part of which may be that of a plug-in.
#[must_use]
pub fn words(text: &str) -> String {
    literal(&cut(&escape::line(text)))
}

/// A link to an address; [`code`] if it is none of the web.
pub(super) fn link(text: &str, url: &str) -> String {
    if !["https://", "http://"].iter().any(|scheme| url.starts_with(scheme)) {
        return format!("{text} {}", code(url));
    }
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-._~:/?#@!$&*+,;=%".contains(c);
    let mut address = String::new();
    for c in url.chars() {
        let mut bytes = [0; 4];
        match is_plain(c) {
            true => address.push(c),
            false => c.encode_utf8(&mut bytes).bytes().for_each(|byte| percent(&mut address, byte)),
        }
    }
    format!("[{text}](<{address}>)")
}

fn percent(address: &mut String, byte: u8) {
    let written = write!(address, "%{byte:02X}");
    debug_assert!(written.is_ok(), "a string takes everything");
}

/// Lines that are shown literally: the first ones and the last ones of a long text.
pub(super) fn block<'a>(page: &mut String, lines: impl IntoIterator<Item = &'a str>) {
    let lines: Vec<_> = lines.into_iter().map(|line| cut(&escape::line_with_tabs(line))).collect();
    let omitted = lines.len().saturating_sub(LINES);
    let (head, tail) = if omitted > 0 { (LINES / 2, LINES / 2) } else { (lines.len(), 0) };
    let fence = fence(&lines);
    *page += &format!("{fence}text\n");
    lines[..head].iter().for_each(|line| *page += &format!("{line}\n"));
    if omitted > 0 {
        *page += &format!("[… {} left out …]\n", words::count(omitted as u64, "line"));
    }
    lines[lines.len() - tail..].iter().for_each(|line| *page += &format!("{line}\n"));
    *page += &format!("{fence}\n");
}

/// Backticks that do not occur in the lines.
fn fence(lines: &[String]) -> String {
    let runs = lines.iter().flat_map(|line| line.split(|c| c != '`')).map(str::len);
    "`".repeat(runs.max().unwrap_or(0).max(2) + 1)
}

/// The beginning of a text, and the number of characters that are left out.
fn cut(text: &str) -> String {
    let total = text.chars().count();
    if total <= CHARACTERS {
        return text.to_owned();
    }
    let kept: String = text.chars().take(CHARACTERS).collect();
    format!("{kept} [… {} left out]", words::count((total - CHARACTERS) as u64, "character"))
}

/// ASCII punctuation with a meaning as character references.
fn literal(text: &str) -> String {
    let mut literal = String::with_capacity(text.len() + 16);
    let mut chars = text.chars();
    while let Some(c) = chars.next() {
        let rest = chars.as_str();
        // Only `://` makes an address.
        let is_active = "&<>`*_[]\\~|@#$".contains(c) || (c == ':' && rest.starts_with("//"));
        let written = match is_active {
            true => write!(literal, "&#{};", u32::from(c)),
            false => literal.write_char(c),
        };
        debug_assert!(written.is_ok(), "a string takes everything");
    }
    literal
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use pulldown_cmark::{Event, Options, Parser, Tag, TagEnd};

    use super::*;

    /// Those of code hosts.
    const OPTIONS: Options = Options::ENABLE_TABLES
        .union(Options::ENABLE_STRIKETHROUGH)
        .union(Options::ENABLE_TASKLISTS)
        .union(Options::ENABLE_FOOTNOTES)
        .union(Options::ENABLE_GFM)
        .union(Options::ENABLE_MATH);

    /// The text that a renderer shows, and whether it found anything but text.
    fn rendered(markdown: &str) -> (String, bool) {
        let (mut shown, mut is_pure) = (String::new(), true);
        for event in Parser::new_ext(markdown, OPTIONS) {
            match event {
                Event::Text(text) => shown.push_str(&text),
                Event::InlineHtml(html) if ["<code>", "</code>"].contains(&&*html) => {}
                Event::Start(Tag::Paragraph | Tag::CodeBlock(_)) => {}
                Event::Start(Tag::Table(_) | Tag::TableHead | Tag::TableRow | Tag::TableCell) => {}
                Event::End(
                    TagEnd::Paragraph
                    | TagEnd::CodeBlock
                    | TagEnd::Table
                    | TagEnd::TableHead
                    | TagEnd::TableRow
                    | TagEnd::TableCell,
                ) => {}
                _ => is_pure = false,
            }
        }
        (shown, is_pure)
    }

    const NASTY: &str = r"[-a|`*_<>&\[\]()!#~@:/\\. \t\n$^{}=+'\x1b\u{202e}é]{0,80}";

    proptest! {
        #[test]
        fn text_on_a_line_is_shown_literally(text in NASTY) {
            let (shown, is_pure) = rendered(&format!("x {} y", code(&text)));
            prop_assert!(is_pure);
            prop_assert_eq!(shown, format!("x {} y", escape::line(&text)));
        }

        #[test]
        fn text_in_a_table_stays_in_its_cell(text in NASTY) {
            let table = format!("| a | b |\n|---|---|\n| x{}y | z |\n", code(&text));
            let (shown, is_pure) = rendered(&table);
            prop_assert!(is_pure);
            prop_assert_eq!(shown, format!("abx{}yz", escape::line(&text)));
        }

        #[test]
        fn a_block_is_shown_literally(lines in proptest::collection::vec(NASTY, 1..9)) {
            let mut page = String::new();
            block(&mut page, lines.iter().map(String::as_str));
            let (shown, is_pure) = rendered(&page);
            prop_assert!(is_pure);
            let expected: String =
                lines.iter().map(|line| format!("{}\n", escape::line_with_tabs(line))).collect();
            prop_assert_eq!(shown, expected);
        }

        #[test]
        fn a_link_has_one_target(path in NASTY) {
            let page = link("results", &format!("https://ci.example/{path}"));
            let targets: Vec<_> = Parser::new_ext(&page, OPTIONS).filter_map(|event| match event {
                Event::Start(Tag::Link { dest_url, .. }) => Some(dest_url.into_string()),
                _ => None,
            }).collect();
            prop_assert_eq!(targets.len(), 1);
            prop_assert!(targets[0].starts_with("https://ci.example/"));
        }
    }

    #[test]
    fn only_addresses_of_the_web_are_links() {
        assert_eq!(link("results", "javascript:x"), "results <code>javascript:x</code>");
    }

    #[test]
    fn what_is_left_out_is_stated() {
        let long = "x".repeat(CHARACTERS + 7);
        assert!(code(&long).ends_with("xxx &#91;… 7 characters left out&#93;</code>"));
        let lines: Vec<_> = (0..LINES + 5).map(|number| number.to_string()).collect();
        let mut page = String::new();
        block(&mut page, lines.iter().map(String::as_str));
        assert!(page.contains("\n29\n[… 5 lines left out …]\n35\n"), "{page}");
        assert!(page.ends_with("\n64\n```\n"), "{page}");
    }
}
