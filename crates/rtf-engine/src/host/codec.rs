//! Lines of the host protocol, both ways.

use std::borrow::Cow;
use std::path::Path;

use rtf_model::protocol::{
    Initialize, Notification, PROTOCOL_VERSION, Reply, Request, RpcError, RpcMessage,
};
use serde::Deserialize;
use serde_json::value::RawValue;

/// A line may not be longer than this, in bytes.
pub const LINE_LIMIT: usize = 16 * 1024 * 1024;

/// How much of a line that is not understood is shown, in characters.
const SHOWN: usize = 200;

/// What a host said.
#[derive(Debug)]
pub enum FromHost {
    /// Something that it was not asked for.
    Told(Notification),
    /// The answer to a request.
    Answered(u64, Reply<serde_json::Value>),
}

#[derive(Deserialize)]
struct Envelope<'a> {
    id: Option<u64>,
    #[serde(borrow)]
    method: Option<Cow<'a, str>>,
    #[serde(borrow)]
    result: Option<&'a RawValue>,
    error: Option<RpcError>,
}

/// The number of `initialize` on every channel; later requests have others.
pub const INITIALIZE: u64 = 1;

/// The first line on every channel: `initialize`.
///
/// # Errors
/// As for [`encode`].
pub fn greeting(stack_file: &Path) -> Result<Vec<u8>, serde_json::Error> {
    let request = Request::Initialize(Initialize {
        protocol: PROTOCOL_VERSION,
        rtf: env!("CARGO_PKG_VERSION").to_owned(),
        stack_file: Some(stack_file.to_string_lossy().into_owned()),
    });
    encode(Some(INITIALIZE), request)
}

/// Writes a request, with its line end.
///
/// # Errors
/// Never for the types of this crate; serde_json has to say so.
pub fn encode(id: Option<u64>, request: Request) -> Result<Vec<u8>, serde_json::Error> {
    let mut line = serde_json::to_vec(&RpcMessage::new(id, request))?;
    line.push(b'\n');
    Ok(line)
}

/// Reads a line, without its end.
///
/// # Errors
/// What is wrong with the line, for people.
pub fn decode(line: &[u8]) -> Result<FromHost, String> {
    let text = std::str::from_utf8(line).map_err(|_| not_a_message(line, "it is not UTF-8"))?;
    let envelope: Envelope<'_> =
        serde_json::from_str(text).map_err(|error| not_a_message(line, &error.to_string()))?;
    match envelope {
        Envelope { method: Some(_), id: None, .. } => serde_json::from_str(text)
            .map(FromHost::Told)
            .map_err(|error| not_a_message(line, &error.to_string())),
        Envelope { method: Some(method), id: Some(_), .. } => {
            Err(format!("it asks for `{method}`, but the runner answers no requests"))
        }
        Envelope { id: Some(id), error: Some(error), .. } => {
            Ok(FromHost::Answered(id, Reply::Error(error)))
        }
        Envelope { id: Some(id), result: Some(result), .. } => serde_json::from_str(result.get())
            .map(|value| FromHost::Answered(id, Reply::Result(value)))
            .map_err(|error| not_a_message(line, &error.to_string())),
        Envelope { .. } => Err(not_a_message(line, "neither a notification nor an answer")),
    }
}

/// As [`decode`], of a line that was not written by the host but by another process that
/// has its channel. `None` when it does not count: see "Processes that a plug-in forks" in
/// `spec/protocol.md`.
pub fn decode_other(line: &[u8]) -> Option<Result<FromHost, String>> {
    let decoded = decode(line);
    match &decoded {
        Ok(FromHost::Answered(..)) => None,
        Ok(FromHost::Told(Notification::Phase { .. } | Notification::Stack { .. })) => None,
        Ok(FromHost::Told(_)) | Err(_) => Some(decoded),
    }
}

fn not_a_message(line: &[u8], why: &str) -> String {
    let text = String::from_utf8_lossy(line);
    let shown: String = text.chars().take(SHOWN).collect();
    let dots = if text.chars().nth(SHOWN).is_some() { "…" } else { "" };
    format!("it wrote `{shown}{dots}`, which is not a message: {why}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtf_model::Phase;

    #[test]
    fn notifications_and_answers_are_told_apart() {
        let told = decode(br#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"}}"#);
        assert!(matches!(told, Ok(FromHost::Told(Notification::Phase { phase: Phase::Run }))));
        let answer = decode(br#"{"jsonrpc":"2.0","id":7,"result":{"outcome":"passed"},"x":1}"#);
        assert!(matches!(answer, Ok(FromHost::Answered(7, Reply::Result(_)))));
    }

    #[test]
    fn another_process_reports_but_does_not_answer() {
        let answer = br#"{"jsonrpc":"2.0","id":7,"result":{"outcome":"passed"}}"#;
        assert!(decode_other(answer).is_none());
        let phase = br#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"}}"#;
        assert!(decode_other(phase).is_none());
        let collapse = br#"{"jsonrpc":"2.0","method":"collapsed","params":{"reason":"gone"}}"#;
        assert!(matches!(decode_other(collapse), Some(Ok(FromHost::Told(_)))));
        assert!(matches!(decode_other(b"garbage"), Some(Err(_))));
    }

    #[test]
    fn what_is_not_a_message_is_shown() {
        let error = decode(b"this is not a message").unwrap_err();
        assert!(error.starts_with("it wrote `this is not a message`"), "{error}");
        assert!(decode(br#"{"jsonrpc":"2.0","method":"nonsense","params":{}}"#).is_err());
        assert!(decode(&[0xFF, 0xFE]).is_err());
    }
}
