//! Rows as comma-separated values. An unknown value is an empty cell.

use std::io::{self, Write};

use crate::rows::{Cell, ExportRow, RowWriter};

pub struct CsvWriter<W: Write>(Box<csv::Writer<W>>);

impl<W: Write> CsvWriter<W> {
    pub fn new<R: ExportRow>(out: W) -> io::Result<Self> {
        let mut writer = Box::new(csv::Writer::from_writer(out));
        writer.write_record(R::COLUMNS.iter().map(|(name, ..)| name))?;
        Ok(Self(writer))
    }
}

impl<W: Write> RowWriter for CsvWriter<W> {
    fn add(&mut self, row: &impl ExportRow) -> io::Result<()> {
        Ok(self.0.write_record(row.cells().map(printed))?)
    }

    fn finish(mut self) -> io::Result<()> {
        self.0.flush()
    }
}

fn printed(cell: Cell<'_>) -> String {
    match cell {
        Cell::Text(text) => text.map(String::from),
        Cell::Integer(number) => number.map(|number| number.to_string()),
        Cell::Number(number) => number.map(|number| number.to_string()),
        Cell::Flag(flag) => flag.map(|flag| flag.to_string()),
        Cell::Time(time) => time.map(|time| time.to_string()),
        Cell::OffsetTime(time) => time.map(str::to_owned),
    }
    .unwrap_or_default()
}
