//! The data of a report, in blocks that the page reads one by one: compressed, and in
//! Base64, whose alphabet contains no markup.

use std::collections::BTreeMap;
use std::io::{self, Write};

use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde::Serialize;

/// A chunk is written when it has at least this many bytes of JSON.
const CHUNK_BYTES: usize = 512 * 1024;

/// Collects values by keys, and writes them in chunks.
pub struct Chunks<'w> {
    out: &'w mut dyn Write,
    /// The JSON object of the next chunk, without its last brace.
    pending: Vec<u8>,
    places: BTreeMap<String, u32>,
    count: u32,
}

impl<'w> Chunks<'w> {
    pub fn new(out: &'w mut dyn Write) -> Self {
        Self { out, pending: Vec::new(), places: BTreeMap::new(), count: 0 }
    }

    /// Adds a value.
    ///
    /// # Errors
    /// A chunk cannot be written.
    pub fn add(&mut self, key: String, value: &impl Serialize) -> io::Result<()> {
        self.pending.push(if self.pending.is_empty() { b'{' } else { b',' });
        serde_json::to_writer(&mut self.pending, &key)?;
        self.pending.push(b':');
        serde_json::to_writer(&mut self.pending, value)?;
        self.places.insert(key, self.count);
        if self.pending.len() >= CHUNK_BYTES { self.flush() } else { Ok(()) }
    }

    /// Writes the last chunk. Returns the chunk of each key.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn finish(mut self) -> io::Result<(&'w mut dyn Write, BTreeMap<String, u32>)> {
        self.flush()?;
        Ok((self.out, self.places))
    }

    fn flush(&mut self) -> io::Result<()> {
        if self.pending.is_empty() {
            return Ok(());
        }
        self.pending.push(b'}');
        write_text(self.out, &self.count.to_string(), &self.pending)?;
        self.pending.clear();
        self.count += 1;
        Ok(())
    }
}

/// Writes a value as the block of this name.
///
/// # Errors
/// It cannot be written.
pub fn write_block(out: &mut dyn Write, name: &str, value: &impl Serialize) -> io::Result<()> {
    write_text(out, name, &serde_json::to_vec(value)?)
}

fn write_text(out: &mut dyn Write, name: &str, json: &[u8]) -> io::Result<()> {
    write!(out, "<script type=\"application/gzip\" id=\"rtf-{name}\">")?;
    let mut encoder =
        GzEncoder::new(EncoderWriter::new(&mut *out, &STANDARD), Compression::default());
    encoder.write_all(json)?;
    encoder.finish()?.finish()?;
    out.write_all(b"</script>\n")
}
