//! The YAML below a test point, in the small part of YAML that Perl's harness
//! reads as well: texts of one line have the quotes of JSON, which are YAML's
//! too, and longer ones are blocks; so nothing in them has a meaning.

use std::time::Duration;

use rtf_model::Verdict;

use crate::escape;

/// A block of diagnostics, begun with its first entry.
pub(super) struct Yaml<'a> {
    text: &'a mut String,
    indent: String,
    begun: bool,
}

impl<'a> Yaml<'a> {
    /// Diagnostics of a point that is written `indent` columns in.
    pub fn new(text: &'a mut String, indent: usize) -> Self {
        Self { text, indent: " ".repeat(indent + 2), begun: false }
    }

    fn line(&mut self, line: &str) {
        if !self.begun {
            self.begun = true;
            self.line("---");
        }
        *self.text += &self.indent;
        *self.text += line;
        self.text.push('\n');
    }

    pub fn number(&mut self, key: &str, value: f64) {
        self.line(&format!("{key}: {value}"));
    }

    /// `duration_ms: 1.5`.
    pub fn duration(&mut self, duration: Duration) {
        self.number("duration_ms", duration.as_micros() as f64 / 1000.0);
    }

    /// `key: "text"`; nothing when the text is empty.
    pub fn text(&mut self, key: &str, value: &str) {
        if !value.is_empty() {
            self.line(&format!("{key}: {}", quoted(value)));
        }
    }

    /// Why a point is not ok.
    pub fn problem(&mut self, verdict: Verdict, severity: &str, message: &str) {
        self.text("verdict", verdict.as_str());
        self.text("severity", severity);
        self.text("message", message);
    }

    /// A file and a line, as harnesses look for them.
    pub fn place(&mut self, file: &str, line: u32) {
        self.line("at:");
        self.line(&format!("  file: {}", quoted(file)));
        if line > 0 {
            self.line(&format!("  line: {line}"));
        }
    }

    /// A text of several lines; nothing when there are none.
    pub fn lines(&mut self, key: &str, lines: impl IntoIterator<Item = String>) {
        let lines: Vec<String> = lines.into_iter().collect();
        let Some(first) = lines.first() else { return };
        // YAML takes a block's indentation from its first line.
        if first.is_empty() || first.starts_with([' ', '\t']) {
            return self.text(key, &lines.join("\n"));
        }
        self.line(&format!("{key}: |"));
        for line in &lines {
            // An empty line keeps its indentation: Perl's harness would take
            // it for the end of the block.
            self.line(&format!("  {}", escape::line(line)));
        }
    }

    /// Ends the block, if there is one.
    pub fn end(mut self) {
        if self.begun {
            self.line("...");
        }
    }
}

fn quoted(text: &str) -> String {
    serde_json::Value::from(escape::block(text).as_ref()).to_string()
}
