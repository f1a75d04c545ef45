//! Known failures: whether they still apply on the day of the run.

use jiff::civil::Date;
use rtf_model::{Diagnostic, ExpectedFailure};

use crate::suite::{DeclaredKnownFailure, SourceText};

/// The number of days before its last day from which a known failure is warned about.
const WARNING_DAYS: i32 = 14;

/// Returns the known failure of a test, as it applies on `today`.
pub(super) fn expect(failure: &DeclaredKnownFailure, today: Date) -> ExpectedFailure {
    let until = failure.until.as_ref().map(|until| until.value);
    ExpectedFailure {
        verdicts: failure.verdicts.clone(),
        issue: failure.issue.clone(),
        reason: failure.reason.clone(),
        until: until.map(|until| until.to_string()),
        quarantined: false,
        expired: until.is_some_and(|until| today > until),
    }
}

/// Warns about a known failure that has expired or expires soon.
pub(super) fn warn_of_end(
    failure: &DeclaredKnownFailure,
    today: Date,
    source: &SourceText,
) -> Option<Diagnostic> {
    let until = failure.until.as_ref()?;
    let days = today.until(until.value).ok()?.get_days();
    let message = match days {
        _ if today > until.value => {
            format!("this known failure expired after {}: the verdict counts", until.value)
        }
        0 => "this known failure expires after today".to_owned(),
        1 => "this known failure expires after tomorrow".to_owned(),
        days if days <= WARNING_DAYS => format!("this known failure expires in {days} days"),
        _ => return None,
    };
    let label = source.label(until.span, failure.issue.clone().unwrap_or_default());
    let warning = Diagnostic::warning("known-failure-expires", message).label(label);
    Some(warning.hint("fix the test, or choose a later `until`"))
}
