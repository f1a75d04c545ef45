//! Lines that wait to be written, in the console's columns.

use anstyle::Style;

use super::style;
use crate::explain::Tone;

/// The column in which details begin: below the names of tests.
const DETAIL: usize = 13;

/// Lines that wait to be written.
#[derive(Debug, Default)]
pub(super) struct ConsoleLines(String);

impl ConsoleLines {
    /// A line as it is.
    pub fn line(&mut self, text: &str) {
        self.0 += text;
        self.0.push('\n');
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
        if text.is_empty() {
            return self.line("");
        }
        let text = style::paint(style::of_tone(tone), text);
        self.line(&format!("{:DETAIL$}{text}", ""));
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

    /// How many bytes wait.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// What waits, as bytes.
    pub fn as_bytes(&self) -> &[u8] {
        self.0.as_bytes()
    }

    /// Nothing waits any more.
    pub fn clear(&mut self) {
        self.0.clear();
    }
}
