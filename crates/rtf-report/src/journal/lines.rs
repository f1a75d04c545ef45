//! Takes the lines of a journal one by one and finds what is damaged. The only
//! place that decides what counts, for those who read a journal at once and for
//! those who follow it.

use rtf_model::{
    Damage, EVENTS_VERSION, Event, EventCheck, EventKind, LineCheck, LineChecker, Record, RunState,
    StreamChecker,
};

/// A journal was written by a newer runner.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the journal is of version {found}, this program reads up to version {EVENTS_VERSION}")]
pub struct NewerVersion {
    /// Its version.
    pub found: u32,
}

/// What a journal's lines were found to be, so far.
#[derive(Debug, Default)]
pub struct JournalLines {
    lines: LineChecker,
    stream: StreamChecker,
    line: u64,
}

impl JournalLines {
    /// Takes the next line, without its end, and reads it with `parse`. An event
    /// that counts is applied to the record, and damage is added there.
    ///
    /// # Errors
    /// The journal is of a newer version.
    pub fn take(
        &mut self,
        line: &[u8],
        parse: impl FnOnce(&[u8]) -> serde_json::Result<Event>,
        record: &mut Record,
    ) -> Result<Option<Event>, NewerVersion> {
        self.line += 1;
        let check = self.lines.check(line);
        let is_trusted = matches!(check, LineCheck::Intact | LineCheck::Unchecked);
        let event = match parse(line) {
            Ok(event) => event,
            Err(error) => {
                self.stream.skip_line();
                let why = error.to_string();
                // Not all that it could have been.
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

    /// Whether there was a line.
    #[must_use]
    pub fn has_begun(&self) -> bool {
        self.line > 0
    }

    /// The number of the next event.
    #[must_use]
    pub fn next_seq(&self) -> u64 {
        self.stream.next()
    }

    /// What has been read is not in the file any more.
    pub fn shrunk(&self, record: &mut Record) {
        self.damage_once(record, "the journal was longer than it is now");
    }

    /// The journal ends in a line without its end: the runner was killed while it
    /// wrote, but not after it had written the end of the run.
    pub fn torn(&self, record: &mut Record) {
        if record.state != RunState::Running {
            self.damage_once(record, "something stands after the end of the run");
        }
    }

    /// Those who follow a journal find it each time.
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
