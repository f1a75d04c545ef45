//! Plays the runner: starts the real host over a socket pair.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::Shutdown;
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::path::PathBuf;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::Mutex;
use std::time::Duration;

use rustix::io::{FdFlags, fcntl_setfd};
use serde_json::{Value, json};
use tempfile::TempDir;

/// Far beyond what any test takes: a host that hangs fails its test.
const LIMIT: Duration = Duration::from_secs(60);

/// While one host is started, its channel must not slip into another one.
static STARTING: Mutex<()> = Mutex::new(());

/// A host process, the runner's end of its channel, and its plug-in's directory.
pub(crate) struct Host {
    pub(crate) dir: TempDir,
    pub(crate) seen: Vec<Value>,
    channel: UnixStream,
    lines: BufReader<UnixStream>,
    process: Child,
}

impl Host {
    pub(crate) fn start() -> Self {
        let dir = TempDir::new().unwrap();
        let (ours, theirs) = UnixStream::pair().unwrap();
        ours.set_read_timeout(Some(LIMIT)).unwrap();
        let guard = STARTING.lock().unwrap();
        fcntl_setfd(&theirs, FdFlags::empty()).unwrap();
        let process = Command::new(env!("CARGO_BIN_EXE_rtf-host-lua"))
            .env("RTF_CHANNEL", format!("fd:{}", theirs.as_raw_fd()))
            .current_dir(dir.path())
            .stdin(Stdio::null())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        drop(theirs);
        drop(guard);
        let lines = BufReader::new(ours.try_clone().unwrap());
        let mut host = Self { dir, seen: Vec::new(), channel: ours, lines, process };
        host.send(Some(0), "initialize", json!({"protocol": 1, "rtf": "0.1.0"}));
        host.answer();
        host
    }

    pub(crate) fn send(&mut self, id: Option<u64>, method: &str, params: Value) {
        let mut message = json!({"jsonrpc": "2.0", "method": method, "params": params});
        if let Some(id) = id {
            message["id"] = id.into();
        }
        self.channel.write_all(format!("{message}\n").as_bytes()).unwrap();
    }

    /// Writes the plug-in and asks for a test or a fixture of it.
    pub(crate) fn start_plugin(&mut self, method: &str, source: &str) -> PathBuf {
        let file = self.dir.path().join("plugin.lua");
        std::fs::write(&file, source).unwrap();
        let params = json!({
            "file": file, "name": "Arm", "param": "--rate 100", "args": ["--rate", "100"],
            "environment": "--robot sim", "repetition": 3, "is_last": method == "run-test",
            "parameters": [{"name": "joint", "value": "3"}, {"name": "side", "value": "left"}],
            "fixture_values": [
                {"name": "simulator.port", "value": 40123}, {"name": "simulator.rate", "value": 40.0},
                {"name": "simulator.model", "value": "Bär"}, {"name": "simulator.ready", "value": false},
                {"name": "simulator.limits", "value": [-1.5, {"max": 2}, null, []]},
            ],
        });
        self.send(Some(1), method, params);
        file
    }

    /// The next line, `None` at the end of the channel.
    fn read(&mut self) -> Option<Value> {
        let mut line = String::new();
        if self.lines.read_line(&mut line).unwrap() == 0 {
            return None;
        }
        let message: Value = serde_json::from_str(&line).unwrap();
        self.seen.push(message.clone());
        Some(message)
    }

    /// The next answer's result.
    pub(crate) fn answer(&mut self) -> Value {
        loop {
            let message = self.read().expect("the host ended without an answer");
            if message.get("id").is_some() {
                return message["result"].clone();
            }
        }
    }

    /// The parameters of the next notification of this kind.
    pub(crate) fn wait_for(&mut self, method: &str) -> Value {
        loop {
            let message = self.read().expect("the host ended without the notification");
            if message["method"] == method {
                return message["params"].clone();
            }
        }
    }

    pub(crate) fn ask(&mut self, method: &str) -> Value {
        self.ask_with(method, json!({}))
    }

    /// The same, with parameters.
    pub(crate) fn ask_with(&mut self, method: &str, params: Value) -> Value {
        self.send(Some(2), method, params);
        self.answer()
    }

    /// The parameters of all notifications of a kind so far.
    pub(crate) fn all(&self, method: &str) -> Vec<&Value> {
        let of_kind = self.seen.iter().filter(|message| message["method"] == method);
        of_kind.map(|message| &message["params"]).collect()
    }

    /// `kind: text` of all messages so far.
    pub(crate) fn texts(&self) -> Vec<String> {
        let text = |m: &&Value| {
            format!("{}: {}", m["kind"].as_str().unwrap(), m["text"].as_str().unwrap())
        };
        self.all("message").iter().map(text).collect()
    }

    /// The first line of the first failure or error so far.
    pub(crate) fn problem(&self) -> Option<String> {
        let texts = self.texts();
        let problem = |text: &str| {
            text.strip_prefix("failure: ").or(text.strip_prefix("error: ")).map(str::to_owned)
        };
        let first = texts.iter().find_map(|text| problem(text))?;
        first.lines().next().map(str::to_owned)
    }

    /// Closes the channel, like a runner that is gone.
    pub(crate) fn hang_up(&self) {
        self.channel.shutdown(Shutdown::Write).unwrap();
    }

    /// Waits for the end of the process. Returns its status and its output.
    pub(crate) fn end(&mut self) -> (ExitStatus, String) {
        while self.read().is_some() {}
        let mut printed = String::new();
        self.process.stdout.take().unwrap().read_to_string(&mut printed).unwrap();
        (self.process.wait().unwrap(), printed)
    }
}

impl Drop for Host {
    fn drop(&mut self) {
        // Ends the process of a failed test.
        drop(self.process.kill());
        drop(self.process.wait());
    }
}

/// Runs a test to its end: its answer, and the host that has ended.
pub(crate) fn run(source: &str) -> (Value, Host) {
    let mut host = Host::start();
    host.start_plugin("run-test", source);
    let answer = host.answer();
    let (status, _) = host.end();
    assert!(status.success(), "the host ended with {status}");
    (answer, host)
}

/// Runs a test whose `run` has this body.
pub(crate) fn run_body(body: &str) -> (Value, Host) {
    run(&format!("function TestCase.run()\n{body}\nend\n"))
}
