//! Closes the journal of a run whose runner died.

use std::fs::{File, OpenOptions};
use std::io::{self, BufRead, BufReader, Write};
use std::path::Path;
use std::time::Instant;

use rtf_model::{Diagnostic, Event, EventKind, HookId, LineSealer, Micros, OrderChecker, SuiteId};

/// Something that is to be written, and when it was.
#[derive(Debug)]
pub struct Happened {
    /// When.
    pub at: Instant,
    /// What.
    pub kind: EventKind,
}

/// A run of a hook that came to its end under the runner, which may not have
/// lived long enough to write it.
#[derive(Debug)]
pub struct Ended {
    /// The hook.
    pub hook: HookId,
    /// Which of its runs, from 1.
    pub number: u64,
    /// Its `hook-started`.
    pub started: Happened,
    /// Its `hook-finished`.
    pub finished: Happened,
}

/// All that is to be written.
#[derive(Debug)]
pub struct Told {
    /// Unless they are there: the ends of hooks under the runner.
    pub ended: Vec<Ended>,
    /// What happened after the runner's death.
    pub happened: Vec<Happened>,
}

/// Cuts off a last line that is not whole and writes what happened since.
/// `start` is zero on the run's clock. A journal that is closed, or has no
/// event, stays as it is.
///
/// # Errors
/// The file cannot be read or written.
pub fn close(journal: &Path, start: Instant, told: Told) -> io::Result<()> {
    let file = OpenOptions::new().read(true).append(true).open(journal)?;
    let Some(mut closing) = Closing::read(&file, start)? else { return Ok(()) };
    for ended in told.ended {
        let written = closing.finished.iter().filter(|hook| **hook == ended.hook).count();
        if (written as u64) < ended.number {
            closing.add(ended.started.at, ended.started.kind);
            closing.offer(ended.finished.at, ended.finished.kind);
        }
    }
    for Happened { at, kind } in told.happened {
        closing.add(at, kind);
    }
    file.set_len(closing.whole)?;
    (&file).write_all(&closing.lines)?;
    file.sync_data()
}

struct Closing {
    /// The length of the file up to the end of its last whole line.
    whole: u64,
    next: u64,
    last_at: Micros,
    start: Instant,
    /// `None` when what is there breaks the order already, as damage does.
    order: Option<OrderChecker>,
    /// The suites of hooks, as planned.
    suites: Vec<(HookId, SuiteId)>,
    /// The hooks that came to an end, once for each time.
    finished: Vec<HookId>,
    lines: Vec<u8>,
    sealer: LineSealer,
}

impl Closing {
    /// `None` when there is nothing to close.
    fn read(file: &File, start: Instant) -> io::Result<Option<Self>> {
        let order = Some(OrderChecker::default());
        let mut closing = Self {
            whole: 0,
            next: 0,
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
            closing.whole += line.len() as u64;
            closing.sealer = LineSealer::after(&line);
            if let Ok(event) = serde_json::from_slice::<Event>(&line) {
                let over = EventKind::RunFinished { interrupted: None };
                if std::mem::discriminant(&event.kind) == std::mem::discriminant(&over) {
                    return Ok(None);
                }
                closing.pass(&event);
            }
            line.clear();
        }
        Ok((closing.next > 0).then_some(closing))
    }

    fn pass(&mut self, event: &Event) {
        self.next = event.seq.saturating_add(1);
        self.last_at = event.at;
        match &event.kind {
            EventKind::HookPlanned(plan) => self.suites.push((plan.hook, plan.suite)),
            EventKind::HookFinished { hook, .. } => self.finished.push(*hook),
            _ => {}
        }
        self.order.take_if(|order| order.check(event).is_err());
    }

    fn add(&mut self, at: Instant, kind: EventKind) {
        let hook = match &kind {
            EventKind::HookStarted { hook, .. } => Some(*hook),
            _ => None,
        };
        if self.offer(at, kind.clone()) {
            return;
        }
        match kind {
            // The runner died after it had told the guard, but not the journal:
            // its hook began (then this one is known), or its suite did.
            EventKind::HookStarted { .. } => {
                let suite = self.suites.iter().find(|(id, _)| Some(*id) == hook);
                if let Some((_, suite)) = suite.copied() {
                    self.offer(at, EventKind::SuiteStarted { suite });
                    self.offer(at, kind);
                }
            }
            EventKind::HookFinished { hook, problem } => {
                let end = problem.map_or("did its work".to_owned(), |why| format!("failed: {why}"));
                let text = format!("hook {hook} was run by the guard and {end}");
                let diagnostic = Diagnostic::warning("hook-of-the-guard", text);
                self.offer(at, EventKind::Warning { diagnostic });
            }
            _ => {}
        }
    }

    /// Writes an event, if it may stand here.
    fn offer(&mut self, at: Instant, kind: EventKind) -> bool {
        let at = Micros::from(at.saturating_duration_since(self.start)).max(self.last_at);
        let event = Event { seq: self.next, at, kind };
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
        self.next += 1;
        self.last_at = at;
        true
    }
}

#[cfg(test)]
mod tests;
