//! 16 000 lines of the host protocol: requests written, messages read.

use std::error::Error;

use rtf_model::protocol::{Answer, Notification, Plugin, Reply, Request, RpcMessage};
use rtf_model::{Location, Message, MessageKind, Outcome, Phase};
use rtf_process::codec::{self, HostMessage};

const TESTS: u64 = 4000;

/// Does it.
pub fn run() -> Result<(), Box<dyn Error>> {
    let mut understood = 0;
    for number in 0..TESTS {
        let request = Request::RunTest(Plugin {
            file: "/robot/plugins/libEncoderTest.so".into(),
            name: format!("test-{number:05}"),
            args: vec!["--rate".into(), "100".into()],
            param: "--rate 100".into(),
            repetition: 1,
            is_last: true,
            ..Plugin::default()
        });
        if codec::encode(Some(number), request)?.ends_with(b"}\n") {
            understood += 1;
        }
        let message = Message {
            kind: MessageKind::Check,
            text: format!("joint {number} moves"),
            location: Some(Location { file: "EncoderTest.cpp".into(), line: 42 }),
            comparison: None,
            critical: false,
            case: None,
            interval: None,
        };
        let answer = Answer {
            outcome: Outcome::Passed,
            reason: None,
            subscriptions: Vec::new(),
            continues: false,
        };
        let lines = [
            line(None, Notification::Phase { phase: Phase::Run })?,
            line(None, Notification::Message(message))?,
            line(Some(number), Reply::Result(answer))?,
        ];
        for line in &lines {
            match codec::decode(line)? {
                HostMessage::Notification(_) => understood += 1,
                HostMessage::Reply(id, _) if id == number => understood += 1,
                HostMessage::Reply(..) => {}
            }
        }
    }
    if understood == 4 * TESTS { Ok(()) } else { Err("a line was not understood".into()) }
}

fn line<T: serde::Serialize>(id: Option<u64>, body: T) -> serde_json::Result<Vec<u8>> {
    serde_json::to_vec(&RpcMessage::new(id, body))
}
