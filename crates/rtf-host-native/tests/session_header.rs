//! `rtf/session.hpp` in a real program, with the host's end of `RTF_SESSION` in this test.
#![expect(clippy::unwrap_used, clippy::expect_used, reason = "a test stops at the first surprise")]

use std::os::fd::AsRawFd;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use rustix::io::FdFlags;
use rustix::net::{
    AddressFamily, RecvFlags, SendFlags, SocketFlags, SocketType, recv, send, socketpair,
};
use serde_json::{Value, json};

/// The program, built once with the oldest standard that the header supports.
fn program() -> &'static Path {
    static PROGRAM: OnceLock<PathBuf> = OnceLock::new();
    PROGRAM.get_or_init(|| {
        let root = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."));
        let program = Path::new(env!("CARGO_TARGET_TMPDIR")).join("session_header");
        let status = Command::new("c++")
            .args(["-std=c++11", "-pthread", "-Wall", "-Wextra", "-Wpedantic", "-Wshadow"])
            .args(["-Wconversion", "-Werror", "-fno-exceptions"])
            .arg(format!("-I{}/sdk/cpp/include", root.display()))
            .arg(root.join("sdk/cpp/tests/session.cpp"))
            .arg("-o")
            .arg(&program)
            .status()
            .expect("the tests of the C++ SDK need `c++`");
        assert!(status.success(), "session.cpp does not compile");
        program
    })
}

/// The packets that the program sent, and its output.
struct Ran {
    packets: Vec<Value>,
    stdout: String,
    stderr: String,
}

impl Ran {
    fn new(packets: Vec<Value>, output: Output) -> Self {
        assert!(output.status.success(), "{output:?}");
        let text = |bytes| String::from_utf8(bytes).unwrap();
        Self { packets, stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    /// The parameters of the packets with a method, without their locations.
    fn params(&self, method: &str) -> Vec<Value> {
        let wanted = self.packets.iter().filter(|packet| packet["method"] == method);
        let mut params: Vec<Value> = wanted.map(|packet| packet["params"].clone()).collect();
        for fields in &mut params {
            fields.as_object_mut().unwrap().remove("location");
        }
        params
    }
}

/// Runs a mode of the program, and answers its packets.
fn run(mode: &str, answer: impl Fn(&Value) -> Option<String>) -> Ran {
    let (ours, theirs) =
        socketpair(AddressFamily::UNIX, SocketType::SEQPACKET, SocketFlags::CLOEXEC, None).unwrap();
    let mut command = Command::new(program());
    command.arg(mode).stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.env("RTF_SESSION", format!("fd:{}", theirs.as_raw_fd()));
    // The programs of the other tests, which start at the same time, do not read this one.
    rustix::io::fcntl_setfd(&theirs, FdFlags::empty()).unwrap();
    let child = command.spawn().unwrap();
    drop(theirs);
    let mut packets = Vec::new();
    let mut buffer = vec![0; 1 << 20];
    loop {
        let (_, length) = recv(&ours, &mut buffer[..], RecvFlags::empty()).unwrap();
        if length == 0 {
            break;
        }
        assert!(length <= 64 * 1024, "{length} bytes");
        let packet: Value = serde_json::from_slice(&buffer[..length]).unwrap();
        let Some(answer) = answer(&packet) else {
            drop(ours);
            packets.push(packet);
            break;
        };
        let is_answered = packet["answer"] != false;
        packets.push(packet);
        if !is_answered {
            continue;
        }
        send(&ours, answer.as_bytes(), SendFlags::NOSIGNAL).unwrap();
    }
    Ran::new(packets, child.wait_with_output().unwrap())
}

fn accept(_packet: &Value) -> Option<String> {
    Some("0".to_owned())
}

#[test]
fn measurements_arrive_with_limits_and_the_result_says_whether_they_hold() {
    let ran = run("measure", accept);
    let expected = [
        json!({"name": "free", "unit": "", "value": 1.5}),
        json!({"name": "rate", "unit": "Hz", "low": 0, "high": 0.1, "value": 0.1}),
        json!({"name": "rate", "unit": "Hz", "low": 0, "value": -1e-300}),
        json!({"name": "rate", "unit": "Hz", "high": 1, "value": 2}),
        json!({"name": "rate", "unit": "", "value": null}),
        json!({"name": "rate", "unit": "", "value": null}),
    ];
    assert_eq!(ran.params("measured"), expected);
    let limit = json!({"kind": "error", "text": "a limit of `rate` is not a number"});
    let long = format!("the report of `{}` is longer than 64 KiB", "x".repeat(100));
    let long = json!({"kind": "error", "text": long});
    assert_eq!(ran.params("message"), [limit.clone(), limit, long]);
    let results = "rtf: true\nfree: true\nwithin: true\nbelow: false\nabove: false\nnan: false\n\
                   infinite: false\nlimit: false\ninfinite limit: false\nlong: false\n";
    assert_eq!(ran.stdout, results);
    let location = &ran.packets[0]["params"]["location"];
    assert!(location["file"].as_str().unwrap().ends_with("sdk/cpp/tests/session.cpp"));
    let source = include_str!("../../../sdk/cpp/tests/session.cpp");
    let line = source.lines().position(|line| line.contains("\"free\"")).unwrap() + 1;
    assert_eq!(location["line"], line);
}

#[test]
fn without_a_runner_only_limits_are_checked() {
    for variable in [None, Some(""), Some("fd:"), Some("fd:x"), Some("9")] {
        let mut command = Command::new(program());
        command.arg("measure").env_remove("RTF_SESSION");
        if let Some(variable) = variable {
            command.env("RTF_SESSION", variable);
        }
        let ran = Ran::new(Vec::new(), command.output().unwrap());
        assert!(ran.stdout.starts_with("rtf: false\nfree: true\nwithin: true\nbelow: false\n"));
        assert_eq!(ran.stderr, "");
    }
}

#[test]
fn a_descriptor_that_is_not_the_session_is_reported_once() {
    let mut command = Command::new(program());
    command.arg("measure").env("RTF_SESSION", "fd:0").stdin(Stdio::null());
    let ran = Ran::new(Vec::new(), command.output().unwrap());
    let expected = "rtf: the descriptor in RTF_SESSION is not open here: results of this process \
                    are not reported\n";
    assert_eq!(ran.stderr, expected);
    assert!(ran.stdout.starts_with("rtf: false\n"), "{}", ran.stdout);
}

#[test]
fn samples_arrive_with_their_times() {
    let ran = run("sample", accept);
    let samples = ran.params("sampled");
    let time = samples[0]["points"][0][0].as_f64().unwrap();
    assert!((0.0..600.0).contains(&time), "{time}");
    assert_eq!(samples[0]["points"][0][1], 1.0);
    assert_eq!(samples[1]["points"], json!([[0, 1], [0.5, 3]]));
    assert_eq!(samples[1]["high"], 2);
    let many: Vec<usize> =
        samples[2..].iter().map(|part| part["points"].as_array().unwrap().len()).collect();
    assert_eq!(many, [512, 488]);
    assert_eq!(samples[3]["points"][487], json!([-1.5e-200, 0.1]));
    assert_eq!(ran.stdout, "rtf: true\nnow: true\npoints: false\nno points: true\nmany: true\n");
}

#[test]
fn any_text_becomes_valid_json() {
    let ran = run("texts", accept);
    let messages = ran.params("message");
    let texts: Vec<&str> = messages.iter().map(|it| it["text"].as_str().unwrap()).collect();
    assert_eq!(texts[0], "zero \0 \u{1f} \"quoted\" back\\slash\n");
    assert_eq!(
        texts[1],
        "é € 😀 \u{fffd}\u{fffd}|\u{fffd}\u{fffd}\u{fffd}|\u{fffd}|\u{fffd}\u{fffd}"
    );
    assert_eq!(texts[2], "");
    assert_eq!(texts[3..].concat(), "\u{1}".repeat(100_000));
    assert!(texts.len() > 4);
    assert!(messages.iter().all(|it| it["kind"] == "report"));
}

#[test]
fn a_file_is_attached_by_its_absolute_path() {
    let ran = run("attach", accept);
    let path = program().canonicalize().unwrap();
    let attached = [
        json!({"name": "the program", "path": path, "media_type": "application/x-elf"}),
        json!({"name": "session_header", "path": path, "media_type": ""}),
    ];
    assert_eq!(ran.params("attached"), attached);
    let missing = "there is no file `/nowhere/trace.csv` to attach";
    assert_eq!(ran.params("message"), [json!({"kind": "error", "text": missing})]);
    assert_eq!(ran.stdout, "rtf: true\nattached: true\nown name: true\nmissing: false\n");
}

#[test]
fn a_refused_report_is_false() {
    let refuse_attachments =
        |packet: &Value| Some(if packet["method"] == "attached" { "1" } else { "0" }.to_owned());
    let ran = run("attach", refuse_attachments);
    assert!(ran.stdout.contains("attached: false\n"), "{}", ran.stdout);
    assert_eq!(ran.params("message").len(), 1, "{:?}", ran.packets);
}

#[test]
fn values_of_fixtures_are_read_as_text() {
    let values = json!([
        {"name": "arm.port", "value": 40123},
        {"name": "arm.name", "value": "left \"é\" 😀 \u{8}\u{c}\n\r\t\u{1} \\/"},
        {"value": [1, {"a]": "}", "b": "\""}, null], "name": "arm.list"},
    ]);
    let answer = |packet: &Value| {
        let is_query = packet["method"] == "fixture-values" && packet["params"] == json!({});
        // Escaped as ASCII, as some writers of JSON do.
        let text = values.to_string().replace('é', "\\u00e9").replace('😀', "\\ud83d\\ude00");
        Some(if is_query { text } else { "0".to_owned() })
    };
    let ran = run("values", answer);
    let expected = "rtf: true\narm.port: 40123\n\
                    arm.name: left \"é\" 😀 \u{8}\u{c}\n\r\t\u{1} \\/\n\
                    arm.list: [1,{\"a]\":\"}\",\"b\":\"\\\"\"},null]\narm.none: otherwise\n";
    assert_eq!(ran.stdout, expected);
    let text = "there is no fixture value \"arm.none\"; there are arm.port, arm.name, arm.list";
    assert_eq!(ran.params("message"), [json!({"kind": "error", "text": text})]);
    let none = run("values", |_| Some("[]".to_owned()));
    assert!(none.stdout.contains("arm.port: otherwise\n"));
    assert_eq!(
        none.params("message")[0]["text"],
        "there is no fixture value \"arm.port\"; there are none"
    );
}

#[test]
fn threads_wait_for_their_own_answers() {
    let ran = run("threads", accept);
    for thread in 0..8 {
        let name = format!("thread {thread}");
        let values = ran.params("measured");
        let values = values.iter().filter(|it| it["name"] == name);
        let values: Vec<f64> = values.map(|it| it["value"].as_f64().unwrap()).collect();
        assert_eq!(values, (0..100).map(f64::from).collect::<Vec<_>>());
    }
}

#[test]
fn a_forked_process_does_not_wait_for_answers() {
    let ran = run("forks", accept);
    assert_eq!(ran.stdout, "rtf: true\nin the child: false\nchild: true\nparent: true\n");
    let measured = [
        json!({"name": "in a child", "unit": "", "low": 2, "value": 1}),
        json!({"name": "in the parent", "unit": "", "value": 1}),
    ];
    assert_eq!(ran.params("measured"), measured);
    let text = "a forked process cannot read values of fixtures";
    assert_eq!(ran.params("message"), [json!({"kind": "error", "text": text})]);
    let answers: Vec<bool> = ran.packets.iter().map(|it| it["answer"] != false).collect();
    assert_eq!(answers, [false, false, true]);
}

#[test]
fn a_program_that_the_program_starts_does_not_report() {
    let ran = run("executes", accept);
    assert_eq!(ran.params("measured"), [json!({"name": "in the parent", "unit": "", "value": 1})]);
    assert!(ran.stdout.contains("rtf: false\nfree: true\n"), "{}", ran.stdout);
    assert_eq!(ran.stderr, "", "what it writes is what it writes without rtf");
}

#[test]
fn a_program_continues_when_its_host_has_ended() {
    let ran = run("measure", |_| None);
    assert_eq!(ran.packets.len(), 1);
    assert!(ran.stdout.contains("free: false\nwithin: true\nbelow: false\n"), "{}", ran.stdout);
}
