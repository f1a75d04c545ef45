//! The one thread that a host adds: it reads the channel while the plug-in runs.

use std::io::{BufRead, BufReader, Read};
use std::os::unix::net::UnixStream;

use rtf_model::protocol::Request;

use crate::decode::{Incoming, decode};
use crate::session::Session;
use crate::writer::LINE_LIMIT;
use crate::{StackDumper, unix};

/// Enough for decoding a line and for a host's stack dumper.
const STACK_BYTES: usize = 256 * 1024;

/// Starts the thread. It ends with the channel.
pub(crate) fn spawn(session: Session, dumper: Option<StackDumper>) -> std::io::Result<()> {
    std::thread::Builder::new()
        .name("rtf-channel".to_owned())
        .stack_size(STACK_BYTES)
        .spawn(move || {
            unix::block_signals();
            read(&session, dumper.as_ref());
            session.close();
        })
        .map(drop)
}

fn read(session: &Session, dumper: Option<&StackDumper>) {
    let channel: &UnixStream = session.channel();
    let mut input = BufReader::with_capacity(8 * 1024, channel);
    let mut line = Vec::new();
    loop {
        line.clear();
        let limit = LINE_LIMIT as u64;
        match (&mut input).take(limit).read_until(b'\n', &mut line) {
            Ok(0) | Err(_) => return,
            Ok(_) => {}
        }
        match decode(line.trim_ascii_end()) {
            Incoming::Request {
                request: Request::Interrupt { reason },
                ..
            } => {
                session.request_stop(&reason);
            }
            Incoming::Request {
                request: Request::DumpStack {},
                ..
            } => {
                if let Some(dump) = dumper {
                    dump(session);
                }
            }
            incoming => session.push(incoming),
        }
    }
}
