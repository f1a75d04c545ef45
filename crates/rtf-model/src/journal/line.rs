//! The check value of each line of a journal: CRC-32C over all events so far, so that
//! a line that was changed, removed, added or moved is detected. Processors have
//! an instruction for it, so that it is cheap even for short lines.
//!
//! The value is the last field of the line's object: `…,"crc":"1a2b3c4d"}`.

/// The bytes before a check value.
const FIELD: &[u8] = b",\"crc\":\"";
/// The bytes after it.
const CLOSE: &[u8] = b"\"}";
/// Number of hexadecimal digits.
const DIGITS: usize = 8;
const HEX: &[u8; 16] = b"0123456789abcdef";

/// Adds check values to the lines of a journal.
#[derive(Clone, Debug, Default)]
pub struct LineSealer {
    previous: u32,
}

impl LineSealer {
    /// Continues after this line of a journal, with or without its line break.
    #[must_use]
    pub fn after(line: &[u8]) -> Self {
        let line = line.strip_suffix(b"\n").unwrap_or(line);
        Self { previous: split(line).map_or(0, |(_, stored)| stored) }
    }

    /// The bytes that replace the last byte of `object`, a JSON object with
    /// at least one field: the check value and the line break.
    pub fn line_end(&mut self, object: &[u8]) -> [u8; Self::END] {
        debug_assert!(object.starts_with(b"{") && object.ends_with(b"}"));
        self.previous = check_value(self.previous, object.strip_suffix(b"}").unwrap_or(object));
        let mut end = *b",\"crc\":\"........\"}\n";
        for (place, byte) in self.previous.to_be_bytes().into_iter().enumerate() {
            end[FIELD.len() + 2 * place] = HEX[usize::from(byte >> 4)];
            end[FIELD.len() + 2 * place + 1] = HEX[usize::from(byte & 0xF)];
        }
        end
    }

    /// The length of [`LineSealer::line_end`] in bytes.
    pub const END: usize = FIELD.len() + DIGITS + CLOSE.len() + 1;

    /// Completes the last line of `page`, which starts at `start`.
    pub fn seal(&mut self, page: &mut Vec<u8>, start: usize) {
        let end = self.line_end(page.get(start..).unwrap_or_default());
        page.pop();
        page.extend_from_slice(&end);
    }
}

/// The result of checking a line's check value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LineCheck {
    /// The line is unchanged and follows the previous one.
    Intact,
    /// The line or the previous one was changed, or lines between them are missing.
    Wrong,
    /// The line has no check value, while others have one.
    Missing,
    /// The journal has no check values: an earlier runner wrote it.
    Unchecked,
}

/// Compares the check values of a journal's lines, from the first line on.
#[derive(Clone, Debug)]
pub struct LineChecker {
    /// Whether lines have check values; unknown before the first line.
    checked: Option<bool>,
    /// The values from which the next line may continue: the stored and the computed
    /// value of the last line. `None`: any value is accepted.
    previous: Option<[u32; 2]>,
}

impl Default for LineChecker {
    fn default() -> Self {
        Self { checked: None, previous: Some([0; 2]) }
    }
}

impl LineChecker {
    /// Checks the next line, without its line break.
    pub fn check(&mut self, line: &[u8]) -> LineCheck {
        let Some((body, stored)) = split(line) else {
            if *self.checked.get_or_insert(false) {
                self.previous = None;
                return LineCheck::Missing;
            }
            return LineCheck::Unchecked;
        };
        // The lines before this one have lost their check values.
        let is_first_checked = self.checked.replace(true) == Some(false);
        let computed = match self.previous {
            Some([stored_before, computed_before]) => {
                let computed = check_value(computed_before, body);
                if computed == stored { computed } else { check_value(stored_before, body) }
            }
            None => stored,
        };
        self.previous = Some([stored, computed]);
        match computed == stored && !is_first_checked {
            true => LineCheck::Intact,
            false => LineCheck::Wrong,
        }
    }
}

fn check_value(previous: u32, body: &[u8]) -> u32 {
    crc32c::crc32c_append(previous, body)
}

/// A line's bytes before its check value, and the value.
fn split(line: &[u8]) -> Option<(&[u8], u32)> {
    let rest = line.strip_suffix(CLOSE)?;
    let (rest, digits) = rest.split_at_checked(rest.len().checked_sub(DIGITS)?)?;
    let body = rest.strip_suffix(FIELD)?;
    let value = digits.iter().try_fold(0, |value: u32, digit| {
        let digit = match digit {
            b'0'..=b'9' => digit - b'0',
            b'a'..=b'f' => digit - b'a' + 10,
            _ => return None,
        };
        Some(value << 4 | u32::from(digit))
    })?;
    Some((body, value))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sealed(lines: &[&str]) -> Vec<String> {
        let (mut sealer, mut page) = (LineSealer::default(), Vec::new());
        for line in lines {
            let start = page.len();
            page.extend_from_slice(line.as_bytes());
            sealer.seal(&mut page, start);
        }
        String::from_utf8(page).unwrap().lines().map(str::to_owned).collect()
    }

    fn checks(lines: &[impl AsRef<str>]) -> Vec<LineCheck> {
        let mut checker = LineChecker::default();
        lines.iter().map(|line| checker.check(line.as_ref().as_bytes())).collect()
    }

    const LINES: [&str; 4] = [r#"{"a":1}"#, r#"{"a":2}"#, r#"{"a":3}"#, r#"{"a":4}"#];

    #[test]
    fn a_check_value_is_the_last_field_and_continues_the_one_before() {
        let lines = sealed(&LINES);
        // CRC-32C (iSCSI, ext4) of `{"a":1` and of `{"a":1{"a":2`.
        assert_eq!(lines[0], r#"{"a":1,"crc":"149cdbb2"}"#);
        assert_eq!(lines[1], r#"{"a":2,"crc":"06eb8f23"}"#);
        assert_eq!(checks(&lines), [LineCheck::Intact; 4]);
        let mut page = LINES[2].as_bytes().to_vec();
        LineSealer::after(format!("{}\n", lines[1]).as_bytes()).seal(&mut page, 0);
        assert_eq!(String::from_utf8(page).unwrap(), format!("{}\n", lines[2]));
    }

    #[test]
    fn one_fault_is_one_wrong_line() {
        use LineCheck::{Intact, Missing, Wrong};
        let lines = sealed(&LINES);
        let with = |line: usize, text: String| {
            let mut lines = lines.clone();
            lines[line] = text;
            checks(&lines)
        };
        assert_eq!(with(1, lines[1].replace(":2", ":7")), [Intact, Wrong, Intact, Intact]);
        assert_eq!(with(1, lines[1].replace("\"0", "\"1")), [Intact, Wrong, Intact, Intact]);
        assert_eq!(with(1, lines[1].replace("crc", "arc")), [Intact, Missing, Intact, Intact]);
        assert_eq!(with(0, lines[0].replace(":1", ":7")), [Wrong, Intact, Intact, Intact]);
        let removed = [&lines[0], &lines[2], &lines[3]];
        assert_eq!(checks(&removed), [Intact, Wrong, Intact]);
        let twice = [&lines[0], &lines[1], &lines[1], &lines[2]];
        assert_eq!(checks(&twice), [Intact, Intact, Wrong, Intact]);
        let swapped = [&lines[0], &lines[2], &lines[1], &lines[3]];
        assert!(checks(&swapped).contains(&Wrong));
        assert_eq!(checks(&lines[1..])[0], Wrong, "the first line is missing");
    }

    #[test]
    fn lines_without_check_values_do_not_mix_with_others() {
        use LineCheck::{Intact, Unchecked, Wrong};
        assert_eq!(checks(&LINES), [Unchecked; 4]);
        let mut lines = sealed(&LINES);
        lines[0] = LINES[0].to_owned();
        assert_eq!(checks(&lines), [Unchecked, Wrong, Intact, Intact]);
    }
}
