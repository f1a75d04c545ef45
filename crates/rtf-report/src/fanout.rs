//! Hands each event to each reporter, on a thread of its own.
//!
//! The run must not wait for a disk or a terminal, and reporters must not need
//! locks: one thread owns the record and all reporters, and a bounded queue
//! leads there. Only when the queue is full does the run wait, so that a plug-in
//! that floods cannot fill the memory.

use std::sync::mpsc::{self, Receiver, SyncSender, TryRecvError};
use std::thread::{self, JoinHandle};

use rtf_model::{Event, OrderChecker, Record};

use crate::{ReportError, Reporter};

/// How many events may wait.
const QUEUE: usize = 4096;

/// The way to all reporters.
#[derive(Debug)]
pub struct Fanout {
    sender: SyncSender<Event>,
    thread: JoinHandle<Outcome>,
}

/// What is left when all events were reported.
#[derive(Debug)]
pub struct Finished {
    /// The fold over all events.
    pub record: Record,
    /// Reports that could not be written, at most one of each reporter.
    pub errors: Vec<ReportError>,
}

#[derive(Debug)]
struct Outcome {
    finished: Finished,
    /// The first event that came where it may not, where that is checked.
    disorder: Option<String>,
}

impl Fanout {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub fn start(reporters: Vec<Box<dyn Reporter>>) -> std::io::Result<Self> {
        let (sender, receiver) = mpsc::sync_channel(QUEUE);
        let state = State::new(reporters);
        let thread = thread::Builder::new().name("reports".into()).spawn(|| state.run(receiver))?;
        Ok(Self { sender, thread })
    }

    /// Hands over an event; waits while the queue is full. When the thread is
    /// gone (a reporter panicked) the event is dropped: the run, its tear-down
    /// and its hooks go on, and [`Fanout::join`] tells.
    pub fn send(&self, event: Event) {
        drop(self.sender.send(event));
    }

    /// Waits until every event is reported and every reporter has finished.
    ///
    /// # Panics
    /// When a reporter panicked; in debug builds also when the order of events
    /// broke a rule of [`OrderChecker`].
    #[must_use]
    pub fn join(self) -> Finished {
        drop(self.sender);
        let outcome = self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        debug_assert!(outcome.disorder.is_none(), "{}", outcome.disorder.unwrap_or_default());
        outcome.finished
    }
}

struct State {
    record: Record,
    /// A reporter that failed is replaced by `None`.
    reporters: Vec<Option<Box<dyn Reporter>>>,
    errors: Vec<ReportError>,
    order: OrderChecker,
    disorder: Option<String>,
}

impl State {
    fn new(reporters: Vec<Box<dyn Reporter>>) -> Self {
        Self {
            record: Record::default(),
            reporters: reporters.into_iter().map(Some).collect(),
            errors: Vec::new(),
            order: OrderChecker::default(),
            disorder: None,
        }
    }

    fn run(mut self, receiver: Receiver<Event>) -> Outcome {
        loop {
            let event = match receiver.try_recv() {
                Ok(event) => event,
                Err(TryRecvError::Disconnected) => break,
                Err(TryRecvError::Empty) => {
                    self.each(|reporter, record| reporter.idle(record));
                    match receiver.recv() {
                        Ok(event) => event,
                        Err(mpsc::RecvError) => break,
                    }
                }
            };
            self.check_order(&event);
            self.record.apply(&event);
            self.each(|reporter, record| reporter.event(&event, record));
        }
        self.each(|reporter, record| reporter.finish(record));
        let Self { record, errors, disorder, .. } = self;
        Outcome { finished: Finished { record, errors }, disorder }
    }

    fn check_order(&mut self, event: &Event) {
        if cfg!(debug_assertions) && self.disorder.is_none() {
            self.disorder = self.order.check(event).err().map(|error| error.to_string());
        }
    }

    fn each(&mut self, act: impl Fn(&mut dyn Reporter, &Record) -> Result<(), ReportError>) {
        for slot in &mut self.reporters {
            let Some(reporter) = slot else { continue };
            if let Err(error) = act(reporter.as_mut(), &self.record) {
                self.errors.push(error);
                *slot = None;
            }
        }
    }
}
