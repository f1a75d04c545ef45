//! The positions of attempts, and of events by number, in a
//! journal.

use rtf_model::{Event, EventKind, Source};

/// The position of every n-th event is kept.
const EVERY: u64 = 256;

/// A part of a journal, in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JournalRange {
    /// The start of its first line.
    pub start: u64,
    /// The end of its last line, once that is written.
    pub end: Option<u64>,
}

/// The positions of a run's events in its journal.
#[derive(Debug, Default)]
pub struct Positions {
    tests: Vec<Vec<JournalRange>>,
    fixtures: Vec<Vec<JournalRange>>,
    hooks: Vec<Vec<JournalRange>>,
    /// Numbers of events and offsets of their lines, both ascending.
    marks: Vec<(u64, u64)>,
}

impl Positions {
    /// Adds an event with the start and end offsets of its line.
    pub(super) fn take(&mut self, event: &Event, start: u64, end: u64) {
        if self.marks.last().is_none_or(|(seq, _)| event.seq >= seq + EVERY) {
            self.marks.push((event.seq, start));
        }
        let (source, begins) = match &event.kind {
            EventKind::TestStarted { test, .. } => (Source::Test(*test), true),
            EventKind::TestFinished(finished) => (Source::Test(finished.test), false),
            EventKind::FixtureStarting { fixture, .. } => (Source::Fixture(*fixture), true),
            EventKind::FixtureStopped { fixture, .. } => (Source::Fixture(*fixture), false),
            EventKind::HookStarted { hook, .. } => (Source::Hook(*hook), true),
            EventKind::HookFinished { hook, .. } => (Source::Hook(*hook), false),
            _ => return,
        };
        let (list, index) = match source {
            Source::Test(id) => (&mut self.tests, id.index()),
            Source::Fixture(id) => (&mut self.fixtures, id.index()),
            Source::Hook(id) => (&mut self.hooks, id.index()),
        };
        if begins && list.len() <= index {
            // A damaged number must not allocate much memory.
            if index - list.len() > 1_000_000 {
                return;
            }
            list.resize_with(index + 1, Vec::new);
        }
        let Some(places) = list.get_mut(index) else { return };
        match places.last_mut() {
            _ if begins => places.push(JournalRange { start, end: None }),
            Some(place) => place.end = Some(end),
            None => {}
        }
    }

    /// The attempt, start or run of a source with this number, from 1.
    #[must_use]
    pub fn of(&self, source: Source, number: u32) -> Option<JournalRange> {
        let (list, index) = match source {
            Source::Test(id) => (&self.tests, id.index()),
            Source::Fixture(id) => (&self.fixtures, id.index()),
            Source::Hook(id) => (&self.hooks, id.index()),
        };
        let place = usize::try_from(number.checked_sub(1)?).ok()?;
        list.get(index)?.get(place).copied()
    }

    /// A line's start at or before the event with this number.
    #[must_use]
    pub fn before(&self, seq: u64) -> u64 {
        let after = self.marks.partition_point(|(known, _)| *known <= seq);
        after.checked_sub(1).and_then(|index| self.marks.get(index)).map_or(0, |(_, start)| *start)
    }

    /// A line's start near this offset, before it.
    #[must_use]
    pub fn at(&self, offset: u64) -> u64 {
        let after = self.marks.partition_point(|(_, start)| *start <= offset);
        after.checked_sub(1).and_then(|index| self.marks.get(index)).map_or(0, |(_, start)| *start)
    }
}
