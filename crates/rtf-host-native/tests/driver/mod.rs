//! Builds plug-ins with the system's compilers and runs them in the real host,
//! over a socket pair, as the runner does.

use std::io::{BufRead, BufReader, Write};
use std::os::fd::AsRawFd;
use std::os::unix::net::UnixStream;
use std::os::unix::process::CommandExt;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

use rustix::io::FdFlags;
use serde_json::{Value, json};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
const HOST: &str = env!("CARGO_BIN_EXE_rtf-host-native");

/// The project's root.
pub fn root() -> &'static Path {
    Path::new(ROOT)
}

/// The directory for what this test program builds.
pub fn dir() -> PathBuf {
    let dir = Path::new(env!("CARGO_TARGET_TMPDIR")).join("plugins");
    std::fs::create_dir_all(&dir).unwrap();
    dir
}

/// Compiles a source of the project. The warnings of the SDK's headers are errors.
pub fn build(source: &str) -> PathBuf {
    build_at(&Path::new(ROOT).join(source), &[])
}

/// Compiles a source text.
pub fn build_text(name: &str, text: &str, options: &[&str]) -> PathBuf {
    let source = dir().join(name);
    std::fs::write(&source, text).unwrap();
    build_at(&source, options)
}

fn build_at(source: &Path, options: &[&str]) -> PathBuf {
    let (compiler, standard) = match source.extension().and_then(|end| end.to_str()) {
        Some("c") => ("cc", "-std=c99"),
        _ => ("c++", "-std=c++17"),
    };
    let library = dir().join(source.file_name().unwrap()).with_extension("so");
    // Each one once: another test may be running it.
    static BUILT: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());
    let mut built = BUILT.lock().unwrap_or_else(PoisonError::into_inner);
    if built.contains(&library) {
        return library;
    }
    let status = Command::new(compiler)
        .args([standard, "-shared", "-fPIC", "-pthread"])
        .args(["-Wall", "-Wextra", "-Wpedantic", "-Werror"])
        .arg(format!("-I{ROOT}/sdk/cpp/include"))
        .arg(format!("-I{ROOT}/sdk/c/include"))
        .arg(source)
        .args(options)
        .arg("-o")
        .arg(&library)
        .status()
        .expect("the tests of the native SDK need `cc` and `c++`");
    assert!(status.success(), "{} does not compile", source.display());
    built.push(library.clone());
    library
}

/// A host that was initialised.
pub struct Host {
    pub process: Child,
    channel: UnixStream,
    lines: std::io::Lines<BufReader<UnixStream>>,
}

/// What a host said and how it ended.
#[derive(Debug)]
pub struct Ran {
    /// Everything but answers: method and parameters.
    pub notifications: Vec<(String, Value)>,
    /// The result of the last answer, null when the host died before it.
    pub result: Value,
    /// How the process ended.
    pub status: ExitStatus,
}

impl Ran {
    /// The first failure or error.
    pub fn problem(&self) -> String {
        let texts = self.texts();
        let problem = |text: &String| {
            text.strip_prefix("failure: ").or(text.strip_prefix("error: ")).map(str::to_owned)
        };
        texts.iter().find_map(problem).unwrap_or_default()
    }

    /// The texts of all messages, each with its kind.
    pub fn texts(&self) -> Vec<String> {
        let messages = self.notifications.iter().filter(|(method, _)| method == "message");
        let text = |part: &Value| part.as_str().unwrap().to_owned();
        messages.map(|(_, m)| format!("{}: {}", text(&m["kind"]), text(&m["text"]))).collect()
    }
}

impl Host {
    pub fn start() -> Self {
        let (ours, theirs) = UnixStream::pair().unwrap();
        let fd = theirs.as_raw_fd();
        let mut command = Command::new(HOST);
        command.env("RTF_CHANNEL", format!("fd:{fd}")).stdin(Stdio::null());
        let keep = move || Ok(rustix::io::fcntl_setfd(&theirs, FdFlags::empty())?);
        // SAFETY: the one call between fork and exec is a system call.
        let process = unsafe { command.pre_exec(keep) }.spawn().unwrap();
        drop(command);
        // A host that says nothing fails the test, and does not hold it.
        ours.set_read_timeout(Some(Duration::from_secs(120))).unwrap();
        let lines = BufReader::new(ours.try_clone().unwrap()).lines();
        let mut host = Self { process, channel: ours, lines };
        host.send(json!({"id": 0, "method": "initialize", "params": {"protocol": 1, "rtf": "t"}}));
        let answer = host.next().unwrap();
        assert_eq!(answer["result"]["stack"], "none", "{answer}");
        host
    }

    pub fn send(&mut self, message: Value) {
        self.send_all(&[message]);
    }

    /// Sends messages in one write: the host may end after the first one.
    pub fn send_all(&mut self, messages: &[Value]) {
        let lines: String = messages.iter().map(|message| format!("{message}\n")).collect();
        self.channel.write_all(lines.as_bytes()).unwrap();
    }

    /// The next message, `None` at the end of the channel.
    pub fn next(&mut self) -> Option<Value> {
        let line = self.lines.next()?.ok()?;
        Some(serde_json::from_str(&line).unwrap())
    }

    /// Reads until a message has this text.
    pub fn wait_for(&mut self, text: &str) {
        while self.next().unwrap()["params"]["text"] != text {}
    }

    /// Sends a request about a plug-in and returns the answer's result.
    pub fn ask(&mut self, method: &str, params: Value) -> Value {
        self.send(json!({"id": 1, "method": method, "params": params}));
        loop {
            let message = self.next().unwrap();
            if message["id"] == 1 {
                return message["result"].clone();
            }
        }
    }

    /// Closes the channel, as a runner that was killed does.
    pub fn abandon(mut self) -> ExitStatus {
        drop((self.channel, self.lines));
        self.process.wait().unwrap()
    }

    /// Takes everything that comes until the host has ended.
    pub fn finish(mut self) -> Ran {
        let (mut notifications, mut result) = (Vec::new(), Value::Null);
        while let Some(mut message) = self.next() {
            match message["method"].as_str().map(str::to_owned) {
                Some(method) => notifications.push((method, message["params"].take())),
                None => result = message["result"].take(),
            }
        }
        Ran { notifications, result, status: self.process.wait().unwrap() }
    }
}

/// Starts a host with one test, which is named `arm test` unless `params` has another name.
pub fn start_test(library: &Path, mut params: Value) -> Host {
    let mut host = Host::start();
    params["file"] = json!(library);
    if params["name"].is_null() {
        params["name"] = json!("arm test");
    }
    params["is_last"] = json!(true);
    host.send(json!({"id": 1, "method": "run-test", "params": params}));
    host
}

/// Runs one test to its end.
pub fn run_test(library: &Path, params: Value) -> Ran {
    start_test(library, params).finish()
}

/// What `--check` says of files: one value a line, after the program ended well.
pub fn check(files: &[&Path]) -> Vec<Value> {
    let output = Command::new(HOST).arg("--check").args(files).output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let text = String::from_utf8(output.stdout).unwrap();
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// The name of a file that was built.
pub fn display(path: &Path) -> String {
    path.to_string_lossy().into_owned()
}
