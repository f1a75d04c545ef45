//! Indented lines.

use std::io::{self, Write};

use rtf_model::Parameter;

use crate::escape;
use crate::explain::{self, Tone};

/// Lines that wait to be written.
#[derive(Debug, Default)]
pub(super) struct TextLines(String);

impl TextLines {
    /// A line that needs no escaping.
    pub fn at(&mut self, indent: usize, text: &str) {
        if !text.is_empty() {
            self.0.extend(std::iter::repeat_n(' ', indent));
        }
        self.0 += text;
        self.0.push('\n');
    }

    /// `label: value`, made harmless; nothing when there is no value.
    pub fn fact(&mut self, indent: usize, label: &str, value: &str) {
        if !value.is_empty() {
            let sink = &mut |_, line: &str| self.at(indent, line);
            explain::block(Tone::Plain, value, &format!("{label}: "), sink);
        }
    }

    /// The parameters of a test or case, on one line.
    pub fn parameters(&mut self, indent: usize, parameters: &[Parameter]) {
        let pair = |parameter: &Parameter| format!("{}={}", parameter.name, parameter.value);
        let pairs: Vec<_> = parameters.iter().map(pair).collect();
        self.fact(indent, "parameters", &pairs.join(", "));
    }

    /// Text of several lines, each behind a bar.
    pub fn quoted(&mut self, indent: usize, text: &str) {
        for line in text.lines() {
            self.at(indent, format!("| {}", escape::block(line)).trim_end());
        }
    }

    /// Writes the lines, and forgets them.
    pub fn write_to(&mut self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(self.0.as_bytes())?;
        self.0.clear();
        Ok(())
    }
}
