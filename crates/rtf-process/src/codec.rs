//! Lines of the host protocol, both ways.

use std::borrow::Cow;
use std::fmt;
use std::path::Path;

use rtf_model::protocol::{
    Initialize, Notification, PROTOCOL_VERSION, Reply, Request, RpcError, RpcMessage,
};
use serde::de::value::MapAccessDeserializer;
use serde::de::{DeserializeSeed, Error, IgnoredAny, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};
use serde_json::value::RawValue;

/// A line may not be longer than this, in bytes.
pub const LINE_LIMIT: usize = 16 * 1024 * 1024;

/// How many characters of an invalid line are shown.
const SHOWN: usize = 200;

#[derive(Debug)]
pub enum HostMessage {
    Notification(Notification),
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
    if let Ok(UsualNotification(notification)) = serde_json::from_str(text) {
        return Ok(HostMessage::Notification(notification));
    }
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

/// A notification with `jsonrpc`, `method` and `params` in this order, as hosts write it: it is
/// read in one pass, others in two.
struct UsualNotification(Notification);

impl<'de> Deserialize<'de> for UsualNotification {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(UsualVisitor)
    }
}

struct UsualVisitor;

impl<'de> Visitor<'de> for UsualVisitor {
    type Value = UsualNotification;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a notification")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
        if map.next_entry::<&str, IgnoredAny>()?.is_none_or(|(key, _)| key != "jsonrpc") {
            return Err(A::Error::missing_field("jsonrpc"));
        }
        let rest = MapAccessDeserializer::new(TwoEntries { map, count: 0 });
        Notification::deserialize(rest).map(UsualNotification)
    }
}

/// A map that must not have more than two entries: a third may be the `id` of a request.
struct TwoEntries<A> {
    map: A,
    count: u8,
}

impl<'de, A: MapAccess<'de>> MapAccess<'de> for TwoEntries<A> {
    type Error = A::Error;

    fn next_key_seed<K: DeserializeSeed<'de>>(
        &mut self,
        seed: K,
    ) -> Result<Option<K::Value>, A::Error> {
        let key = self.map.next_key_seed(seed)?;
        match (self.count, &key) {
            (2.., Some(_)) => Err(A::Error::custom("there is a third entry")),
            _ => {
                self.count += 1;
                Ok(key)
            }
        }
    }

    fn next_value_seed<V: DeserializeSeed<'de>>(&mut self, seed: V) -> Result<V::Value, A::Error> {
        self.map.next_value_seed(seed)
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
            | Notification::ProcessesLeft { .. }
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

    #[test]
    fn the_order_of_the_members_does_not_matter() {
        let lines = [
            r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"}}"#,
            r#"{"params":{"phase":"run"},"method":"phase","jsonrpc":"2.0"}"#,
            r#"{"jsonrpc":"2.0","params":{"phase":"run"},"method":"phase"}"#,
            r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"},"more":1}"#,
        ];
        for line in lines {
            let decoded = decode(line.as_bytes());
            let is_run = matches!(
                decoded,
                Ok(HostMessage::Notification(Notification::Phase { phase: Phase::Run }))
            );
            assert!(is_run, "{line}: {decoded:?}");
        }
        let requests = [
            r#"{"jsonrpc":"2.0","id":1,"method":"phase","params":{"phase":"run"}}"#,
            r#"{"jsonrpc":"2.0","method":"phase","id":1,"params":{"phase":"run"}}"#,
            r#"{"jsonrpc":"2.0","method":"phase","params":{"phase":"run"},"id":1}"#,
        ];
        for line in requests {
            let error = decode(line.as_bytes()).unwrap_err();
            assert_eq!(error, "it asks for `phase`, but the runner answers no requests", "{line}");
        }
    }
}
