//! The positions of attempts, and of events by number, in a
//! journal.

use std::collections::HashMap;

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
    /// The attempts, starts or runs of each source.
    ranges: HashMap<Source, Vec<JournalRange>>,
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
        let ranges = self.ranges.entry(source).or_default();
        match ranges.last_mut() {
            _ if begins => ranges.push(JournalRange { start, end: None }),
            Some(range) => range.end = Some(end),
            None => {}
        }
    }

    /// The attempt, start or run of a source with this number, from 1.
    #[must_use]
    pub fn of(&self, source: Source, number: u32) -> Option<JournalRange> {
        let place = usize::try_from(number.checked_sub(1)?).ok()?;
        self.ranges.get(&source)?.get(place).copied()
    }

    /// A line's start at or before the event with this number.
    #[must_use]
    pub fn before(&self, seq: u64) -> u64 {
        self.last_mark(|(known, _)| *known <= seq)
    }

    /// A line's start near this offset, before it.
    #[must_use]
    pub fn at(&self, offset: u64) -> u64 {
        self.last_mark(|(_, start)| *start <= offset)
    }

    /// The start of the line of the last mark that meets a condition, which all marks before it
    /// meet.
    fn last_mark(&self, condition: impl FnMut(&(u64, u64)) -> bool) -> u64 {
        let after = self.marks.partition_point(condition);
        after.checked_sub(1).map_or(0, |index| self.marks[index].1)
    }
}
