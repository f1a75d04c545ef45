//! Hands each event to each reporter, on a thread of its own.
//!
//! The run must not wait for a disk or a terminal, and reporters must not need
//! locks: one thread owns the record and all reporters, and a queue leads there.
//! Handing an event over never waits, so that a fixture's collapse is dealt with
//! even while somebody holds the terminal. Instead, [`FanoutHandle::is_congested`]
//! tells the run to stop reading from its processes for a while: a plug-in that
//! floods cannot fill the memory.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{self, Receiver, Sender, TryRecvError};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use rtf_model::{Event, OrderChecker, Record};

use crate::{ReportError, Reporter};

/// When this many events wait, the run should read no more from its processes.
const CONGESTED: usize = 4096;

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
    waiting: Arc<AtomicUsize>,
}

impl FanoutHandle {
    /// Hands over an event; never waits. When the thread is gone (a reporter
    /// panicked) the event is dropped: the run, its tear-down and its hooks go
    /// on, and [`Fanout::join`] tells.
    pub fn send(&self, event: Event) {
        self.waiting.fetch_add(1, Ordering::Relaxed);
        drop(self.sender.send(event));
    }

    /// Whether so many events wait that the run should read no more from its
    /// processes for a while.
    #[must_use]
    pub fn is_congested(&self) -> bool {
        self.waiting.load(Ordering::Relaxed) > CONGESTED
    }
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
        let (sender, receiver) = mpsc::channel();
        let waiting = Arc::new(AtomicUsize::new(0));
        let state = State::new(reporters, Arc::clone(&waiting));
        let thread = thread::Builder::new().name("reports".into()).spawn(|| state.run(receiver))?;
        Ok(Self { handle: FanoutHandle { sender, waiting }, thread })
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
    /// When a reporter panicked; in debug builds also when the order of events
    /// broke a rule of [`OrderChecker`].
    #[must_use]
    pub fn join(self) -> Finished {
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

struct State {
    record: Record,
    /// A reporter that failed is replaced by `None`.
    reporters: Vec<Option<Box<dyn Reporter>>>,
    errors: Vec<ReportError>,
    order: OrderChecker,
    disorder: Option<String>,
    waiting: Arc<AtomicUsize>,
}

impl State {
    fn new(reporters: Vec<Box<dyn Reporter>>, waiting: Arc<AtomicUsize>) -> Self {
        Self {
            waiting,
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
        let Self { record, errors, disorder, .. } = self;
        Outcome { finished: Finished { record, errors }, disorder }
    }

    fn report(&mut self, event: &Event) {
        self.waiting.fetch_sub(1, Ordering::Relaxed);
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
        for slot in &mut self.reporters {
            let Some(reporter) = slot else { continue };
            if let Err(error) = act(reporter.as_mut(), &self.record) {
                self.errors.push(error);
                *slot = None;
            }
        }
    }
}
