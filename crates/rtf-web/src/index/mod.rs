//! The index of a run in memory: the fold over its journal, without messages and output,
//! and the positions of these in the journal.
//!
//! [`Index::advance`] reads what was appended to the journal. Live and past runs are read
//! in the same way.

mod attachments;
mod lines;
mod positions;

use std::fs::{File, Metadata};
use std::io;
use std::path::Path;
use std::time::{Duration, SystemTime};

use rtf_model::{Record, RunState, TestRecord};
use rtf_report::console::ReplayCommand;
use rtf_report::journal::{self, JournalLines};

pub use attachments::{AttachmentIndex, AttachmentInfo};
pub use lines::LineReader;
pub use positions::Positions;

/// An append changes the modification time before the length. A change of the time alone
/// means that a journal with a live writer was rewritten only if it is older than this.
const APPENDING: Duration = Duration::from_secs(1);

/// The state of a run in the API.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, utoipa::ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum State {
    /// The runner is still running.
    Running,
    /// The run has finished.
    Finished,
    /// The run was interrupted.
    Interrupted,
    /// The runner died; its guard closed the journal.
    Died,
    /// The journal has no end, and no process writes it.
    Incomplete,
    /// Its journal is long and still being read; ask again.
    #[default]
    Unread,
}

impl State {
    /// Whether no event will follow.
    #[must_use]
    pub fn is_over(self) -> bool {
        !matches!(self, Self::Running | Self::Unread)
    }
}

/// The index of one run.
#[derive(Debug)]
pub struct Index {
    file: File,
    /// Without messages and output.
    pub record: Record,
    /// The positions of events in the journal.
    pub positions: Positions,
    lines: JournalLines,
    /// Names and media types of attachments.
    pub attached: AttachmentIndex,
    /// The number of bytes read: all complete lines.
    pub offset: u64,
    /// When the journal was last modified, once it has been read to its end.
    modified: Option<SystemTime>,
    /// Whether a run without an end is shown as one that continues.
    follows: bool,
}

impl Index {
    /// The index of a journal; nothing is read yet.
    #[must_use]
    pub fn new(file: File) -> Self {
        Self {
            file,
            record: Record::lean(),
            positions: Positions::default(),
            lines: JournalLines::default(),
            attached: AttachmentIndex::default(),
            offset: 0,
            modified: None,
            follows: true,
        }
    }

    /// The index of a journal as it is now: a run without an end is incomplete.
    #[must_use]
    pub fn ended(file: File) -> Self {
        Self { follows: false, ..Self::new(file) }
    }

    /// Whether the journal was modified, but did not grow: it was rewritten in place.
    fn is_rewritten(&self, journal: &Metadata) -> bool {
        let Ok(modified) = journal.modified() else { return false };
        let is_modified = self.modified.is_some_and(|known| known != modified);
        is_modified && journal.len() == self.offset && !self.is_append_pending(modified)
    }

    /// Whether the writer may be appending what changed the modification time.
    fn is_append_pending(&self, modified: SystemTime) -> bool {
        // A time in the future has no age.
        let age = modified.elapsed().unwrap_or_default();
        age < APPENDING && journal::is_written(&self.file)
    }

    /// Reads appended lines; reads the journal again if it was rewritten in place.
    ///
    /// # Errors
    /// The journal cannot be read, or is of a newer version.
    pub fn advance(&mut self) -> io::Result<()> {
        let journal = self.file.metadata()?;
        if self.is_rewritten(&journal) {
            *self = Self::new(self.file.try_clone()?);
        }
        let length = journal.len();
        if length < self.offset {
            self.lines.record_truncated(&mut self.record);
        }
        if length <= self.offset {
            return Ok(());
        }
        let mut lines = LineReader::between(self.file.try_clone()?, self.offset, u64::MAX)?;
        while let Some(line) = lines.next()? {
            let taken = self.lines.read(line.text, &mut self.record);
            let newer = |error| io::Error::new(io::ErrorKind::InvalidData, error);
            if let Some(event) = taken.map_err(newer)? {
                self.positions.take(&event, line.start, line.end);
                self.attached.take(&event, &self.record);
            }
            self.offset = line.end;
        }
        if self.offset < length {
            self.lines.record_incomplete_line(&mut self.record);
        }
        // A journal that has grown in the meantime is modified, and not rewritten.
        let journal = self.file.metadata()?;
        let is_at_end = journal.len() == self.offset;
        self.modified = journal.modified().ok().filter(|_| is_at_end);
        Ok(())
    }

    /// The state of the run.
    #[must_use]
    pub fn state(&self) -> State {
        match &self.record.state {
            RunState::Finished { interrupted: None } => State::Finished,
            RunState::Finished { interrupted: Some(_) } => State::Interrupted,
            RunState::Died { .. } => State::Died,
            RunState::Running if self.follows && journal::is_written(&self.file) => State::Running,
            RunState::Running => State::Incomplete,
        }
    }

    /// The command that replays the recording of a test that is not green; `dir` is the run's
    /// directory. The record has no attachments.
    pub(crate) fn replay_command(
        &self,
        replay: &ReplayCommand,
        test: &TestRecord,
        dir: &Path,
    ) -> Option<String> {
        let recording = self.attached.recording(test)?;
        let is_red = !self.record.is_test_green(test);
        is_red.then(|| replay(&self.record, test.plan.test, &dir.join(recording))).flatten()
    }

    /// The expected number of the next event.
    #[must_use]
    pub fn next_seq(&self) -> u64 {
        self.lines.next_seq()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtf_model::{Event, EventKind, Micros, Phase, TestId};
    use rtf_report::Reporter;
    use rtf_report::journal::Journal;
    use std::fs;
    use std::io::Write;
    use std::path::Path;

    /// A journal with one event, and its writer, which lives.
    fn written(path: &Path) -> Journal {
        let mut writer = Journal::create(path).unwrap();
        let kind = EventKind::TestPhase { test: TestId(0), phase: Phase::Run };
        let event = Event { seq: 0, at: Micros(0), kind };
        writer.event(&event, &Record::default()).unwrap();
        writer.idle(&Record::default()).unwrap();
        writer
    }

    /// Changes the journal without changing its length, at this time.
    fn rewrite(path: &Path, at: SystemTime) {
        let text = fs::read_to_string(path).unwrap().replace("\"at\":0", "\"at\":1");
        let mut file = fs::OpenOptions::new().write(true).open(path).unwrap();
        file.write_all(text.as_bytes()).unwrap();
        file.set_modified(at).unwrap();
    }

    /// A reader between both steps of an append read the whole journal again: seconds for
    /// a million events, while live pages waited.
    #[test]
    fn an_append_in_progress_is_not_a_rewrite() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("events.jsonl");
        let _writer = written(&path);
        let mut index = Index::new(File::open(&path).unwrap());
        index.advance().unwrap();
        let now = SystemTime::now();
        rewrite(&path, now + Duration::from_secs(60));
        index.advance().unwrap();
        assert_eq!(index.record.last_at, Micros(0), "the new time may be that of an append");
        rewrite(&path, now - Duration::from_secs(60));
        index.advance().unwrap();
        assert_eq!(index.record.last_at, Micros(1), "an append does not take a minute");
    }

    #[test]
    fn a_journal_without_a_writer_is_rewritten_at_any_time() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("events.jsonl");
        drop(written(&path));
        let mut index = Index::new(File::open(&path).unwrap());
        index.advance().unwrap();
        rewrite(&path, SystemTime::now() + Duration::from_secs(60));
        index.advance().unwrap();
        assert_eq!(index.record.last_at, Micros(1));
    }
}
