//! Writes standard output in a background thread.
//!
//! A slow reader (a pager, a terminal after Ctrl-S, a slow connection) must not delay the
//! run or its journal. Pending output is kept
//! in memory; reporters omit detail when [`BackgroundWriter::is_full`].

use std::io::{self, Write};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use anstream::adapter::StripBytes;
use anstream::{AutoStream, ColorChoice};

use crate::is_disconnect;
use crate::progress_bar::{Bar, BarState};

/// Above this number of pending bytes, reporters omit detail.
const FULL: usize = 4 * 1024 * 1024;

/// Output within this time after the last write is collected, so that many short lines are
/// written together.
const GATHERING: Duration = Duration::from_micros(250);

/// A longer text is written even if its line is not complete.
const LINE_LIMIT: usize = 64 * 1024;

/// A data stream omits nothing: writing blocks above this number of pending bytes.
const STREAM_LIMIT: usize = 4 * 1024 * 1024;

/// A writer with a background thread. Cheap to clone; output that is written through
/// one handle keeps its order. [`Write::flush`] waits until everything is written.
#[derive(Clone, Debug)]
pub struct BackgroundWriter {
    shared: Arc<SharedBuffer>,
    /// How many bytes may wait before [`Write::write`] does.
    limit: usize,
    _handle: Arc<Handle>,
}

#[derive(Debug, Default)]
struct SharedBuffer {
    state: Mutex<WriterState>,
    changed: Condvar,
    /// How many bytes are not written yet.
    waiting: AtomicUsize,
}

#[derive(Debug, Default)]
struct WriterState {
    text: Vec<u8>,
    /// The length of the complete lines at the beginning of `text`. The rest waits for its end,
    /// because a bar or a prompt must not be drawn in a line.
    complete: usize,
    bar: Option<BarState>,
    /// How many wait in [`Write::flush`].
    flushing: usize,
    /// The thread has taken something and is not done with it.
    is_writing: bool,
    /// Output is discarded: its reader has disconnected, or an error occurred.
    is_over: bool,
    error: Option<io::Error>,
    /// All handles are gone.
    is_closed: bool,
}

/// Ends the thread when it is dropped.
#[derive(Debug)]
struct Handle(Arc<SharedBuffer>);

impl Drop for Handle {
    fn drop(&mut self) {
        self.0.lock().is_closed = true;
        self.0.changed.notify_all();
    }
}

impl WriterState {
    fn push(&mut self, bytes: &[u8]) {
        if let Some(end) = bytes.iter().rposition(|byte| *byte == b'\n') {
            self.complete = self.text.len() + end + 1;
        }
        self.text.extend_from_slice(bytes);
    }

    /// The length of the text that can be written now.
    fn writable(&self) -> usize {
        let is_all = self.flushing > 0 || self.is_closed || self.text.len() > LINE_LIMIT;
        if is_all { self.text.len() } else { self.complete }
    }

    fn take_text(&mut self) -> Vec<u8> {
        let rest = self.text.split_off(self.writable());
        self.complete = 0;
        std::mem::replace(&mut self.text, rest)
    }
}

impl SharedBuffer {
    fn lock(&self) -> MutexGuard<'_, WriterState> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait_while(&self, condition: impl Fn(&WriterState) -> bool) -> MutexGuard<'_, WriterState> {
        let state = self.changed.wait_while(self.lock(), |state| condition(state));
        state.unwrap_or_else(PoisonError::into_inner)
    }
}

impl BackgroundWriter {
    /// A writer for console output. It never blocks.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn new(out: Box<dyn Write + Send>) -> io::Result<Self> {
        let shared = Arc::new(SharedBuffer::default());
        let ours = Arc::clone(&shared);
        thread::Builder::new().name("output".into()).spawn(move || write_all(&ours, out))?;
        let handle = Arc::new(Handle(Arc::clone(&shared)));
        Ok(Self { shared, limit: usize::MAX, _handle: handle })
    }

    /// The same writer for a data stream: writing blocks when too much is pending.
    #[must_use]
    pub fn for_stream(&self) -> Self {
        Self { limit: STREAM_LIMIT, ..self.clone() }
    }

    /// The same writer for lines with colours, which are removed unless standard output shows
    /// them. What is written at once stays together: no bar is drawn in it.
    #[must_use]
    pub(crate) fn for_colours(&self) -> Box<dyn Write + Send> {
        match AutoStream::choice(&io::stdout()) {
            ColorChoice::Never => {
                Box::new(WithoutColours { out: self.clone(), stripper: StripBytes::new() })
            }
            _ => Box::new(self.clone()),
        }
    }

    /// Whether so much waits that detail should be left out.
    #[must_use]
    pub fn is_full(&self) -> bool {
        self.shared.waiting.load(Ordering::Relaxed) > FULL
    }

    /// Whether something is not written yet.
    #[must_use]
    pub fn is_waiting(&self) -> bool {
        self.shared.waiting.load(Ordering::Relaxed) > 0
    }

    /// Shows a progress bar below what is written.
    pub(crate) fn show(&self, bar: BarState) {
        self.shared.lock().bar = Some(bar);
        self.shared.changed.notify_all();
    }

    /// Discards all output and ends all waits.
    pub fn abandon(&self) {
        self.shared.lock().is_over = true;
        self.shared.changed.notify_all();
    }
}

impl Write for BackgroundWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let waiting = &self.shared.waiting;
        let is_full = |state: &WriterState| {
            let waiting = waiting.load(Ordering::Relaxed);
            !state.is_over && waiting > 0 && waiting.saturating_add(bytes.len()) > self.limit
        };
        let mut state = self.shared.wait_while(is_full);
        if let Some(error) = state.error.take() {
            return Err(error);
        }
        if !state.is_over {
            // Waking the thread is a system call; with text to write, it is awake already.
            let is_idle = state.writable() == 0;
            state.push(bytes);
            waiting.fetch_add(bytes.len(), Ordering::Relaxed);
            let wakes = is_idle && state.writable() > 0;
            drop(state);
            if wakes {
                self.shared.changed.notify_all();
            }
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        let is_busy = |state: &WriterState| {
            !state.is_over && (state.is_writing || !state.text.is_empty() || state.bar.is_some())
        };
        self.shared.lock().flushing += 1;
        self.shared.changed.notify_all();
        let mut state = self.shared.wait_while(is_busy);
        state.flushing -= 1;
        match state.error.take() {
            Some(error) => Err(error),
            None => Ok(()),
        }
    }
}

struct WithoutColours {
    out: BackgroundWriter,
    stripper: StripBytes,
}

impl Write for WithoutColours {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let plain = self.stripper.strip_next(bytes).collect::<Vec<_>>().concat();
        self.out.write_all(&plain).map(|()| bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}

/// The thread: writes what waits, until all handles are gone.
fn write_all(shared: &SharedBuffer, mut out: Box<dyn Write + Send>) {
    let mut bar = Bar::hidden();
    let mut written_at: Option<Instant> = None;
    loop {
        let is_idle =
            |state: &WriterState| state.writable() == 0 && state.bar.is_none() && !state.is_closed;
        drop(shared.wait_while(is_idle));
        if let Some(rest) = written_at.and_then(|at| GATHERING.checked_sub(at.elapsed())) {
            thread::sleep(rest);
        }
        let mut state = shared.lock();
        let (text, shown) = (state.take_text(), state.bar.take());
        if state.is_over || (text.is_empty() && shown.is_none()) {
            return;
        }
        state.is_writing = true;
        drop(state);
        let written = match text.is_empty() {
            true => Ok(()),
            false => bar.around(|| out.write_all(&text).and_then(|()| out.flush())),
        };
        // The text came first.
        shown.into_iter().for_each(|shown| bar.show(&shown));
        written_at = Some(Instant::now());
        shared.waiting.fetch_sub(text.len(), Ordering::Relaxed);
        let mut state = shared.lock();
        state.is_writing = false;
        if let Err(error) = written {
            state.is_over = true;
            state.error = Some(error).filter(|error| !is_disconnect(error));
        }
        drop(state);
        shared.changed.notify_all();
    }
}
