//! The durations of suites and of `rtf.toml`.

use std::time::Duration;

use jiff::SignedDuration;

/// The maximum duration, 366 days: adding it to the current time never overflows.
pub(crate) const MAX_DURATION: Duration = Duration::from_secs(366 * 24 * 60 * 60);

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DurationError {
    #[error("not a duration like `250ms`, `90s`, `2min` or `1h 30m` (a bare number is seconds)")]
    Malformed,
    #[error("must be longer than zero")]
    NotPositive,
    #[error("longer than 366 days")]
    TooLong,
}

/// Parses `250ms`, `1.5s`, `2min`, `1h 30m`; a bare number is seconds.
///
/// # Errors
/// The text is not a duration, not above zero, or above 366 days.
pub fn parse_duration(text: &str) -> Result<Duration, DurationError> {
    let text = text.trim();
    let bare = text.strip_prefix(['-', '+']).unwrap_or(text);
    let is_number = !bare.is_empty() && bare.bytes().all(|b| b.is_ascii_digit() || b == b'.');
    let parsed = if is_number {
        // `SignedDuration` requires a digit before the point.
        let sign = &text[..text.len() - bare.len()];
        let zero = if bare.starts_with('.') { "0" } else { "" };
        format!("{sign}{zero}{bare}s").parse::<SignedDuration>()
    } else {
        text.parse::<SignedDuration>()
    };
    let signed = match parsed {
        Ok(signed) => signed,
        Err(_)
            if is_number && bare.parse::<f64>().is_ok_and(|n| n > MAX_DURATION.as_secs_f64()) =>
        {
            return Err(DurationError::TooLong);
        }
        Err(_) => return Err(DurationError::Malformed),
    };
    if !signed.is_positive() {
        return Err(DurationError::NotPositive);
    }
    Duration::try_from(signed).ok().filter(|d| *d <= MAX_DURATION).ok_or(DurationError::TooLong)
}

#[cfg(test)]
mod tests {
    use super::{DurationError, parse_duration};

    #[test]
    fn the_formats_of_the_specification() {
        let millis = |text| parse_duration(text).map(|duration| duration.as_millis());
        assert_eq!(millis("250ms"), Ok(250));
        assert_eq!(millis("1.5s"), Ok(1500));
        assert_eq!(millis("2min"), Ok(120_000));
        assert_eq!(millis("1h 30m"), Ok(5_400_000));
        assert_eq!(millis(" 90 "), Ok(90_000));
        assert_eq!(millis("0.25"), Ok(250));
        assert_eq!(millis(".5"), Ok(500));
    }

    #[test]
    fn invalid_durations() {
        for text in ["", "soon", "1x", "1.2.3", "5 s s", "."] {
            assert_eq!(parse_duration(text), Err(DurationError::Malformed), "{text}");
        }
        for text in ["0", "0s", "-3", "-2min", "1s ago"] {
            assert_eq!(parse_duration(text), Err(DurationError::NotPositive), "{text}");
        }
        for text in ["9000h", "99999999", "1000000000000000000000000"] {
            assert_eq!(parse_duration(text), Err(DurationError::TooLong), "{text}");
        }
    }
}
