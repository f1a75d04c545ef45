//! The names of the signals that can stop a process.

/// Names without `SIG`, and numbers on this platform.
const SIGNALS: [(&str, i32); 7] = [
    ("HUP", 1),
    ("INT", 2),
    ("QUIT", 3),
    ("KILL", 9),
    ("TERM", 15),
    ("USR1", if cfg!(target_os = "linux") { 10 } else { 30 }),
    ("USR2", if cfg!(target_os = "linux") { 12 } else { 31 }),
];

/// Returns the names with `SIG`, for messages.
pub(super) fn names() -> impl Iterator<Item = String> {
    SIGNALS.iter().map(|(name, _)| format!("SIG{name}"))
}

/// Parses `SIGINT`, `INT` or `2`.
pub(super) fn number(text: &str) -> Option<i32> {
    if let Ok(number) = text.parse::<i32>() {
        return (1..=31).contains(&number).then_some(number);
    }
    let upper = text.to_ascii_uppercase();
    let name = upper.strip_prefix("SIG").unwrap_or(&upper);
    SIGNALS.iter().find(|(known, _)| *known == name).map(|(_, number)| *number)
}

#[cfg(test)]
mod tests {
    use super::number;

    #[test]
    fn with_and_without_prefix_or_as_a_number() {
        assert_eq!(number("SIGINT"), Some(2));
        assert_eq!(number("term"), Some(15));
        assert_eq!(number("9"), Some(9));
        assert_eq!(number("0"), None);
        assert_eq!(number("64"), None);
        assert_eq!(number("SIGNAL"), None);
    }
}
