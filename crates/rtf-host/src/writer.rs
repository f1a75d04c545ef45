//! Writes lines to the channel, each complete before the call returns.

use std::os::unix::net::UnixStream;
use std::sync::{Arc, Mutex, PoisonError};

use rtf_model::Message;
use rtf_model::protocol::{Notification, RpcMessage};
use serde::Serialize;

use crate::unix;

/// The longest line that the runner accepts, its end included.
pub(crate) const LINE_LIMIT: usize = 16 * 1024 * 1024;

/// The channel's sending side. It has no buffer, so that a crash right after a report
/// does not lose it.
#[derive(Debug)]
pub(crate) struct Writer {
    channel: Arc<UnixStream>,
    line: Mutex<Vec<u8>>,
    /// The lines, if there is no runner that gets them.
    kept: Option<Mutex<Vec<u8>>>,
}

impl Writer {
    pub(crate) fn new(channel: Arc<UnixStream>) -> Self {
        Self { channel, line: Mutex::new(Vec::with_capacity(512)), kept: None }
    }

    /// A writer that keeps the lines.
    pub(crate) fn keeping(channel: Arc<UnixStream>) -> Self {
        Self { kept: Some(Mutex::default()), ..Self::new(channel) }
    }

    /// The lines that were kept since the last call.
    pub(crate) fn take_kept(&self) -> Vec<u8> {
        let kept =
            self.kept.as_ref().map(|kept| kept.lock().unwrap_or_else(PoisonError::into_inner));
        kept.map(|mut kept| std::mem::take(&mut *kept)).unwrap_or_default()
    }

    /// Sends a notification. A message that is too long for a line is sent in several
    /// parts.
    pub(crate) fn notify(&self, notification: &Notification) {
        if self.send(None, notification) {
            return;
        }
        if let Notification::Message(message) = notification {
            for part in halves(message) {
                self.notify(&Notification::Message(part));
            }
        }
    }

    /// Sends a line; false if it is too long and was not sent. Without a runner, ends the
    /// process.
    pub(crate) fn send<T: Serialize>(&self, id: Option<u64>, body: &T) -> bool {
        let mut line = self.line.lock().unwrap_or_else(PoisonError::into_inner);
        line.clear();
        if serde_json::to_writer(&mut *line, &RpcMessage::new(id, body)).is_err() {
            return false;
        }
        line.push(b'\n');
        let fits = line.len() <= LINE_LIMIT;
        match &self.kept {
            Some(kept) if fits => {
                kept.lock().unwrap_or_else(PoisonError::into_inner).extend_from_slice(&line);
            }
            None if fits && unix::send_all(&self.channel, &line).is_err() => unix::exit_now(1),
            _ => {}
        }
        if line.capacity() > 64 * 1024 {
            *line = Vec::with_capacity(512);
        }
        fits
    }
}

/// The two halves of a message's text, as separate messages.
fn halves(message: &Message) -> Vec<Message> {
    let text = &message.text;
    let middle = (text.len() / 2..text.len()).find(|&at| text.is_char_boundary(at)).unwrap_or(0);
    if middle == 0 {
        return Vec::new();
    }
    let (first, second) = text.split_at(middle);
    let part = |text: &str| Message { text: text.to_owned(), comparison: None, ..message.clone() };
    vec![Message { comparison: message.comparison.clone(), ..part(first) }, part(second)]
}
