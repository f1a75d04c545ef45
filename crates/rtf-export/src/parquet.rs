//! Rows as an Apache Parquet file: typed columns, unknown values are null.
//!
//! A row group is kept in memory until it is written, so its size limits the memory.

use std::io::{self, Write};
use std::sync::Arc;

use jiff::Timestamp;
use parquet::basic::{Compression, LogicalType, Repetition, TimeUnit, Type as PhysicalType};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DataType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::WriterProperties;
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{Type, TypePtr};

use crate::VERSION;
use crate::rows::{Cell, CellType, Column, ExportRow, RowWriter};

/// When a row group is written.
#[derive(Clone, Copy, Debug)]
pub struct GroupSize {
    /// Number of rows.
    pub rows: usize,
    /// Bytes of text, without repetitions of the cell above.
    pub text: usize,
}

/// About 50 MB, rarely more.
pub const GROUP: GroupSize = GroupSize { rows: 1 << 16, text: 32 << 20 };

pub struct ParquetWriter<W: Write + Send> {
    file: SerializedFileWriter<W>,
    size: GroupSize,
    /// The current row group.
    columns: Vec<ColumnCells>,
    rows: usize,
    text: usize,
}

impl<W: Write + Send> ParquetWriter<W> {
    pub fn new<R: ExportRow>(out: W, size: GroupSize) -> io::Result<Self> {
        let value = |key: &str, value: String| KeyValue::new(key.to_owned(), value);
        let properties = WriterProperties::builder()
            .set_compression(Compression::SNAPPY)
            .set_key_value_metadata(Some(vec![
                value("rtf.version", VERSION.to_string()),
                value("rtf.table", R::TABLE.to_owned()),
            ]));
        let file = SerializedFileWriter::new(out, schema::<R>()?, Arc::new(properties.build()))?;
        let columns = R::COLUMNS.iter().map(|(_, kind, _)| ColumnCells::new(*kind)).collect();
        Ok(Self { file, size, columns, rows: 0, text: 0 })
    }

    fn write_group(&mut self) -> Result<(), ParquetError> {
        let mut group = self.file.next_row_group()?;
        for cells in &mut self.columns {
            let Some(mut column) = group.next_column()? else { break };
            cells.write(&mut column)?;
            column.close()?;
        }
        group.close()?;
        (self.rows, self.text) = (0, 0);
        Ok(())
    }
}

impl<W: Write + Send> RowWriter for ParquetWriter<W> {
    fn add(&mut self, row: &impl ExportRow) -> io::Result<()> {
        for (column, cell) in self.columns.iter_mut().zip(row.cells()) {
            self.text += column.add(cell);
        }
        self.rows += 1;
        if self.rows >= self.size.rows || self.text >= self.size.text {
            self.write_group()?;
        }
        Ok(())
    }

    fn finish(mut self) -> io::Result<()> {
        if self.rows > 0 {
            self.write_group()?;
        }
        self.file.finish()?;
        self.file.inner_mut().flush()
    }
}

/// The columns of a table, which may all be null.
fn schema<R: ExportRow>() -> Result<TypePtr, ParquetError> {
    let field = |(name, cell_type, _): &Column<R>| {
        let (physical, logical) = match cell_type {
            CellType::Text => (PhysicalType::BYTE_ARRAY, Some(LogicalType::String)),
            CellType::Integer => (PhysicalType::INT64, None),
            CellType::Number => (PhysicalType::DOUBLE, None),
            CellType::Flag => (PhysicalType::BOOLEAN, None),
            CellType::Time => {
                (PhysicalType::INT64, Some(LogicalType::timestamp(true, TimeUnit::MICROS)))
            }
        };
        Type::primitive_type_builder(name, physical)
            .with_repetition(Repetition::OPTIONAL)
            .with_logical_type(logical)
            .build()
            .map(Arc::new)
    };
    let fields = R::COLUMNS.iter().map(field).collect::<Result<_, _>>()?;
    Type::group_type_builder("row").with_fields(fields).build().map(Arc::new)
}

/// The cells of a column in a row group.
struct ColumnCells {
    values: Values,
    /// 0 for a null, 1 for a value.
    definition_levels: Vec<i16>,
}

enum Values {
    Text(Vec<ByteArray>),
    /// Of a time, the microseconds since 1970.
    Integer(Vec<i64>),
    Number(Vec<f64>),
    Flag(Vec<bool>),
}

impl ColumnCells {
    fn new(cell_type: CellType) -> Self {
        let values = match cell_type {
            CellType::Text => Values::Text(Vec::new()),
            CellType::Integer | CellType::Time => Values::Integer(Vec::new()),
            CellType::Number => Values::Number(Vec::new()),
            CellType::Flag => Values::Flag(Vec::new()),
        };
        Self { values, definition_levels: Vec::new() }
    }

    /// Adds a cell; returns the bytes that its text needs. A cell of another type is null.
    fn add(&mut self, cell: Cell<'_>) -> usize {
        let mut size = 0;
        let is_value = match (&mut self.values, cell) {
            (Values::Text(values), Cell::Text(Some(text))) => {
                // Cells that are equal to the one above share its bytes.
                let above = values.last().filter(|above| above.data() == text.as_bytes()).cloned();
                let value = above.unwrap_or_else(|| {
                    size = text.len();
                    ByteArray::from(text.into_owned().into_bytes())
                });
                push(values, Some(value))
            }
            (Values::Integer(values), Cell::Integer(number)) => {
                push(values, number.map(|number| i64::try_from(number).unwrap_or(i64::MAX)))
            }
            (Values::Number(values), Cell::Number(number)) => push(values, number),
            (Values::Flag(values), Cell::Flag(flag)) => push(values, flag),
            (Values::Integer(values), Cell::Time(time)) => {
                push(values, time.map(Timestamp::as_microsecond))
            }
            (Values::Integer(values), Cell::OffsetTime(time)) => {
                let time = time.and_then(|time| time.parse().ok());
                push(values, time.map(Timestamp::as_microsecond))
            }
            _ => false,
        };
        self.definition_levels.push(i16::from(is_value));
        size
    }

    /// Writes the cells, and removes them.
    fn write(&mut self, column: &mut SerializedColumnWriter<'_>) -> Result<(), ParquetError> {
        let levels = std::mem::take(&mut self.definition_levels);
        match &mut self.values {
            Values::Text(values) => write::<ByteArrayType>(column, values, &levels),
            Values::Integer(values) => write::<Int64Type>(column, values, &levels),
            Values::Number(values) => write::<DoubleType>(column, values, &levels),
            Values::Flag(values) => write::<BoolType>(column, values, &levels),
        }
    }
}

fn write<T: DataType>(
    column: &mut SerializedColumnWriter<'_>,
    values: &mut Vec<T::T>,
    levels: &[i16],
) -> Result<(), ParquetError> {
    column.typed::<T>().write_batch(values, Some(levels), None)?;
    values.clear();
    Ok(())
}

/// Adds a value; returns whether there is one.
fn push<T>(values: &mut Vec<T>, value: Option<T>) -> bool {
    let is_value = value.is_some();
    values.extend(value);
    is_value
}

#[cfg(test)]
mod tests {
    use std::fs::File;

    use parquet::file::reader::{FileReader, SerializedFileReader};
    use serde::Serialize;

    use super::*;

    #[derive(Serialize)]
    struct Row(Option<String>, u64);

    impl ExportRow for Row {
        const TABLE: &'static str = "rows";
        const COLUMNS: &'static [Column<Self>] = &[
            ("text", CellType::Text, |row| Cell::Text(row.0.as_deref().map(Into::into))),
            ("number", CellType::Integer, |row| Cell::Integer(Some(row.1))),
        ];
    }

    /// The number of rows in each group.
    fn groups(size: GroupSize, rows: &[Row]) -> Vec<i64> {
        let path = tempfile::NamedTempFile::new().unwrap();
        let mut writer = ParquetWriter::new::<Row>(path.reopen().unwrap(), size).unwrap();
        rows.iter().try_for_each(|row| writer.add(row)).unwrap();
        writer.finish().unwrap();
        let reader = SerializedFileReader::new(File::open(path.path()).unwrap()).unwrap();
        assert_eq!(reader.get_row_iter(None).unwrap().count(), rows.len());
        reader.metadata().row_groups().iter().map(|group| group.num_rows()).collect()
    }

    #[test]
    fn the_rows_and_the_text_of_a_group_are_limited() {
        let rows: Vec<Row> =
            (0..5).map(|number| Row(Some(format!("{number:010}")), number)).collect();
        let by_rows = GroupSize { rows: 2, text: usize::MAX };
        assert_eq!(groups(by_rows, &rows), [2, 2, 1]);
        let by_text = GroupSize { rows: usize::MAX, text: 30 };
        assert_eq!(groups(by_text, &rows), [3, 2]);
        assert_eq!(groups(by_rows, &[]), [0; 0]);
    }

    #[test]
    fn text_that_repeats_and_nulls_need_no_memory() {
        let rows: Vec<Row> = (0..6).map(|n| Row((n != 3).then(|| "same".to_owned()), n)).collect();
        assert_eq!(groups(GroupSize { rows: 100, text: 5 }, &rows), [6]);
    }
}
