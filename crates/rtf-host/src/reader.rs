//! Reads the channel: first on the main thread, and on the host's only other thread as
//! soon as there is a plug-in that the runner may want to stop.

use std::io::{BufRead, BufReader, Read};
use std::os::unix::net::UnixStream;
use std::sync::Arc;

use rtf_model::protocol::Request;

use crate::decode::{Incoming, decode};
use crate::session::Session;
use crate::writer::LINE_LIMIT;
use crate::{HostPlugin, Reaction, unix};

/// Enough for decoding a line and for a host's stack dumper.
const STACK_BYTES: usize = 256 * 1024;
/// Enough for the requests of most tests; longer lines grow it.
const BUFFER_BYTES: usize = 1024;

/// The channel's receiving side.
///
/// Its memory is allocated on the main thread: a second thread that allocates gets
/// a second heap, which takes longer than everything that a small test does.
pub(crate) struct Reader {
    session: Session,
    input: BufReader<Channel>,
    line: Vec<u8>,
    dumper: Option<Reaction>,
    stopper: Option<Reaction>,
    closer: Option<Reaction>,
}

impl Reader {
    pub(crate) fn new(session: &Session, host: &impl HostPlugin) -> Self {
        Self {
            session: session.clone(),
            input: BufReader::with_capacity(BUFFER_BYTES, Channel(session.channel())),
            line: Vec::with_capacity(BUFFER_BYTES),
            dumper: host.stack_dumper(),
            stopper: host.stopper(),
            closer: host.closer(),
        }
    }

    /// The next request for the main thread, `None` at the end of the channel. Handles
    /// notifications of the runner itself.
    pub(crate) fn next(&mut self) -> Option<Incoming> {
        loop {
            self.line.clear();
            let mut input = (&mut self.input).take(LINE_LIMIT as u64);
            match input.read_until(b'\n', &mut self.line) {
                Ok(0) | Err(_) => return None,
                Ok(_) => {}
            }
            let incoming = decode(self.line.trim_ascii_end());
            match incoming.request() {
                Some(Request::Interrupt { reason, request }) => {
                    if self.session.request_stop(reason, *request)
                        && let Some(stop) = &self.stopper
                    {
                        stop(&self.session);
                    }
                }
                Some(Request::QuestionClosed(end)) => self.session.end_question(end),
                Some(Request::Episodes { .. } | Request::EndOfEpisodes {}) => {
                    self.session.queue_episodes(incoming);
                }
                Some(Request::DumpStack {}) => {
                    if let Some(dump) = &self.dumper {
                        dump(&self.session);
                    }
                }
                _ => return Some(incoming),
            }
        }
    }

    /// Whether everything that was received has been handled.
    pub(crate) fn is_drained(&self) -> bool {
        self.input.buffer().is_empty()
    }

    /// Continues on a dedicated thread, which ends with the channel.
    pub(crate) fn spawn(mut self) -> std::io::Result<()> {
        let read = move || {
            while let Some(incoming) = self.next() {
                self.session.push(incoming);
            }
            if let Some(undo) = self.closer {
                undo(&self.session);
            }
            self.session.close();
        };
        unix::spawn_thread(STACK_BYTES, Box::new(read))
    }
}

/// The channel, shared with the writer.
struct Channel(Arc<UnixStream>);

impl Read for Channel {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        (&*self.0).read(bytes)
    }
}
