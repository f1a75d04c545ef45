//! Consecutive lines of a journal that are read a second time.

use std::io::{Seek, SeekFrom};
use std::path::Path;

use rtf_model::{Event, LineCheck, LineChecker};

use super::event_line::parse_event;
use super::reader::{JournalError, RawLine, next_line, open, unreadable};

/// The beginning of a line in a journal, and what its check value depends on.
#[derive(Clone, Debug, Default)]
pub struct LinePosition {
    offset: u64,
    checker: LineChecker,
}

impl LinePosition {
    /// Moves to the line after `line`, which has no line break.
    pub fn advance(&mut self, line: &[u8]) {
        self.checker.check(line);
        self.offset += line.len() as u64 + 1;
    }
}

/// Consecutive lines of a journal that was read without finding damage.
#[derive(Clone, Debug)]
pub struct Section {
    start: LinePosition,
    end: u64,
}

impl Section {
    /// An empty section that begins here.
    #[must_use]
    pub fn starting_at(start: LinePosition) -> Self {
        Self { end: start.offset, start }
    }

    /// Extends it up to the line that begins here.
    pub fn extend_to(&mut self, end: &LinePosition) {
        self.end = end.offset;
    }

    /// Reads its events from the journal, one line at a time.
    ///
    /// # Errors
    /// The file cannot be read, or it has changed; and the first error of `visit`.
    pub fn read(
        &self,
        path: &Path,
        mut visit: impl FnMut(Event) -> Result<(), JournalError>,
    ) -> Result<(), JournalError> {
        let failed = |source| unreadable(path, source);
        let mut journal = open(path).map_err(failed)?;
        journal.seek(SeekFrom::Start(self.start.offset)).map_err(failed)?;
        let (mut position, mut text) = (self.start.clone(), Vec::new());
        while position.offset < self.end {
            let line = next_line(&mut journal, &mut text).map_err(failed)?;
            let event = line.and_then(|line| position.read(&line));
            visit(event.ok_or_else(|| JournalError::Changed { path: path.to_owned() })?)?;
        }
        Ok(())
    }
}

impl LinePosition {
    /// The event of an undamaged line.
    fn read(&mut self, line: &RawLine<'_>) -> Option<Event> {
        let RawLine::Whole(line) = line else { return None };
        self.offset += line.len() as u64 + 1;
        let is_intact =
            matches!(self.checker.check(line), LineCheck::Intact | LineCheck::Unchecked);
        is_intact.then(|| parse_event(line).ok()).flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::read_events;

    fn lines(journal: &Path) -> Vec<(LinePosition, Event)> {
        let (mut position, mut lines) = (LinePosition::default(), Vec::new());
        read_events(journal, |line, event| {
            lines.push((position.clone(), event));
            position.advance(line);
        })
        .unwrap();
        lines
    }

    #[test]
    fn a_section_is_what_was_read_or_it_has_changed() {
        let stream = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/streams/verdicts.jsonl");
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("events.jsonl");
        let mut sealer = rtf_model::LineSealer::default();
        let mut text = Vec::new();
        for (_, event) in lines(Path::new(stream)) {
            let start = text.len();
            serde_json::to_writer(&mut text, &event).unwrap();
            sealer.seal(&mut text, start);
        }
        std::fs::write(&path, &text).unwrap();
        let lines = lines(&path);
        assert!(lines.len() > 6, "{} lines", lines.len());
        let mut section = Section::starting_at(lines[2].0.clone());
        section.extend_to(&lines[5].0);
        let read = || {
            let mut events = Vec::new();
            section.read(&path, |event| {
                events.push(event);
                Ok(())
            })?;
            Ok::<_, JournalError>(events)
        };
        let wanted: Vec<_> = lines[2..5].iter().map(|(_, event)| event.clone()).collect();
        assert_eq!(read().unwrap(), wanted);
        let place = usize::try_from(lines[3].0.offset).unwrap() + 7;
        let mut changed = text.clone();
        changed[place] = if changed[place] == b'1' { b'2' } else { b'1' };
        for other in [&changed[..], &text[..place], b""] {
            std::fs::write(&path, other).unwrap();
            assert!(matches!(read(), Err(JournalError::Changed { .. })));
        }
    }
}
