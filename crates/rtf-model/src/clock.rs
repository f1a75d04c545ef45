//! The file format of a clock that tests follow.

use std::time::Duration;

/// The time in a clock's file, since the clock's zero. `None` while
/// it is being written, and if it is no valid time.
#[must_use]
pub fn parse_clock(text: &str) -> Option<Duration> {
    let number = text.strip_suffix('\n')?.trim();
    Duration::try_from_secs_f64(number.parse().ok()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_number_is_no_time() {
        assert_eq!(parse_clock("12.5\n"), Some(Duration::from_millis(12_500)));
        assert_eq!(parse_clock("0\n"), Some(Duration::ZERO));
        for text in ["12.", "12.5", "", "\n", "-1\n", "nan\n", "inf\n", "soon\n", "1\n2\n"] {
            assert_eq!(parse_clock(text), None, "{text:?}");
        }
    }
}
