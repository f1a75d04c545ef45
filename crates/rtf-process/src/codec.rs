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

/// How many characters of an invalid line are shown.
const SHOWN: usize = 200;

/// A message of a host.
#[derive(Debug)]
pub enum HostMessage {
    /// A notification.
    Notification(Notification),
    /// The reply to a request.
    Reply(u64, Reply<serde_json::Value>),
}

#[derive(Deserialize)]
struct RpcEnvelope<'a> {
    id: Option<u64>,
    #[serde(borrow)]
    method: Option<Cow<'a, str>>,
    #[serde(borrow)]
    result: Option<&'a RawValue>,
    error: Option<RpcError>,
}

/// The id of `initialize` on every channel; later requests have other ids.
pub const INITIALIZE: u64 = 1;

/// Returns the first line of every channel: `initialize`. The host may dump its stacks to
/// `stack_file`.
///
/// # Errors
/// As for [`encode`].
pub fn greeting(stack_file: Option<&Path>) -> Result<Vec<u8>, serde_json::Error> {
    let request = Request::Initialize(Initialize {
        protocol: PROTOCOL_VERSION,
        rtf: env!("CARGO_PKG_VERSION").to_owned(),
        stack_file: stack_file.map(|file| file.to_string_lossy().into_owned()),
    });
    encode(Some(INITIALIZE), request)
}

/// Serialises a request, with its line end.
///
/// # Errors
/// Never for the protocol's types.
pub fn encode(id: Option<u64>, request: Request) -> Result<Vec<u8>, serde_json::Error> {
    let mut line = serde_json::to_vec(&RpcMessage::new(id, request))?;
    line.push(b'\n');
    Ok(line)
}

/// Parses a line, without its end.
///
/// # Errors
/// Why the line is invalid, for users.
pub fn decode(line: &[u8]) -> Result<HostMessage, String> {
    let text = std::str::from_utf8(line).map_err(|_| not_a_message(line, "it is not UTF-8"))?;
    let envelope: RpcEnvelope<'_> =
        serde_json::from_str(text).map_err(|error| not_a_message(line, &error.to_string()))?;
    match envelope {
        RpcEnvelope { method: Some(_), id: None, .. } => serde_json::from_str(text)
            .map(HostMessage::Notification)
            .map_err(|error| not_a_message(line, &error.to_string())),
        RpcEnvelope { method: Some(method), id: Some(_), .. } => {
            Err(format!("it asks for `{method}`, but the runner answers no requests"))
        }
        RpcEnvelope { id: Some(id), error: Some(error), .. } => {
            Ok(HostMessage::Reply(id, Reply::Error(error)))
        }
        RpcEnvelope { id: Some(id), result: Some(result), .. } => {
            serde_json::from_str(result.get())
                .map(|value| HostMessage::Reply(id, Reply::Result(value)))
                .map_err(|error| not_a_message(line, &error.to_string()))
        }
        RpcEnvelope { .. } => Err(not_a_message(line, "neither a notification nor an answer")),
    }
}

/// As [`decode`], for a line that a forked process wrote to the host's channel. `None`
/// for a message that is ignored: see "Processes that a plug-in forks" in
/// `spec/protocol.md`.
pub fn decode_other(line: &[u8]) -> Option<Result<HostMessage, String>> {
    let decoded = decode(line);
    match &decoded {
        Ok(HostMessage::Reply(..)) => None,
        Ok(HostMessage::Notification(
            Notification::Phase { .. }
            | Notification::Stack { .. }
            | Notification::CasesPlanned { .. }
            | Notification::CaseStarted(_)
            | Notification::CaseFinished { .. }
            | Notification::QuestionAsked(_),
        )) => None,
        Ok(HostMessage::Notification(_)) | Err(_) => Some(decoded),
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
    fn notifications_and_replies_are_distinguished() {
        let told = decode(br#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"}}"#);
        assert!(matches!(
            told,
            Ok(HostMessage::Notification(Notification::Phase { phase: Phase::Run }))
        ));
        let answer = decode(br#"{"jsonrpc":"2.0","id":7,"result":{"outcome":"passed"},"x":1}"#);
        assert!(matches!(answer, Ok(HostMessage::Reply(7, Reply::Result(_)))));
    }

    #[test]
    fn a_forked_process_reports_but_does_not_reply() {
        let answer = br#"{"jsonrpc":"2.0","id":7,"result":{"outcome":"passed"}}"#;
        assert!(decode_other(answer).is_none());
        let phase = br#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"}}"#;
        assert!(decode_other(phase).is_none());
        let collapse = br#"{"jsonrpc":"2.0","method":"collapsed","params":{"reason":"gone"}}"#;
        assert!(matches!(decode_other(collapse), Some(Ok(HostMessage::Notification(_)))));
        assert!(matches!(decode_other(b"garbage"), Some(Err(_))));
    }

    #[test]
    fn an_invalid_line_is_shown() {
        let error = decode(b"this is not a message").unwrap_err();
        assert!(error.starts_with("it wrote `this is not a message`"), "{error}");
        assert!(decode(br#"{"jsonrpc":"2.0","method":"nonsense","params":{}}"#).is_err());
        assert!(decode(&[0xFF, 0xFE]).is_err());
    }
}
