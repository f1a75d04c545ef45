//! Rows as one JSON document.

use std::io::{self, Write};

use crate::VERSION;
use crate::rows::{ExportRow, RowWriter};

pub struct JsonWriter<W: Write> {
    out: W,
    is_empty: bool,
}

impl<W: Write> JsonWriter<W> {
    pub fn new(mut out: W) -> io::Result<Self> {
        write!(out, "{{\"version\":{VERSION},\"rows\":[")?;
        Ok(Self { out, is_empty: true })
    }
}

impl<W: Write> RowWriter for JsonWriter<W> {
    fn add(&mut self, row: &impl ExportRow) -> io::Result<()> {
        if !std::mem::take(&mut self.is_empty) {
            write!(self.out, ",")?;
        }
        Ok(serde_json::to_writer(&mut self.out, row)?)
    }

    fn finish(mut self) -> io::Result<()> {
        writeln!(self.out, "]}}")?;
        self.out.flush()
    }
}
