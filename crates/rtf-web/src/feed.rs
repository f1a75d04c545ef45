//! A feed sends a journal to one client: from an event on, as fast as the client
//! reads it, and then as the run continues.
//!
//! A feed holds its position in the file and one batch of events. Events that the client
//! does not read stay in the file, so that a client that does not read costs
//! nothing; when it resumes and is too far behind, it must load a new snapshot.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::response::sse::Event;
use rtf_model::{FixtureId, HookId, Source, TestId};
use rtf_report::journal::EventHeader;
use serde_json::json;
use tokio::sync::watch;

use crate::app::blocking;
use crate::index::{LineReader, State};
use crate::problem::Problem;
use crate::runs::Run;

/// A client that is further behind than this many bytes must load a new snapshot.
const BEHIND: u64 = 8 << 20;
/// Maximum size of a batch, in bytes of the journal.
const BATCH: u64 = 256 * 1024;
/// Polling interval for a journal of another process …
const LOOK: Duration = Duration::from_millis(100);
/// … and for that of this process, whose growth is notified.
const LOOK_NOTIFIED: Duration = Duration::from_secs(1);
/// How long growth is collected.
const COLLECT: Duration = Duration::from_millis(20);
/// Minimum time between two batches. Each wakes the client, which may need
/// the processors that the tests run on.
const BETWEEN: Duration = Duration::from_millis(100);
/// Interval of `progress` events while details are omitted.
const PROGRESS: Duration = Duration::from_secs(1);
/// How long the guard may take to complete the journal of a runner that died.
const ABANDONED: Duration = Duration::from_secs(10);

/// How many digits an id has at most.
const LONGEST_ID: usize = 9;

/// The sources whose messages, measurements and output a client requests.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Details {
    All,
    Of(Vec<Source>),
}

impl Details {
    /// Reads `all`, `none`, or a list like `test:3,fixture:0`.
    ///
    /// # Errors
    /// It is none of these.
    pub fn parse(text: &str) -> Result<Self, Problem> {
        let source = |item: &str| {
            let (kind, id) = item.split_once(':')?;
            let is_id =
                (1..=LONGEST_ID).contains(&id.len()) && id.bytes().all(|c| c.is_ascii_digit());
            let id = id.parse().ok().filter(|_| is_id)?;
            match kind {
                "test" => Some(Source::Test(TestId(id))),
                "fixture" => Some(Source::Fixture(FixtureId(id))),
                "hook" => Some(Source::Hook(HookId(id))),
                _ => None,
            }
        };
        match text {
            "all" => Ok(Self::All),
            "none" => Ok(Self::Of(Vec::new())),
            list => {
                let sources = list.split(',').map(source).collect::<Option<_>>().map(Self::Of);
                sources.ok_or_else(|| {
                    let expected = "expected `all`, `none`, or a list like `test:3,fixture:0`";
                    Problem::bad_request(format!("`details` is `{list}`, {expected}"))
                })
            }
        }
    }

    fn want(&self, header: &EventHeader) -> bool {
        match (self, header.detail_source()) {
            (Self::All, _) | (_, None) => true,
            (Self::Of(sources), Some(source)) => sources.contains(&source),
        }
    }
}

/// Sends a journal to one client.
#[derive(Debug)]
pub struct Feed {
    at: Option<FeedPosition>,
    grown: Option<watch::Receiver<u64>>,
    ending: Option<watch::Receiver<bool>>,
    ended: bool,
    /// When the journal last grew.
    moved: Option<Instant>,
}

/// The position of a client in the journal.
#[derive(Debug)]
struct FeedPosition {
    run: Arc<Run>,
    details: Details,
    /// Lines before this offset have been processed.
    offset: u64,
    /// The number of the next event.
    next: u64,
    /// The last omitted event since the last `progress`.
    left_out: Option<(u64, u64)>,
    told: Instant,
    /// Since when there were no events.
    quiet: Instant,
    /// Why the client must load a new snapshot, before anything else is sent.
    anew: Option<&'static str>,
}

/// New events in the journal.
#[derive(Debug, Default)]
struct Batch {
    events: Vec<Event>,
    /// Nothing is left for now.
    is_last: bool,
    /// The run has ended, and everything was sent.
    is_over: bool,
}

impl Feed {
    /// A client that wants the events from `from` on; nothing when there are
    /// none and never will be.
    ///
    /// # Errors
    /// The journal cannot be read.
    pub fn open(
        run: Arc<Run>,
        from: Option<u64>,
        details: Details,
    ) -> Result<Option<Self>, Problem> {
        let index = run.read()?;
        let coming = index.next_seq();
        let next = from.unwrap_or(coming);
        if next >= coming && index.state().is_over() && index.state() != State::Incomplete {
            return Ok(None);
        }
        let anew = (next > coming).then_some("these events have not happened yet");
        let offset = if next >= coming { index.offset } else { index.positions.before(next) };
        drop(index);
        let (left_out, now) = (None, Instant::now());
        let next = next.min(coming);
        let at = FeedPosition { run, details, offset, next, left_out, told: now, quiet: now, anew };
        Ok(Some(Self { at: Some(at), grown: None, ending: None, ended: false, moved: None }))
    }

    /// Subscribes to growth of the journal, if this process writes it, and to the shutdown of the
    /// server.
    pub fn listen(&mut self, grown: Option<watch::Receiver<u64>>, ending: watch::Receiver<bool>) {
        (self.grown, self.ending) = (grown, Some(ending));
    }

    /// The next events; `None` at the end of the stream.
    pub async fn next(&mut self) -> Option<Vec<Event>> {
        while !self.ended {
            let ending = self.ending.as_ref().is_some_and(|ending| *ending.borrow());
            let batch = self.look().await?;
            self.ended = batch.is_over || (ending && batch.is_last);
            if !batch.events.is_empty() {
                return Some(batch.events);
            }
            if !self.ended && batch.is_last {
                self.wait().await;
            }
        }
        None
    }

    async fn look(&mut self) -> Option<Batch> {
        // The place goes to a thread that may wait, and comes back.
        let mut at = self.at.take()?;
        let before = at.offset;
        let (at, batch) = blocking(move || {
            let batch = at.look()?;
            Ok((at, batch))
        })
        .await
        .ok()?;
        if at.offset != before {
            self.moved = Some(Instant::now());
        }
        self.at = Some(at);
        Some(batch)
    }

    async fn wait(&mut self) {
        let look = if self.grown.is_some() { LOOK_NOTIFIED } else { LOOK };
        let soon = Instant::now() + COLLECT;
        let due = self.moved.map_or(soon, |moved| soon.max(moved + BETWEEN));
        let grown = async {
            let Some(grown) = &mut self.grown else { return std::future::pending().await };
            match grown.changed().await {
                Ok(()) => tokio::time::sleep_until(due.into()).await,
                Err(_) => std::future::pending().await,
            }
        };
        let ending = async {
            let Some(ending) = &mut self.ending else { return std::future::pending().await };
            if ending.wait_for(|ending| *ending).await.is_err() {
                std::future::pending::<()>().await;
            }
        };
        tokio::select! {
            () = grown => {}
            () = ending => {}
            () = tokio::time::sleep_until(due.max(Instant::now() + look).into()) => {}
        }
    }
}

impl FeedPosition {
    fn look(&mut self) -> Result<Batch, Problem> {
        let index = self.run.read()?;
        let (end, coming, state) = (index.offset, index.next_seq(), index.state());
        drop(index);
        let mut batch = Batch::default();
        if self.anew.is_none() && end.saturating_sub(self.offset) > BEHIND {
            self.anew = Some("the client was too far behind");
            (self.offset, self.next) = (end, coming);
        }
        if let Some(reason) = self.anew.take() {
            batch.events.push(resync(self.next, reason));
        }
        if self.offset < end {
            self.read(end, &mut batch)?;
        }
        batch.is_last = self.offset >= end;
        self.tell_progress(&mut batch);
        self.end(state, &mut batch);
        Ok(batch)
    }

    /// Reads the next events of a journal that was read until `end`.
    fn read(&mut self, end: u64, batch: &mut Batch) -> Result<(), Problem> {
        let failed = crate::runs::unreadable;
        let stop = end.min(self.offset.saturating_add(BATCH));
        let journal = self.run.journal()?;
        let mut lines = LineReader::between(journal, self.offset, stop).map_err(failed)?;
        while let Some(line) = lines.next().map_err(failed)? {
            self.offset = line.end;
            let Ok(header) = serde_json::from_slice::<EventHeader>(line.text) else { continue };
            let Ok(text) = str::from_utf8(line.text) else { continue };
            if header.seq < self.next {
                continue;
            }
            if header.seq > self.next {
                batch.events.push(resync(header.seq, "the journal is damaged"));
            }
            self.next = header.seq.saturating_add(1);
            if self.details.want(&header) {
                self.left_out = None;
                batch.events.push(Event::default().id(header.seq.to_string()).data(text));
            } else {
                self.left_out = Some((header.seq, header.at));
            }
        }
        Ok(())
    }

    fn tell_progress(&mut self, batch: &mut Batch) {
        if let Some((seq, at)) = self.left_out.filter(|_| self.told.elapsed() >= PROGRESS) {
            (self.left_out, self.told) = (None, Instant::now());
            batch.events.push(named("progress", seq, &json!({ "seq": seq + 1, "last_at": at })));
        }
        if !batch.events.is_empty() || !batch.is_last {
            self.quiet = Instant::now();
        }
    }

    fn end(&self, state: State, batch: &mut Batch) {
        let settled = state != State::Incomplete || self.quiet.elapsed() >= ABANDONED;
        if batch.is_last && state.is_over() && settled {
            batch.is_over = true;
            let seq = self.next.saturating_sub(1);
            batch.events.push(named("end", seq, &json!({ "state": state })));
        }
    }
}

fn resync(from: u64, reason: &str) -> Event {
    named("resync", from.saturating_sub(1), &json!({ "from": from, "reason": reason }))
}

fn named(name: &str, id: u64, data: &serde_json::Value) -> Event {
    Event::default().event(name).id(id.to_string()).data(data.to_string())
}
