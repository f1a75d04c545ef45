//! Closes the journal of a run whose runner died.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;
use std::time::Instant;

use rtf_model::{Diagnostic, Event, EventKind, HookId, LineSealer, Micros, OrderChecker, SuiteId};

#[derive(Debug)]
pub struct TimedEvent {
    pub at: Instant,
    pub kind: EventKind,
}

/// A complete run of a hook under the runner, which may have died before it wrote the
/// events.
#[derive(Debug)]
pub struct FinishedHook {
    pub hook: HookId,
    /// The number of the run, from 1.
    pub number: u64,
    /// Its `hook-started`.
    pub started: TimedEvent,
    /// Its `hook-finished`.
    pub finished: TimedEvent,
}

/// The events that the runner could not write.
#[derive(Debug)]
pub struct MissingEvents {
    /// The last complete runs of hooks, which the journal may contain already.
    pub finished_hooks: Vec<FinishedHook>,
    /// The events after the runner's death.
    pub events: Vec<TimedEvent>,
}

/// Removes an incomplete last line and appends the missing events. `start` is zero on the
/// run's clock. A journal that is closed or empty remains unchanged.
///
/// # Errors
/// The file cannot be read or written.
pub fn close(journal: &Path, start: Instant, missing: MissingEvents) -> io::Result<()> {
    let file = OpenOptions::new().read(true).append(true).open(journal)?;
    let Some(mut journal) = OpenJournal::read(&file, start)? else { return Ok(()) };
    for run in missing.finished_hooks {
        let written = journal.finished.iter().filter(|hook| **hook == run.hook).count();
        if (written as u64) < run.number {
            journal.append(run.started.at, run.started.kind);
            journal.append_if_valid(run.finished.at, run.finished.kind);
        }
    }
    for TimedEvent { at, kind } in missing.events {
        journal.append(at, kind);
    }
    file.set_len(journal.complete_bytes)?;
    (&file).write_all(&journal.lines)?;
    file.sync_data()
}

struct OpenJournal {
    /// The length of the file up to the end of its last complete line.
    complete_bytes: u64,
    next_seq: u64,
    last_at: Micros,
    start: Instant,
    /// `None` if the existing events violate the order, as in a damaged journal.
    order: Option<OrderChecker>,
    suites: Vec<(HookId, SuiteId)>,
    /// Each finished run of a hook.
    finished: Vec<HookId>,
    lines: Vec<u8>,
    sealer: LineSealer,
}

impl OpenJournal {
    /// `None` if there is nothing to close.
    fn read(file: &File, start: Instant) -> io::Result<Option<Self>> {
        let order = Some(OrderChecker::default());
        let mut journal = Self {
            complete_bytes: 0,
            next_seq: 0,
            last_at: Micros::default(),
            start,
            order,
            suites: Vec::new(),
            finished: Vec::new(),
            lines: Vec::new(),
            sealer: LineSealer::default(),
        };
        let mut reader = BufReader::with_capacity(64 * 1024, file);
        let mut line = Vec::new();
        while reader.read_until(b'\n', &mut line)? > 0 && line.ends_with(b"\n") {
            journal.complete_bytes += line.len() as u64;
            journal.sealer = LineSealer::after(&line);
            if let Ok(event) = serde_json::from_slice::<Event>(&line) {
                if matches!(event.kind, EventKind::RunFinished { .. }) {
                    return Ok(None);
                }
                journal.read_event(&event);
            }
            line.clear();
        }
        Ok((journal.next_seq > 0).then_some(journal))
    }

    fn read_event(&mut self, event: &Event) {
        self.next_seq = event.seq.saturating_add(1);
        self.last_at = event.at;
        match &event.kind {
            EventKind::HookPlanned(plan) => self.suites.push((plan.hook, plan.suite)),
            EventKind::HookFinished { hook, .. } => self.finished.push(*hook),
            _ => {}
        }
        self.order.take_if(|order| order.check(event).is_err());
    }

    fn append(&mut self, at: Instant, kind: EventKind) {
        let hook = match &kind {
            EventKind::HookStarted { hook, .. } => Some(*hook),
            _ => None,
        };
        if self.append_if_valid(at, kind.clone()) {
            return;
        }
        match kind {
            // The runner died after it had notified the guard, but before it wrote the start
            // of the hook, which is known then, or of its suite.
            EventKind::HookStarted { .. } => {
                let suite = self.suites.iter().find(|(id, _)| Some(*id) == hook);
                if let Some((_, suite)) = suite.copied() {
                    self.append_if_valid(at, EventKind::SuiteStarted { suite });
                    self.append_if_valid(at, kind);
                }
            }
            EventKind::HookFinished { hook, problem } => {
                let end = problem.map_or("succeeded".to_owned(), |why| format!("failed: {why}"));
                let text = format!("hook {hook} was run by the guard and {end}");
                let diagnostic = Diagnostic::warning("hook-of-the-guard", text);
                self.append_if_valid(at, EventKind::Warning { diagnostic });
            }
            _ => {}
        }
    }

    /// Appends an event if the order of events permits it here.
    fn append_if_valid(&mut self, at: Instant, kind: EventKind) -> bool {
        let at = Micros::from(at.saturating_duration_since(self.start)).max(self.last_at);
        let event = Event { seq: self.next_seq, at, kind };
        if let Some(order) = &self.order {
            let mut order = order.clone();
            if order.check(&event).is_err() {
                return false;
            }
            self.order = Some(order);
        }
        let start = self.lines.len();
        if serde_json::to_writer(&mut self.lines, &event).is_err() {
            self.lines.truncate(start);
            return false;
        }
        self.sealer.seal(&mut self.lines, start);
        self.next_seq += 1;
        self.last_at = at;
        true
    }
}

#[cfg(test)]
mod tests;
