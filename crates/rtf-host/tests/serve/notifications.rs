//! Samples, values, attachments and texts, as the host sends them.

use std::io::{BufRead, BufReader};
use std::os::unix::net::UnixStream;

use rtf_host::Session;
use rtf_model::{Message, MessageKind};

use crate::script_host::Runner;

#[test]
fn samples_come_in_batches_and_before_later_messages() {
    let (mut runner, _host) = Runner::start();
    let many = vec!["sample:1@0.5"; 600].join(",");
    runner.ask("run-test", &format!("report:;sample:NaN@0,{many},report:r,sample:2@9;report:"));
    let (mut notifications, mut sampled, mut batches) = (Vec::new(), 0, 0);
    loop {
        let line = runner.line();
        if line.contains("\"id\"") {
            break;
        }
        let line: serde_json::Value = serde_json::from_str(&line).unwrap();
        if let Some(points) = line["params"]["points"].as_array() {
            assert!(points.len() <= 256, "{line}");
            (sampled, batches) = (sampled + points.len(), batches + 1);
        } else {
            notifications.push(format!("{sampled} {}", line["method"].as_str().unwrap()));
        }
    }
    let expected = ["0 phase", "0 message", "0 phase", "601 message", "602 phase", "602 message"];
    assert_eq!(notifications, expected);
    assert!((4..300).contains(&batches), "{batches} batches");
}

#[test]
fn samples_are_sent_before_a_long_wait() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "sample:1@0.5,sleep;report:;report:");
    let sampled = (0..2).map(|_| runner.line()).last().unwrap();
    let expected = r#""params":{"name":"rate","unit":"Hz","high":2.0,"location":{"file":"script","line":7},"points":[[0.5,1.0]]}"#;
    assert!(sampled.contains(expected), "{sampled}");
    runner.send(r#"{"jsonrpc":"2.0","method":"interrupt","params":{"reason":"enough"}}"#);
    assert!(runner.result().contains("enough"));
}

#[test]
fn a_forked_child_sends_only_its_own_samples_and_provides_no_values() {
    let (mut runner, _host) = Runner::start();
    runner.ask("run-test", "report:;sample:1@3,fork;report:");
    let mut times = Vec::new();
    loop {
        let line: serde_json::Value = serde_json::from_str(&runner.line()).unwrap();
        let points = line["params"]["points"].as_array().cloned().unwrap_or_default();
        times.extend(points.iter().map(|point| point[0].as_f64().unwrap()));
        assert_ne!(line["method"], "provided", "{line}");
        if !line["id"].is_null() {
            break;
        }
    }
    times.sort_by(f64::total_cmp);
    assert_eq!(times, [3.0, 7.0]);
}

/// The runner checks names and values: the host sends any.
#[test]
fn a_value_is_sent_at_once_and_unchecked() {
    let (mut runner, _host) = Runner::start();
    runner.ask("set-up-fixture", "provide:port=40123,report:up,provide:=[null];report:;report:");
    let mut lines = Vec::new();
    loop {
        let mut line: serde_json::Value = serde_json::from_str(&runner.line()).unwrap();
        if !line["id"].is_null() {
            break;
        }
        lines.push((line["method"].take(), line["params"].take()));
    }
    let port = serde_json::json!({"name": "port", "value": 40123});
    let nameless = serde_json::json!({"name": "", "value": [null]});
    assert_eq!((&lines[0].0, &lines[0].1), (&"provided".into(), &port));
    assert_eq!(lines[1].1["text"], "up");
    assert_eq!((&lines[2].0, &lines[2].1), (&"provided".into(), &nameless));
    assert_eq!(lines.len(), 3);
    runner.ask("tear-down-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
}

#[test]
fn a_value_that_is_too_long_for_a_line_is_an_error() {
    let (mut runner, _host) = Runner::start();
    runner.ask("set-up-fixture", "provide:image=huge;report:;report:");
    let line: serde_json::Value = serde_json::from_str(&runner.line()).unwrap();
    let error = "a value and its name are longer than a line of the protocol";
    assert_eq!(line["params"]["text"], error);
    assert_eq!(runner.result(), r#""outcome":"error""#);
    runner.ask("tear-down-fixture", "");
    assert_eq!(runner.result(), r#""outcome":"passed""#);
}

#[test]
fn an_attachment_without_an_extension_gets_that_of_its_file() {
    let dir = std::env::temp_dir().join(format!("rtf-host-attach-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let (file, attachments) = (dir.join("plot.png"), dir.join("kept"));
    std::fs::write(&file, "x").unwrap();
    let (mut runner, _host) = Runner::start();
    let script = format!("report:;attach:arm 3@{0},attach:run.txt@{0};report:", file.display());
    let params = serde_json::json!({"file": script, "name": "T", "attachments_dir": attachments});
    runner.send(&serde_json::json!({"id": 1, "method": "run-test", "params": params}).to_string());
    let mut attached = Vec::new();
    while attached.len() < 2 {
        let line: serde_json::Value = serde_json::from_str(&runner.line()).unwrap();
        attached.extend((line["method"] == "attached").then(|| line["params"].clone()));
    }
    runner.result();
    let paths = ["1-arm_3.png", "2-run.txt"].map(|name| serde_json::json!(attachments.join(name)));
    assert_eq!([&attached[0]["path"], &attached[1]["path"]], [&paths[0], &paths[1]]);
    assert_eq!(attached[0]["name"], "arm 3");
    std::fs::remove_dir_all(&dir).unwrap();
}

#[test]
fn a_text_longer_than_a_line_arrives_in_several_messages() {
    let (ours, theirs) = UnixStream::pair().unwrap();
    let session = Session::over(theirs);
    let text = "é".repeat(9 * 1024 * 1024);
    let sent = text.clone();
    let thread = std::thread::spawn(move || {
        let kind = MessageKind::Report;
        let (location, comparison) = (None, None);
        session.message(Message {
            kind,
            text: sent,
            location,
            comparison,
            critical: false,
            case: None,
            interval: None,
        });
    });
    let mut arrived = String::new();
    for line in BufReader::new(ours).lines() {
        let line = line.unwrap();
        assert!(line.len() < 16 * 1024 * 1024);
        let value: serde_json::Value = serde_json::from_str(&line).unwrap();
        arrived.push_str(value["params"]["text"].as_str().unwrap());
        if arrived.len() >= text.len() {
            break;
        }
    }
    thread.join().unwrap();
    assert!(arrived == text);
}
