//! Lines of the host protocol, both ways.

use rtf_host::Incoming;
use rtf_model::protocol::{Reply, RpcMessage};
use rtf_process::codec::{self, HostMessage};

/// A line that a host receives: a request is the same after it is printed.
pub fn check_request(line: &[u8]) {
    match rtf_host::decode(line) {
        Incoming::Refused { error, .. } => assert!(!error.message.is_empty() && error.code < 0),
        Incoming::Request { id, request } => {
            let printed = serde_json::to_vec(&RpcMessage::new(id, &*request)).expect("JSON");
            let again = rtf_host::decode(&printed);
            assert_eq!(again, Incoming::Request { id, request });
        }
    }
}

/// A line that the runner receives: a message is the same after it is printed.
pub fn check_host_message(line: &[u8]) {
    let decoded = match codec::decode(line) {
        Ok(decoded) => decoded,
        Err(error) => {
            assert!(!error.is_empty() && error.chars().count() < 4000, "{error}");
            assert!(matches!(codec::decode_other(line), Some(Err(_))));
            return;
        }
    };
    let printed = match &decoded {
        HostMessage::Notification(notification) => {
            serde_json::to_vec(&RpcMessage::new(None, notification))
        }
        HostMessage::Reply(id, reply) => serde_json::to_vec(&RpcMessage::new(Some(*id), reply)),
    };
    let again = codec::decode(&printed.expect("JSON"));
    assert_eq!(shown(&again.expect("what was accepted before")), shown(&decoded));
    if let (HostMessage::Reply(..), Some(_)) = (&decoded, codec::decode_other(line)) {
        panic!("a reply of a forked process counts");
    }
}

fn shown(message: &HostMessage) -> String {
    match message {
        HostMessage::Notification(notification) => format!("{notification:?}"),
        HostMessage::Reply(id, Reply::Result(value)) => format!("{id} {value}"),
        HostMessage::Reply(id, Reply::Error(error)) => format!("{id} {error:?}"),
    }
}
