//! Numbers, times and commands for display.

use std::borrow::Cow;
use std::time::Duration;

use rtf_model::{Attachment, AttemptRecord, CaseRecord, Record, TestRecord};

use crate::escape;

/// `1 test`, `2 tests`, `2 processes`.
#[must_use]
pub fn count(number: u64, noun: &str) -> String {
    format!("{number} {}", plural(number, noun))
}

/// The noun as it stands after the number.
pub(crate) fn plural(number: u64, noun: &str) -> Cow<'_, str> {
    match number {
        1 => Cow::Borrowed(noun),
        _ if noun.ends_with("ss") => Cow::Owned(format!("{noun}es")),
        _ => Cow::Owned(format!("{noun}s")),
    }
}

/// `p = 0.0020`, `p < 0.0001`.
#[must_use]
pub fn p_value(p: f64) -> String {
    if p < 0.0001 { "p < 0.0001".to_owned() } else { format!("p = {p:.4}") }
}

/// The path of an attachment, or that its file does not exist.
pub(crate) fn attachment_place(attachment: &Attachment) -> Cow<'_, str> {
    if attachment.omitted {
        "not kept by `rtf merge`".into()
    } else {
        escape::line(&attachment.path)
    }
}

/// `0.012 s`, `12.345 s`, `3 min 05 s`, `2 h 03 min`.
#[must_use]
pub fn time(duration: Duration) -> String {
    let secs = duration.as_secs();
    match secs {
        0..60 => format!("{:.3} s", duration.as_secs_f64()),
        60..3600 => format!("{} min {:02} s", secs / 60, secs % 60),
        _ => format!("{} h {:02} min", secs / 3600, secs % 3600 / 60),
    }
}

/// `512 B`, `1.02 MiB`.
pub(crate) fn bytes(number: f64) -> String {
    let units = ["B", "KiB", "MiB", "GiB", "TiB"];
    let power = if number >= 1.0 { (number.log2() / 10.0) as usize } else { 0 };
    let unit = units.get(power).copied().unwrap_or("PiB");
    format!("{} {unit}", significant(number / 1024_f64.powi(power as i32)))
}

/// A number with three digits, or all that stand before the point.
pub(crate) fn significant(number: f64) -> String {
    let before = if number >= 1.0 { number.log10() as usize + 1 } else { 1 };
    let text = format!("{number:.*}", 3_usize.saturating_sub(before));
    match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.').to_owned(),
        false => text,
    }
}

/// `, attempt 2, will be retried` of a case that its framework runs again.
pub(crate) fn case_attempt(case: &CaseRecord) -> String {
    let attempt = match case.start.earlier_attempts {
        0 => String::new(),
        earlier => format!(", attempt {}", earlier + 1),
    };
    let is_rerun = case.finished.as_ref().is_some_and(|(_, finished)| finished.rerun);
    if is_rerun { attempt + ", will be retried" } else { attempt }
}

/// `repetition 2 of 3`; without the total while it is unknown.
pub(crate) fn repetition(test: &TestRecord, attempt: &AttemptRecord) -> String {
    match test.repetitions() {
        Some(all) => format!("repetition {} of {all}", attempt.repetition),
        None => format!("repetition {}", attempt.repetition),
    }
}

/// What is damaged in the journal of a run: the first place, and how many more.
pub(crate) fn damage(record: &Record) -> Option<String> {
    let (first, more) = record.damages.split_first()?;
    let more = match more.len() {
        0 => String::new(),
        more => format!(", and {}", count(more as u64, "more place")),
    };
    Some(format!("the journal is damaged: {first}{more}"))
}

/// A word of a command, quoted for a POSIX shell where that is needed.
pub(crate) fn quoted(word: &str) -> Cow<'_, str> {
    let plain = |c: char| c.is_alphanumeric() || "-_./:=@%+,".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        Cow::Borrowed(word)
    } else {
        Cow::Owned(format!("'{}'", word.replace('\'', r"'\''")))
    }
}

/// A command line as it could be typed.
pub(crate) fn command(words: &[String]) -> String {
    words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(" ")
}

/// The first line of a text, made harmless, with a sign when there are more.
pub(crate) fn first_line(text: &str) -> String {
    let mut lines = text.lines();
    let first = escape::line(lines.next().unwrap_or_default()).into_owned();
    if lines.next().is_some() { first + " …" } else { first }
}

/// As [`first_line`], with at most 400 characters: for lists in which each reason is one line.
pub(crate) fn short_line(text: &str) -> String {
    shortened(&first_line(text), 400).into_owned()
}

/// The first `limit` characters of a text, and how many follow.
pub(crate) fn shortened(text: &str, limit: usize) -> Cow<'_, str> {
    match text.char_indices().nth(limit) {
        None => text.into(),
        Some((end, _)) => {
            let more = count(text[end..].chars().count() as u64, "more character");
            format!("{} … ({more})", &text[..end]).into()
        }
    }
}

/// The last `limit` lines of a text, and how many lines there are in all.
pub(crate) fn tail(text: &str, limit: usize) -> (impl Iterator<Item = &str>, usize) {
    let total = text.lines().count();
    (text.lines().skip(total.saturating_sub(limit)), total)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn amounts_have_three_digits() {
        let shown = [0.0, 7.0, 1023.0, 1024.0 * 1.5, 1024.0 * 1024.0 * 48.96].map(bytes);
        assert_eq!(shown, ["0 B", "7 B", "1023 B", "1.5 KiB", "49 MiB"]);
        let shown = [1.0, 0.1428, 38.96, 123_456.7].map(significant);
        assert_eq!(shown, ["1", "0.14", "39", "123457"]);
    }

    #[test]
    fn plurals_are_right() {
        assert_eq!(count(1, "process"), "1 process");
        assert_eq!(count(2, "process"), "2 processes");
        assert_eq!(count(0, "test"), "0 tests");
    }

    #[test]
    fn times_have_a_precision_that_fits_their_length() {
        assert_eq!(time(Duration::from_micros(12_345)), "0.012 s");
        assert_eq!(time(Duration::from_secs(185)), "3 min 05 s");
        assert_eq!(time(Duration::from_secs(7385)), "2 h 03 min");
    }

    #[test]
    fn words_are_quoted_only_when_needed() {
        let words = ["rtf", "run", "my suite.xml", "it's"].map(str::to_owned);
        assert_eq!(command(&words), r"rtf run 'my suite.xml' 'it'\''s'");
    }
}
