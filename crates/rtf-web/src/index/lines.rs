//! The complete lines of a range of a journal.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Seek, SeekFrom};

/// Buffer size in bytes.
const BUFFER: usize = 64 * 1024;

/// Reads lines one by one. An incomplete last line is ignored.
#[derive(Debug)]
pub struct LineReader {
    file: BufReader<File>,
    text: Vec<u8>,
    offset: u64,
    end: u64,
}

#[derive(Debug)]
pub struct IndexedLine<'a> {
    /// The text, without its line break.
    pub text: &'a [u8],
    /// The offset of its start.
    pub start: u64,
    /// The offset of the next line.
    pub end: u64,
}

impl LineReader {
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
    pub fn next(&mut self) -> io::Result<Option<IndexedLine<'_>>> {
        if self.offset >= self.end {
            return Ok(None);
        }
        self.text.clear();
        self.file.read_until(b'\n', &mut self.text)?;
        let Some(text) = self.text.strip_suffix(b"\n") else { return Ok(None) };
        let start = self.offset;
        self.offset += self.text.len() as u64;
        Ok(Some(IndexedLine { text, start, end: self.offset }))
    }
}
