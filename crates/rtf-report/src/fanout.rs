//! Passes each event to each reporter, in a separate thread.
//!
//! The run must not wait for a disk, and reporters must not need locks: one thread owns
//! the record and all reporters, and a queue leads there. Handing an event over never
//! waits, so that a fixture's collapse is dealt with even while the disk does not answer.
//! Instead, [`FanoutHandle::backlog`] returns how much output of one process waits, so that
//! it reads no more from a plug-in that floods, which cannot fill the memory. Standard
//! output has another thread: see [`crate::background_writer`].
//!
//! A reporter that panics receives no further events; the others continue.

use std::io;
use std::mem::take;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rtf_model::{Event, OrderChecker, Record, Source};

use crate::backlog::Backlog;
use crate::{ReportError, Reporter};

/// Events within this time after the last write are collected, so that the events of
/// short tests are written together. Reports are delayed by up to this time.
const GATHERING: Duration = Duration::from_micros(250);

/// All reporters, and their thread.
#[derive(Debug)]
pub struct Fanout {
    handle: FanoutHandle,
    thread: JoinHandle<Outcome>,
}

/// Sends events to all reporters. Cheap to clone; events of one handle keep their order.
#[derive(Clone, Debug)]
pub struct FanoutHandle {
    sender: Sender<Event>,
    backlog: Arc<Backlog>,
}

impl FanoutHandle {
    /// Hands over an event; never waits. When the thread is gone (it panicked) the
    /// event is dropped: the run, its tear-down and its hooks continue, and
    /// [`Fanout::join`] reports it.
    pub fn send(&self, event: Event) {
        self.backlog.add(&event);
        drop(self.sender.send(event));
    }

    /// Approximate number of bytes of a process that wait to be reported.
    #[must_use]
    pub fn backlog(&self, source: Source) -> usize {
        self.backlog.of(source)
    }
}

/// The result after all events were reported.
#[derive(Debug)]
pub struct FanoutResult {
    /// The fold over all events.
    pub record: Record,
    /// Reports that could not be written, at most one per reporter.
    pub errors: Vec<ReportError>,
}

/// The result, and the first violation of the order of events, if the order is checked.
type Outcome = (FanoutResult, Option<String>);

impl Fanout {
    /// Starts the thread.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn start(reporters: Vec<Box<dyn Reporter>>) -> std::io::Result<Self> {
        let (sender, receiver) = mpsc::channel();
        let backlog = Arc::new(Backlog::default());
        let state = FanoutState {
            record: Record::default(),
            reporters: reporters.into_iter().map(Some).collect(),
            errors: Vec::new(),
            order: OrderChecker::default(),
            disorder: None,
            backlog: Arc::clone(&backlog),
        };
        let thread = thread::Builder::new().name("reports".into()).spawn(|| state.run(receiver))?;
        Ok(Self { handle: FanoutHandle { sender, backlog }, thread })
    }

    /// Sends an event, see [`FanoutHandle::send`].
    pub fn send(&self, event: Event) {
        self.handle.send(event);
    }

    /// A handle for sending events. [`Fanout::join`] waits until all handles are dropped.
    #[must_use]
    pub fn handle(&self) -> FanoutHandle {
        self.handle.clone()
    }

    /// Waits until every event is reported and every reporter has finished.
    ///
    /// # Panics
    /// When the thread panicked; in debug builds also when the order of events
    /// broke a rule of [`OrderChecker`].
    #[must_use]
    pub fn join(self) -> FanoutResult {
        drop(self.handle);
        self.thread.thread().unpark();
        let outcome = self.thread.join();
        let (result, disorder) = outcome.unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        debug_assert!(disorder.is_none(), "{}", disorder.unwrap_or_default());
        result
    }
}

/// Waits for more events, unless the last write was a while ago. While this thread
/// does not wait for an event, senders need not wake it for each one.
fn gather(written: Instant) {
    if let Some(rest) = GATHERING.checked_sub(written.elapsed()) {
        // Ends early when there will be no more, see `Fanout::join`.
        thread::park_timeout(rest);
    }
}

/// The error for a reporter that panicked; the panic itself was printed.
fn panicked() -> ReportError {
    let source = io::Error::other("the reporter panicked");
    ReportError::at("a report", Path::new("its place"))(source)
}

struct FanoutState {
    record: Record,
    /// A reporter that failed is replaced by `None`.
    reporters: Vec<Option<Box<dyn Reporter>>>,
    errors: Vec<ReportError>,
    order: OrderChecker,
    disorder: Option<String>,
    backlog: Arc<Backlog>,
}

impl Drop for FanoutState {
    /// No process waits for a thread that has ended.
    fn drop(&mut self) {
        self.backlog.close();
    }
}

impl FanoutState {
    fn run(mut self, receiver: Receiver<Event>) -> Outcome {
        loop {
            match receiver.try_recv() {
                Ok(event) => self.report(&event),
                Err(TryRecvError::Disconnected) => break,
                Err(TryRecvError::Empty) => {
                    self.each(|reporter, record| reporter.idle(record));
                    let written = Instant::now();
                    match receiver.recv() {
                        Ok(event) => self.report(&event),
                        Err(mpsc::RecvError) => break,
                    }
                    gather(written);
                }
            }
        }
        self.each(|reporter, record| reporter.finish(record));
        let (record, errors) = (take(&mut self.record), take(&mut self.errors));
        (FanoutResult { record, errors }, self.disorder.take())
    }

    fn report(&mut self, event: &Event) {
        self.backlog.remove(event);
        self.check_order(event);
        self.record.apply(event);
        self.each(|reporter, record| reporter.event(event, record));
    }

    fn check_order(&mut self, event: &Event) {
        if cfg!(debug_assertions) && self.disorder.is_none() {
            self.disorder = self.order.check(event).err().map(|error| error.to_string());
        }
    }

    fn each(&mut self, act: impl Fn(&mut dyn Reporter, &Record) -> Result<(), ReportError>) {
        for index in 0..self.reporters.len() {
            let Some(reporter) = &mut self.reporters[index] else { continue };
            // A reporter that panicked is dropped and never used again.
            let acted = catch_unwind(AssertUnwindSafe(|| act(reporter.as_mut(), &self.record)));
            if let Err(error) = acted.unwrap_or_else(|_| Err(panicked())) {
                self.reporters[index] = None;
                let others = self.reporters.iter_mut().flatten();
                others.for_each(|reporter| reporter.reporter_failed(&error));
                self.errors.push(error);
            }
        }
    }
}
