//! `[[quarantine]]`: known failures of all tests that match a filter.

use rtf_model::{Diagnostic, Label, Verdict};
use toml::de::{DeTable, DeValue};

use super::toml_value::{TomlReader, TomlValue, span};
use crate::select::{self, Filter};
use crate::suite::{DeclaredKnownFailure, SourceText, Span, Spanned, parse_day, parse_verdict};

pub(super) const QUARANTINE: &str = "quarantine";

pub(super) const KEYS: [&str; 5] = ["filter", "issue", "reason", "until", "verdicts"];

#[derive(Clone, Debug)]
pub struct Quarantine {
    /// The position of the filter.
    pub span: Span,
    pub filter: Filter,
    pub failure: DeclaredKnownFailure,
}

/// Reads all tables, and reports invalid ones.
pub(super) fn read(reader: &mut TomlReader<'_>, value: &TomlValue<'_>) -> Vec<Quarantine> {
    let tables = match value.get_ref() {
        DeValue::Array(tables) => tables.iter().collect(),
        _ => Vec::new(),
    };
    if tables.is_empty() {
        reader.wrong(QUARANTINE, value, "tables: `[[quarantine]]`");
    }
    let mut quarantines = Vec::new();
    for value in tables {
        match value.get_ref() {
            DeValue::Table(table) => quarantines.extend(read_table(reader, value, table)),
            _ => reader.wrong(QUARANTINE, value, "tables: `[[quarantine]]`"),
        }
    }
    quarantines
}

fn read_table(
    reader: &mut TomlReader<'_>,
    value: &TomlValue<'_>,
    table: &DeTable<'_>,
) -> Option<Quarantine> {
    let mut failure = DeclaredKnownFailure {
        verdicts: vec![Verdict::Failed],
        issue: None,
        reason: None,
        until: None,
    };
    let mut filter = None;
    let mut has_filter = false;
    for (key, value) in table {
        let name = key.get_ref().as_ref();
        let whole = format!("{QUARANTINE}.{name}");
        match (name, value.get_ref()) {
            ("filter", DeValue::String(text)) => {
                has_filter = true;
                filter = read_filter(reader, text, value).map(|filter| (filter, span(value)));
            }
            ("issue", DeValue::String(text)) => failure.issue = Some(text.to_string()),
            ("reason", DeValue::String(text)) => failure.reason = Some(text.to_string()),
            ("until", DeValue::String(_) | DeValue::Datetime(_)) => {
                let day = match value.get_ref() {
                    DeValue::String(text) => parse_day(text),
                    DeValue::Datetime(day) => parse_day(&day.to_string()),
                    _ => None,
                };
                match day {
                    Some(day) => failure.until = Some(Spanned::new(day, span(value))),
                    None => reader.wrong(&whole, value, "a date: `\"2027-01-31\"`"),
                }
            }
            ("verdicts", DeValue::Array(list)) if !list.is_empty() => {
                failure.verdicts =
                    list.iter().filter_map(|value| read_verdict(reader, value)).collect();
            }
            ("verdicts", _) => {
                reader.wrong(&whole, value, "a list of verdicts: `[\"failed\", \"error\"]`");
            }
            ("until", _) => reader.wrong(&whole, value, "a date: `\"2027-01-31\"`"),
            ("filter" | "issue" | "reason", _) => {
                has_filter |= name == "filter";
                reader.wrong(&whole, value, "a text");
            }
            _ => reader.unknown(key, &format!("{QUARANTINE}."), "", &KEYS),
        }
    }
    if !has_filter {
        let problem = reader
            .source
            .error("incomplete", span(value), "a `[[quarantine]]` needs a `filter`")
            .hint("for example `filter = \"name(=Grasp)\"`");
        reader.problems.push(problem);
    }
    let (filter, span) = filter?;
    Some(Quarantine { span, filter, failure })
}

fn read_verdict(reader: &mut TomlReader<'_>, value: &TomlValue<'_>) -> Option<Verdict> {
    let DeValue::String(text) = value.get_ref() else {
        reader.wrong("quarantine.verdicts", value, "a list of verdicts: `[\"failed\", \"error\"]`");
        return None;
    };
    match parse_verdict(text) {
        Ok(verdict) => Some(verdict),
        Err(problem) => {
            let label = reader.source.label(span(value), "");
            reader.problems.push(problem.label(label));
            None
        }
    }
}

fn read_filter(reader: &mut TomlReader<'_>, text: &str, value: &TomlValue<'_>) -> Option<Filter> {
    let whole = span(value);
    match select::parse(&SourceText::new(reader.source.name(), text)) {
        Ok(filter) if filter.has_cases() => {
            let problem = Diagnostic::error("filter", "cases cannot be quarantined")
                .label(reader.source.label(whole, "`case` selects cases"))
                .hint("quarantine their test");
            reader.problems.push(problem);
            None
        }
        Ok(filter) => Some(filter),
        Err(mut problem) => {
            for label in &mut problem.labels {
                *label = relocate(reader.source, whole, text, label);
            }
            reader.problems.push(*problem);
            None
        }
    }
}

/// Returns a label in a filter as a label in the file: at its exact position if the file
/// contains the filter without escapes, otherwise at the whole value.
fn relocate(source: &SourceText, whole: Span, text: &str, label: &Label) -> Label {
    let raw = source.text().get(whole.range()).unwrap_or_default();
    let offset = |part: u64| usize::try_from(part).unwrap_or_default();
    let span = match raw.find(text) {
        Some(start) => whole.part(start + offset(label.start)..start + offset(label.end)),
        None => whole,
    };
    source.label(span, label.text.clone())
}
