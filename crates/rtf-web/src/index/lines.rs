//! The whole lines of a part of a journal.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek, SeekFrom};

use rtf_model::{Source, TestId};

/// How much is read at once.
const BUFFER: usize = 64 * 1024;

/// Reads lines one by one. A last line without its end does not count.
#[derive(Debug)]
pub struct Lines {
    file: BufReader<File>,
    text: Vec<u8>,
    offset: u64,
    end: u64,
}

/// One line.
#[derive(Debug)]
pub struct Line<'a> {
    /// Without its end.
    pub text: &'a [u8],
    /// Where in the file it starts.
    pub start: u64,
    /// Where the next one starts.
    pub end: u64,
}

/// What tells whether an event is looked for, without reading the rest of it.
#[derive(Debug, serde::Deserialize)]
pub struct Head {
    /// The event's number.
    pub seq: u64,
    /// When it happened.
    pub at: u64,
    /// Its kind.
    #[serde(rename = "type")]
    pub kind: Box<str>,
    source: Option<Source>,
    test: Option<TestId>,
}

impl Head {
    /// Whether this is something that was reported or printed, and by whom.
    #[must_use]
    pub fn detail_of(&self) -> Option<Source> {
        match &*self.kind {
            // A fixture's report about a test is the test's.
            "message" => self.test.map(Source::Test).or(self.source),
            "output" | "stack-dumped" | "processes-leaked" => self.source,
            "measured" | "sampled" | "attached" => self.test.map(Source::Test),
            _ => None,
        }
    }
}

impl Lines {
    /// The lines that start at `start` (a line does) and before `end`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn between(mut file: File, start: u64, end: u64) -> io::Result<Self> {
        file.seek(SeekFrom::Start(start))?;
        let file = BufReader::with_capacity(BUFFER, file);
        Ok(Self { file, text: Vec::new(), offset: start, end })
    }

    /// The next line.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn next(&mut self) -> io::Result<Option<Line<'_>>> {
        if self.offset >= self.end {
            return Ok(None);
        }
        self.text.clear();
        self.file.read_until(b'\n', &mut self.text)?;
        let Some(text) = self.text.strip_suffix(b"\n") else { return Ok(None) };
        let start = self.offset;
        self.offset += self.text.len() as u64;
        Ok(Some(Line { text, start, end: self.offset }))
    }
}
