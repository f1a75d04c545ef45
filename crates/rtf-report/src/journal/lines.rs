//! Reads a journal line by line and finds damage. All readers use it, whether they read a
//! complete journal or follow a growing one.

use super::event_line::parse_event;
use rtf_model::{
    Damage, EVENTS_VERSION, Event, EventCheck, EventKind, LineCheck, LineChecker, Record, RunState,
    StreamChecker,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the journal is of version {found}, this program reads up to version {EVENTS_VERSION}")]
pub struct NewerVersion {
    pub found: u32,
}

/// The state of reading a journal line by line.
#[derive(Debug, Default)]
pub struct JournalLines {
    lines: LineChecker,
    stream: StreamChecker,
    line: u64,
}

impl JournalLines {
    /// Reads the next line, without its line break. An event that counts is applied to
    /// the record, and damage is added there.
    ///
    /// # Errors
    /// The journal is of a newer version.
    pub fn read(
        &mut self,
        line: &[u8],
        record: &mut Record,
    ) -> Result<Option<Event>, NewerVersion> {
        self.line += 1;
        let check = self.lines.check(line);
        let is_trusted = matches!(check, LineCheck::Intact | LineCheck::Unchecked);
        let event = match parse_event(line) {
            Ok(event) => event,
            Err(error) => {
                self.stream.skip_line();
                let why = error.to_string();
                // Without the list of all kinds of events.
                let why = why.split_once(", expected one of").map_or(&*why, |(why, _)| why);
                self.damage(record, format!("this is not an event: {why}"));
                return Ok(None);
            }
        };
        if let EventKind::RunStarted(run) = &event.kind
            && is_trusted
            && run.version > EVENTS_VERSION
        {
            return Err(NewerVersion { found: run.version });
        }
        let EventCheck { is_new, problem } = self.stream.check(&event, is_trusted);
        if let Some(problem) = problem.or_else(|| wrong(check)) {
            self.damage(record, problem);
        }
        if is_new {
            record.apply(&event);
        }
        Ok(is_new.then_some(event))
    }

    /// Whether a line was read.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.line > 0
    }

    /// The expected number of the next event.
    #[must_use]
    pub fn next_seq(&self) -> u64 {
        self.stream.next()
    }

    /// Records that the file is shorter than what was read.
    pub fn record_truncated(&self, record: &mut Record) {
        self.damage_once(record, "the journal was longer than it is now");
    }

    /// Records an incomplete last line: a killed runner leaves one, but not after the end
    /// of the run.
    pub fn record_incomplete_line(&self, record: &mut Record) {
        if record.state != RunState::Running {
            self.damage_once(record, "something follows the end of the run");
        }
    }

    /// A reader that follows a journal finds the same damage each time.
    fn damage_once(&self, record: &mut Record, problem: &str) {
        let damage = Damage { line: self.line, problem: problem.to_owned() };
        if !record.damages.contains(&damage) {
            record.add_damage(damage);
        }
    }

    fn damage(&self, record: &mut Record, problem: String) {
        record.add_damage(Damage { line: self.line, problem });
    }
}

fn wrong(check: LineCheck) -> Option<String> {
    match check {
        LineCheck::Intact | LineCheck::Unchecked => None,
        LineCheck::Wrong => Some("its check value is wrong".to_owned()),
        LineCheck::Missing => Some("its check value is missing".to_owned()),
    }
}
