//! Hands each event to each reporter, on a thread of its own.
//!
//! The run must not wait for a disk, and reporters must not need locks: one thread owns
//! the record and all reporters, and a queue leads there. Handing an event over never
//! waits, so that a fixture's collapse is dealt with even while the disk does not answer.
//! Instead, [`FanoutHandle::backlog`] tells the run how much of one process waits, so that
//! it reads no more from a plug-in that floods, which cannot fill the memory. Standard
//! output has a thread of its own: see [`crate::background_writer`].
//!
//! A reporter that panics is given no further event; the others go on.

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

/// What happens sooner than this after reporters have written waits until then, so
/// that short tests are written together. It is how late a report can be by that.
const GATHERING: Duration = Duration::from_micros(250);

/// All reporters, and the thread that they live on.
#[derive(Debug)]
pub struct Fanout {
    handle: FanoutHandle,
    thread: JoinHandle<Outcome>,
}

/// The way to all reporters. Cheap to clone; events of one handle keep their order.
#[derive(Clone, Debug)]
pub struct FanoutHandle {
    sender: Sender<Event>,
    backlog: Arc<Backlog>,
}

impl FanoutHandle {
    /// Hands over an event; never waits. When the thread is gone (it panicked) the
    /// event is dropped: the run, its tear-down and its hooks go on, and
    /// [`Fanout::join`] tells.
    pub fn send(&self, event: Event) {
        self.backlog.add(&event);
        drop(self.sender.send(event));
    }

    /// About how many bytes of what a process told wait to be reported.
    #[must_use]
    pub fn backlog(&self, source: Source) -> usize {
        self.backlog.of(source)
    }
}

/// What is left when all events were reported.
#[derive(Debug)]
pub struct FanoutResult {
    /// The fold over all events.
    pub record: Record,
    /// Reports that could not be written, at most one of each reporter.
    pub errors: Vec<ReportError>,
}

#[derive(Debug)]
struct Outcome {
    finished: FanoutResult,
    /// The first event that came where it may not, where that is checked.
    disorder: Option<String>,
}

impl Fanout {
    /// Starts the thread.
    ///
    /// # Errors
    /// The system has no thread to give.
    pub fn start(reporters: Vec<Box<dyn Reporter>>) -> std::io::Result<Self> {
        let (sender, receiver) = mpsc::channel();
        let backlog = Arc::new(Backlog::default());
        let state = State::new(reporters, Arc::clone(&backlog));
        let thread = thread::Builder::new().name("reports".into()).spawn(|| state.run(receiver))?;
        Ok(Self { handle: FanoutHandle { sender, backlog }, thread })
    }

    /// Hands over an event, see [`FanoutHandle::send`].
    pub fn send(&self, event: Event) {
        self.handle.send(event);
    }

    /// A way to the reporters. All handles must be gone before [`Fanout::join`] returns.
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
        let outcome = self.thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        debug_assert!(outcome.disorder.is_none(), "{}", outcome.disorder.unwrap_or_default());
        outcome.finished
    }
}

/// Lets events come, unless nothing was `written` for a while. While this thread
/// does not wait for them, those who hand them over need not wake it for each.
fn gather(written: Instant) {
    if let Some(rest) = GATHERING.checked_sub(written.elapsed()) {
        // Ends early when there will be no more, see `Fanout::join`.
        thread::park_timeout(rest);
    }
}

/// What is told of a reporter that panicked; the panic itself was printed.
fn panicked() -> ReportError {
    let source = io::Error::other("the reporter panicked");
    ReportError::at("a report", Path::new("its place"))(source)
}

struct State {
    record: Record,
    /// A reporter that failed is replaced by `None`.
    reporters: Vec<Option<Box<dyn Reporter>>>,
    errors: Vec<ReportError>,
    order: OrderChecker,
    disorder: Option<String>,
    backlog: Arc<Backlog>,
}

impl Drop for State {
    /// Nothing waits for a thread that is gone.
    fn drop(&mut self) {
        self.backlog.close();
    }
}

impl State {
    fn new(reporters: Vec<Box<dyn Reporter>>, backlog: Arc<Backlog>) -> Self {
        Self {
            backlog,
            record: Record::default(),
            reporters: reporters.into_iter().map(Some).collect(),
            errors: Vec::new(),
            order: OrderChecker::default(),
            disorder: None,
        }
    }

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
        Outcome { finished: FanoutResult { record, errors }, disorder: self.disorder.take() }
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
