//! Suite files, and the durations in them.

use rtf_plan::suite::{parse, parse_duration};

use super::labels;

/// A suite file.
pub fn check(data: &[u8]) {
    labels::check(data, |source, problems| parse(source, problems).is_some());
}

/// A duration: what is accepted can be written as nanoseconds.
pub fn check_duration(data: &[u8]) {
    let Ok(text) = std::str::from_utf8(data) else { return };
    let Ok(duration) = parse_duration(text) else { return };
    assert!(!duration.is_zero() && duration.as_secs() <= 366 * 24 * 60 * 60);
    let exact = format!("{}ns", duration.as_nanos());
    assert_eq!(parse_duration(&exact), Ok(duration), "{exact}");
    // White space around it, and an explicit sign, change nothing.
    assert_eq!(parse_duration(&format!(" {text}\n")), Ok(duration));
}
