//! Decodes a line of the channel into a request or an error.

use std::borrow::Cow;

use rtf_model::Episode;
use rtf_model::protocol::{INVALID_PARAMS, METHOD_NOT_FOUND, Request, RpcError};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

/// JSON-RPC error code: the line is not JSON.
const PARSE_ERROR: i32 = -32700;
/// JSON-RPC error code: the line is JSON, but no request.
pub(crate) const INVALID_REQUEST: i32 = -32600;

/// A decoded line.
#[derive(Clone, Debug, PartialEq)]
pub enum Incoming {
    /// A request, or a notification when it has no number.
    Request {
        /// The request's number.
        id: Option<u64>,
        request: Box<Request>,
    },
    /// A line that the host cannot carry out.
    Refused {
        /// The number, if there is one.
        id: Option<u64>,
        error: RpcError,
    },
}

impl Incoming {
    #[must_use]
    pub fn id(&self) -> Option<u64> {
        match self {
            Self::Request { id, .. } | Self::Refused { id, .. } => *id,
        }
    }

    /// The request, unless it is refused.
    #[must_use]
    pub fn request(&self) -> Option<&Request> {
        match self {
            Self::Request { request, .. } => Some(request),
            Self::Refused { .. } => None,
        }
    }
}

#[derive(Deserialize)]
struct Envelope<'a> {
    #[serde(default)]
    id: Option<u64>,
    #[serde(borrow)]
    method: Cow<'a, str>,
    #[serde(default, borrow)]
    params: Option<&'a RawValue>,
}

#[derive(Serialize, Deserialize)]
struct Interrupt {
    reason: String,
    #[serde(default)]
    request: Option<u64>,
}

#[derive(Serialize, Deserialize)]
struct Episodes {
    episodes: Vec<Episode>,
}

/// Decodes a line without its end.
#[must_use]
pub fn decode(line: &[u8]) -> Incoming {
    let envelope: Envelope<'_> = match serde_json::from_slice(line) {
        Ok(envelope) => envelope,
        Err(error) => {
            let code = if error.is_data() { INVALID_REQUEST } else { PARSE_ERROR };
            return refused(None, code, error.to_string());
        }
    };
    let id = envelope.id;
    let params = envelope.params;
    let request = match envelope.method.as_ref() {
        "initialize" => parse(params).map(Request::Initialize),
        "run-test" => parse(params).map(Request::RunTest),
        "set-up-fixture" => parse(params).map(Request::SetUpFixture),
        "check-fixture" => Ok(Request::CheckFixture {}),
        "test-started" => parse(params).map(Request::TestStarted),
        "test-ended" => parse(params).map(Request::TestEnded),
        "test-finished" => parse(params).map(Request::TestFinished),
        "test-reported" => parse(params).map(Request::TestReported),
        "tear-down-fixture" => Ok(Request::TearDownFixture {}),
        "interrupt" => parse::<Interrupt>(params)
            .map(|p| Request::Interrupt { reason: p.reason, request: p.request }),
        "question-closed" => parse(params).map(Request::QuestionClosed),
        "episodes" => parse::<Episodes>(params)
            .map(|further| Request::Episodes { episodes: further.episodes }),
        "end-of-episodes" => Ok(Request::EndOfEpisodes {}),
        "dump-stack" => Ok(Request::DumpStack {}),
        unknown => return refused(id, METHOD_NOT_FOUND, format!("unknown method `{unknown}`")),
    };
    match request {
        Ok(request) => Incoming::Request { id, request: Box::new(request) },
        Err(error) => {
            refused(id, INVALID_PARAMS, format!("parameters of `{}`: {error}", envelope.method))
        }
    }
}

fn parse<T: DeserializeOwned>(params: Option<&RawValue>) -> serde_json::Result<T> {
    serde_json::from_str(params.map_or("{}", RawValue::get))
}

fn refused(id: Option<u64>, code: i32, message: String) -> Incoming {
    Incoming::Refused { id, error: RpcError { code, message } }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rtf_model::Parameter;
    use rtf_model::protocol::{Initialize, Plugin, QuestionEnd, RpcMessage};

    fn code(line: &str) -> (Option<u64>, i32) {
        match decode(line.as_bytes()) {
            Incoming::Refused { id, error } => (id, error.code),
            Incoming::Request { .. } => panic!("accepted: {line}"),
        }
    }

    #[test]
    fn every_request_of_the_model_is_read_as_it_was_written() {
        let plugin =
            Plugin { file: "/a b.so".into(), args: vec!["x y".into()], ..Plugin::default() };
        let requests = [
            Request::Initialize(Initialize { protocol: 1, rtf: "0.1.0".into(), stack_file: None }),
            Request::RunTest(plugin.clone()),
            Request::SetUpFixture(plugin),
            Request::CheckFixture {},
            Request::TearDownFixture {},
            Request::Interrupt { reason: "Ctrl-C".into(), request: None },
            Request::QuestionClosed(QuestionEnd {
                question: 1,
                answer: Some("yes".into()),
                problem: None,
            }),
            Request::Episodes {
                episodes: vec![
                    Episode::new(17, 3, vec![Parameter { name: "x".into(), value: "1".into() }]),
                    Episode { alone: true, ..Episode::new(18, 0, Vec::new()) },
                ],
            },
            Request::EndOfEpisodes {},
            Request::DumpStack {},
        ];
        for request in requests {
            let id = request.is_answered().then_some(7);
            let line = serde_json::to_vec(&RpcMessage::new(id, request.clone())).unwrap();
            assert_eq!(decode(&line), Incoming::Request { id, request: Box::new(request) });
        }
    }

    #[test]
    fn invalid_lines_are_refused_with_their_codes() {
        assert_eq!(code(r#"{"id":4,"method":"paint-test","params":{}}"#), (Some(4), -32601));
        assert_eq!(code(r#"{"id":5,"method":"run-test","params":{"file":3}}"#), (Some(5), -32602));
        assert_eq!(code(r#"{"id":6,"method":"run-test"}"#), (Some(6), -32602));
        assert_eq!(code(r#"{"id":7}"#), (None, -32600));
        assert_eq!(code("not json"), (None, -32700));
    }

    #[test]
    fn unknown_fields_are_ignored() {
        let line =
            br#"{"jsonrpc":"2.0","id":1,"new":[],"method":"check-fixture","params":{"x":1}}"#;
        assert_eq!(
            decode(line),
            Incoming::Request { id: Some(1), request: Box::new(Request::CheckFixture {}) }
        );
    }
}
