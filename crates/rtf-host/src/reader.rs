//! Reading the channel: at first on the main thread, and on the one thread
//! that a host adds as soon as there is a plug-in that may have to be stopped.

use std::io::{BufRead, BufReader, Read};
use std::os::unix::net::UnixStream;
use std::sync::Arc;

use rtf_model::protocol::Request;

use crate::decode::{Incoming, decode};
use crate::session::Session;
use crate::writer::LINE_LIMIT;
use crate::{Reaction, unix};

/// Enough for decoding a line and for a host's stack dumper.
const STACK_BYTES: usize = 256 * 1024;
/// Enough for the requests of most tests; longer lines grow it.
const BUFFER_BYTES: usize = 1024;

/// The channel's receiving side.
///
/// Its memory is allocated on the main thread: a second thread that allocates
/// costs the process a second heap, which takes longer than all that a small
/// test does.
pub(crate) struct Reader {
    session: Session,
    input: BufReader<Channel>,
    line: Vec<u8>,
    dumper: Option<Reaction>,
    stopper: Option<Reaction>,
}

impl Reader {
    pub(crate) fn new(
        session: &Session,
        dumper: Option<Reaction>,
        stopper: Option<Reaction>,
    ) -> Self {
        Self {
            session: session.clone(),
            input: BufReader::with_capacity(BUFFER_BYTES, Channel(session.channel())),
            line: Vec::with_capacity(BUFFER_BYTES),
            dumper,
            stopper,
        }
    }

    /// The next request that is for the main thread, `None` at the end of the
    /// channel. What has to be heard at once is carried out here.
    pub(crate) fn next(&mut self) -> Option<Incoming> {
        loop {
            self.line.clear();
            let mut input = (&mut self.input).take(LINE_LIMIT as u64);
            match input.read_until(b'\n', &mut self.line) {
                Ok(0) | Err(_) => return None,
                Ok(_) => {}
            }
            match decode(self.line.trim_ascii_end()) {
                Incoming::Request { request: Request::Interrupt { reason, request }, .. } => {
                    if self.session.request_stop(&reason, request)
                        && let Some(insist) = &self.stopper
                    {
                        insist(&self.session);
                    }
                }
                Incoming::Request { request: Request::DumpStack {}, .. } => {
                    if let Some(dump) = &self.dumper {
                        dump(&self.session);
                    }
                }
                incoming => return Some(incoming),
            }
        }
    }

    /// Whether all that has been received was read.
    pub(crate) fn is_drained(&self) -> bool {
        self.input.buffer().is_empty()
    }

    /// Goes on reading on a thread of its own, which ends with the channel.
    pub(crate) fn spawn(mut self) -> std::io::Result<()> {
        let read = move || {
            while let Some(incoming) = self.next() {
                self.session.push(incoming);
            }
            self.session.close();
        };
        unix::spawn_thread(STACK_BYTES, Box::new(read))
    }
}

/// The channel, shared with whoever writes.
struct Channel(Arc<UnixStream>);

impl Read for Channel {
    fn read(&mut self, bytes: &mut [u8]) -> std::io::Result<usize> {
        (&*self.0).read(bytes)
    }
}
