//! Lines that wait to be written, in the console's columns.
//!
//! The details of one entry are limited: a failure may contain a large value.

use std::borrow::Cow;

use anstyle::Style;

use super::style;
use crate::explain::Tone;
use crate::words;

/// The column in which details begin: below the names of tests.
const DETAIL: usize = 13;

/// Maximum number of details of an entry.
const DETAILS: usize = 200;

/// Maximum number of characters of a detail.
const CHARS: usize = 400;

/// Lines that wait to be written.
#[derive(Debug, Default)]
pub(super) struct ConsoleLines {
    /// What waits.
    pub text: String,
    /// Where all details are shown; without it, this does.
    everything: Option<String>,
    /// The number of details of the entry.
    details: usize,
    has_cut_detail: bool,
}

impl ConsoleLines {
    /// Lines with limited details; `everything` is the advice that shows all of them.
    pub fn limited(everything: String) -> Self {
        Self { everything: Some(everything), ..Self::default() }
    }

    pub fn line(&mut self, text: &str) {
        self.end_entry();
        self.push(text);
    }

    /// The heading of a list at the end of the run.
    pub fn heading(&mut self, style: Style, text: &str) {
        self.line("");
        self.line(&style::paint(style, text));
    }

    fn push(&mut self, text: &str) {
        self.text += text;
        self.text.push('\n');
    }

    /// The entry has no more details: says how many were left out.
    pub fn end_entry(&mut self) {
        let omitted = std::mem::take(&mut self.details).saturating_sub(DETAILS);
        let has_cut_detail = std::mem::take(&mut self.has_cut_detail);
        let Some(everything) = self.everything.clone() else { return };
        let note = match omitted {
            0 if !has_cut_detail => return,
            0 => everything,
            _ => format!("… and {}; {everything}", words::count(omitted as u64, "more line")),
        };
        let note = style::paint(style::DIM, &note);
        self.push(&format!("{:DETAIL$}{note}", ""));
    }

    /// A word to the right of the first column, a time in the second, a text.
    pub fn entry(&mut self, (style, word): (Style, &str), time: &str, text: &str) {
        let word = style::paint(style, &format!("{word:>11}"));
        self.line(&format!("{word}  {time:>10}  {text}"));
    }

    /// A word to the right of the first column, and a text after it.
    pub fn remark(&mut self, (style, word): (Style, &str), text: &str) {
        let word = style::paint(style, &format!("{word:>11}"));
        self.line(&format!("{word}  {text}"));
    }

    /// A line that belongs to the entry above.
    pub fn detail(&mut self, tone: Tone, text: &str) {
        self.details += 1;
        if self.everything.is_some() && self.details > DETAILS {
            return;
        }
        if text.is_empty() {
            return self.push("");
        }
        let text = match self.everything {
            Some(_) => words::shortened(text, CHARS),
            None => text.into(),
        };
        self.has_cut_detail |= matches!(text, Cow::Owned(_));
        let text = style::paint(style::of_tone(tone), &text);
        self.push(&format!("{:DETAIL$}{text}", ""));
    }

    /// A labelled fact of a list item at the end of the run.
    pub fn fact(&mut self, label: &str, text: &str) {
        let label = style::paint(style::DIM, &format!("{label:<6}"));
        self.line(&format!("    {label}  {text}"));
    }

    /// A labelled fact of an inner list item at the end of the run.
    pub fn inner_fact(&mut self, label: &str, text: &str) {
        let label = style::paint(style::DIM, &format!("{label:<6}"));
        self.line(&format!("      {label}  {text}"));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(page: &ConsoleLines) -> Vec<String> {
        let text = anstream::adapter::strip_str(&page.text).to_string();
        text.lines().map(str::to_owned).collect()
    }

    #[test]
    fn the_details_of_an_entry_are_limited() {
        let mut page = ConsoleLines::limited("`rtf show` shows all".to_owned());
        page.remark((style::BAD, "failed"), "arm");
        (0..1000).for_each(|_| page.detail(Tone::Bad, &"\u{e9}".repeat(1_200)));
        page.remark((style::BAD, "failed"), "leg");
        page.detail(Tone::Bad, &"x".repeat(401));
        page.end_entry();
        let lines = lines(&page);
        assert_eq!(lines.len(), 1 + DETAILS + 1 + 1 + 1 + 1);
        assert!(lines[1].ends_with("\u{e9} … (800 more characters)"), "{}", lines[1]);
        assert_eq!(lines[1 + DETAILS].trim(), "… and 800 more lines; `rtf show` shows all");
        assert_eq!(lines.last().map(|line| line.trim()), Some("`rtf show` shows all"));
    }

    #[test]
    fn a_verbose_console_shows_everything() {
        let mut page = ConsoleLines::default();
        (0..1000).for_each(|_| page.detail(Tone::Bad, &"x".repeat(1_200)));
        page.end_entry();
        let lines = lines(&page);
        assert_eq!((lines.len(), lines[999].len()), (1000, DETAIL + 1_200));
    }
}
