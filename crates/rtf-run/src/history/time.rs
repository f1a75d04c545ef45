//! Dates and times on the command line.

use jiff::civil::Date;
use jiff::{Span, Timestamp, Zoned};

use crate::error::Failure;

/// Parses a date (`2026-11-01`), a time (`2026-11-01T12:00:00Z`), or the time since then
/// (`30d`).
pub fn parse_since(text: &str) -> Result<Timestamp, Failure> {
    find_since(text).ok_or_else(|| {
        Failure::input(format!("`{text}` is neither a date nor a time span"))
            .hint("write `2026-11-01`, `30d` or `12h`")
    })
}

/// As [`parse_since`]; `None` if it is neither.
pub fn find_since(text: &str) -> Option<Timestamp> {
    let now = Zoned::now();
    if let Ok(time) = text.parse::<Timestamp>() {
        return Some(time);
    }
    let date =
        text.parse::<Date>().ok().and_then(|date| date.to_zoned(now.time_zone().clone()).ok());
    let before = || {
        let span = text.parse::<Span>().ok().filter(|span| span.is_positive())?;
        now.checked_sub(span).ok()
    };
    date.or_else(before).map(|time| time.timestamp())
}

/// The start of a run, in the local time zone: `2026-11-21 07:30`.
pub fn minute(time: Timestamp) -> String {
    Zoned::new(time, jiff::tz::TimeZone::system()).strftime("%Y-%m-%d %H:%M").to_string()
}
