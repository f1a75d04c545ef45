//! Reads the CSV file of a matrix: the header row names the parameters, and each further
//! row is a combination of their values.

use std::collections::HashMap;
use std::path::Path;
use std::sync::Arc;

use csv::{ReaderBuilder, StringRecord, Trim};
use rtf_model::Diagnostic;

use crate::config::is_name;
use crate::suite::{SourceText, Span, invalid_value, read_source};

/// Names of parameters, and rows of their values.
#[derive(Debug)]
pub struct MatrixTable {
    pub names: Vec<String>,
    /// The combinations of their values, each as long as `names`.
    pub rows: Vec<Vec<String>>,
}

#[derive(Debug, Default)]
pub struct ReadTable {
    /// `None` if there are problems.
    pub table: Option<MatrixTable>,
    /// The problems; without a label if the file cannot be read.
    pub problems: Vec<Diagnostic>,
    /// The text, if problems refer to it.
    pub source: Option<Arc<SourceText>>,
}

/// Reads a file. Messages call it `name`, which is relative to `dir`.
pub fn read_table(dir: &Path, name: &str) -> ReadTable {
    let source = match read_source(&dir.join(name), name) {
        Ok(source) => source,
        Err(unreadable) => {
            let (problem, source) = (unreadable.problem, unreadable.source.map(Arc::new));
            return ReadTable { table: None, problems: vec![problem], source };
        }
    };
    let mut problems = Vec::new();
    let table = parse(&source, &mut problems).filter(|_| problems.is_empty());
    let source = (!problems.is_empty()).then(|| Arc::new(source));
    ReadTable { table, problems, source }
}

fn parse(source: &SourceText, problems: &mut Vec<Diagnostic>) -> Option<MatrixTable> {
    let mut reader = ReaderBuilder::new()
        .has_headers(false)
        // The lengths are checked here, with a position.
        .flexible(true)
        .trim(Trim::All)
        .from_reader(source.text().as_bytes());
    let mut table: Option<MatrixTable> = None;
    let mut first_rows: HashMap<Vec<String>, Span> = HashMap::new();
    for record in reader.records() {
        let record = match record {
            Ok(record) => record,
            Err(error) => {
                let message = format!("`{}` is not a CSV file: {error}", source.name());
                problems.push(Diagnostic::error("not-csv", message));
                return None;
            }
        };
        let span = span_of(source, &record);
        let mut report = |code: &str, message: String| {
            problems.push(source.error(code, span, message));
        };
        let cells: Vec<String> = record.iter().map(str::to_owned).collect();
        let Some(table) = &mut table else {
            if let Some(wrong) = cells.iter().find(|name| !is_name(name)) {
                let message = format!("`{wrong}` is not the name of a parameter");
                report("invalid-value", message);
            }
            let repeated = (1..cells.len()).find(|index| cells[..*index].contains(&cells[*index]));
            if let Some(index) = repeated {
                let message = format!("the header names the parameter `{}` twice", cells[index]);
                report("duplicate-name", message);
            }
            table = Some(MatrixTable { names: cells, rows: Vec::new() });
            continue;
        };
        if cells.len() != table.names.len() {
            let (found, expected) = (cells.len(), table.names.len());
            let plural = if found == 1 { "" } else { "s" };
            report("ragged-csv", format!("a row with {found} value{plural}, expected {expected}"));
        } else if let Some(message) = cells.iter().find_map(|value| invalid_value(value)) {
            report("invalid-value", message);
        } else if let Some(first) = first_rows.insert(cells.clone(), span) {
            let problem = source
                .error("invalid-value", span, "the same values occur in two rows")
                .label(source.label(first, "the first one"));
            problems.push(problem);
        }
        table.rows.push(cells);
    }
    if table.as_ref().is_none_or(|table| table.rows.is_empty()) {
        let message = format!("`{}` has no row of values below its header", source.name());
        problems.push(Diagnostic::error("empty-matrix", message));
    }
    table
}

/// Returns the position of a record, without the blank lines before it.
fn span_of(source: &SourceText, record: &StringRecord) -> Span {
    let start = record.position().map_or(0, |position| position.byte());
    let start = usize::try_from(start).unwrap_or(usize::MAX).min(source.text().len());
    let rest = &source.text()[start..];
    let start = start + (rest.len() - rest.trim_start().len());
    let line = source.text()[start..].lines().next().unwrap_or_default();
    Span::new(start..start + line.trim_end().len())
}
