//! The measurements of the deciding attempts, those outside their limits first.

use rtf_model::{AttemptRecord, CaseId, Measurement, Record, SignalSummary, format_rounded};

use super::inline::code;
use super::{heading, row};
use crate::words;

/// Maximum number of measurements in the table.
const ROWS: usize = 200;

struct MeasurementRow {
    subject: String,
    name: String,
    value: String,
    limits: String,
    is_outside: bool,
}

/// Shows the table, if anything was measured.
pub(super) fn show(page: &mut String, record: &Record) {
    let mut rows = Vec::new();
    for test in &record.tests {
        let Some(attempt) = test.decisive_attempt() else { continue };
        let name = record.full_name(test.plan.test);
        let measurements = attempt.measurements.iter();
        rows.extend(measurements.map(|value| of_measurement(&name, attempt, value)));
        rows.extend(attempt.series.iter().map(|series| of_signal(&name, series)));
    }
    if rows.is_empty() {
        return;
    }
    rows.sort_by_key(|row| !row.is_outside);
    heading(page, "Measurements");
    *page += "| test | measurement | value | limits | result |\n|---|---|---|---|---|\n";
    for shown in rows.iter().take(ROWS) {
        let result = if shown.is_outside { "❌ outside" } else { "ok" };
        let optional = |text: &str| if text.is_empty() { String::new() } else { code(text) };
        let (value, limits) = (code(&shown.value), optional(&shown.limits));
        let names = [code(&shown.subject), code(&shown.name)];
        row(page, &[&names[..], &[value, limits, result.to_owned()]].concat());
    }
    if let Some(rest) = rows.get(ROWS..).filter(|rest| !rest.is_empty()) {
        let outside = rest.iter().filter(|row| row.is_outside).count();
        let more = words::count(rest.len() as u64, "more measurement");
        *page += &format!("\n… and {more}, {outside} of them outside limits\n");
    }
}

fn of_measurement(test: &str, attempt: &AttemptRecord, value: &Measurement) -> MeasurementRow {
    let (shown, mut limits) = value.for_display();
    if value.learned {
        limits += " (learned)";
    }
    let is_outside = !value.is_within_limits();
    let subject = with_case(test, attempt, value.case);
    MeasurementRow { subject, name: value.name.clone(), value: shown, limits, is_outside }
}

fn with_case(test: &str, attempt: &AttemptRecord, case: Option<CaseId>) -> String {
    let case = case.and_then(|case| attempt.cases.get(case));
    case.map_or(test.to_owned(), |case| format!("{test}/{}", case.path))
}

fn of_signal(test: &str, series: &SignalSummary) -> MeasurementRow {
    let limits = match (series.low, series.high) {
        (Some(low), Some(high)) => format!("{} … {}", format_rounded(low), format_rounded(high)),
        (Some(low), None) => format!("≥ {}", format_rounded(low)),
        (None, Some(high)) => format!("≤ {}", format_rounded(high)),
        (None, None) => String::new(),
    };
    MeasurementRow {
        subject: test.to_owned(),
        name: series.name.clone(),
        value: series.summary(),
        limits,
        is_outside: series.outside > 0,
    }
}
