//! Reads the details of all attempts, starts and hook runs from a journal, in one pass.

use std::collections::HashMap;
use std::fs::File;
use std::io;

use rtf_model::{Event, EventKind, Record, Source, Verdict};
use rtf_report::journal::{EventHeader, parse_event};

use super::attachments::AttachmentFiles;
use super::chunks::Chunks;
use super::details::DetailsBuilder;
use crate::index::LineReader;
use crate::views::Cases;

/// The attempts that have started, and not yet finished.
pub struct Collector<'c, 'w> {
    record: &'c Record,
    files: AttachmentFiles,
    chunks: &'c mut Chunks<'w>,
    open: HashMap<Source, DetailsBuilder>,
    /// The number of the last attempt of each source, from 1.
    numbers: HashMap<Source, u32>,
}

impl<'c, 'w> Collector<'c, 'w> {
    /// Writes details to `chunks`.
    pub fn new(record: &'c Record, files: AttachmentFiles, chunks: &'c mut Chunks<'w>) -> Self {
        Self { record, files, chunks, open: HashMap::new(), numbers: HashMap::new() }
    }

    /// Reads a journal up to this offset.
    ///
    /// # Errors
    /// The journal or an attachment cannot be read, or a chunk cannot be written.
    pub fn read(mut self, journal: File, end: u64) -> io::Result<()> {
        let mut lines = LineReader::between(journal, 0, end)?;
        while let Some(line) = lines.next()? {
            // Damage is described in the overview.
            let Ok(header) = serde_json::from_slice::<EventHeader>(line.text) else { continue };
            if let Some(source) = header.detail_source().or_else(|| header.questioner()) {
                let Some(details) = self.open.get_mut(&source) else { continue };
                if let Ok(event) = parse_event(line.text) {
                    details.add(event, &mut self.files)?;
                }
            } else if let Ok(event) = parse_event(line.text) {
                self.take(&event)?;
            }
        }
        // In the order of a run, so that the same journal has the same report.
        let mut open: Vec<_> = self.open.keys().copied().collect();
        open.sort_by_key(|source| key(*source, 0));
        open.into_iter().try_for_each(|source| self.close(source))
    }

    /// Opens and closes attempts.
    fn take(&mut self, event: &Event) -> io::Result<()> {
        match &event.kind {
            EventKind::TestStarted { test, .. } => self.begin(Source::Test(*test)),
            EventKind::FixtureStarting { fixture, .. } => self.begin(Source::Fixture(*fixture)),
            EventKind::HookStarted { hook, .. } => self.begin(Source::Hook(*hook)),
            EventKind::TestFinished(finished) => self.close(Source::Test(finished.test)),
            EventKind::FixtureStopped { fixture, .. } => self.close(Source::Fixture(*fixture)),
            EventKind::HookFinished { hook, .. } => self.close(Source::Hook(*hook)),
            _ => Ok(()),
        }
    }

    fn begin(&mut self, source: Source) -> io::Result<()> {
        self.close(source)?;
        *self.numbers.entry(source).or_default() += 1;
        let has_passed = match source {
            Source::Test(id) => {
                let test = self.record.tests.get(id.index());
                test.is_some_and(|test| test.final_verdict() == Verdict::Passed)
            }
            Source::Fixture(_) | Source::Hook(_) => false,
        };
        self.open.insert(source, DetailsBuilder::new(has_passed));
        Ok(())
    }

    fn close(&mut self, source: Source) -> io::Result<()> {
        let Some(details) = self.open.remove(&source) else { return Ok(()) };
        let number = self.numbers.get(&source).copied().unwrap_or(1);
        let details = details.finish(self.cases(source, number));
        self.chunks.add(key(source, number), &details)
    }

    fn cases(&self, source: Source, number: u32) -> Option<Cases> {
        let Source::Test(id) = source else { return None };
        let attempt = usize::try_from(number).ok()?.checked_sub(1)?;
        let cases = &self.record.tests.get(id.index())?.attempts.get(attempt)?.cases;
        let cases = Cases::all(cases);
        (!cases.is_empty()).then_some(cases)
    }
}

fn key(source: Source, number: u32) -> String {
    match source {
        Source::Test(id) => format!("tests/{id}/{number}"),
        Source::Fixture(id) => format!("fixtures/{id}/{number}"),
        Source::Hook(id) => format!("hooks/{id}/{number}"),
    }
}
