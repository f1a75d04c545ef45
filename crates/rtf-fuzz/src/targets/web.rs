//! Requests to the web server. The first byte of an input selects the server; then follow the
//! method, the address, the headers and the body, in the format of HTTP/1.1.

use std::net::SocketAddr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use axum::body::Body;
use axum::http::{Request, StatusCode, header};
use axum::response::Response;
use futures_util::StreamExt as _;
use rtf_history::{Store, StoreError};
use rtf_model::{LineSealer, SuiteId, TestId};
use rtf_report::console::TestCommands;
use rtf_web::{
    AnswerRequest, BoundServer, CampaignReport, CampaignSource, Capabilities, HistorySource,
    Limits, Routes, RunControl, Service, Settings, TestCondition,
};

/// Files below the results directory have this text; one next to it has the other one.
const SECRET: &str = "text-outside-of-the-results";

struct World {
    local: Routes,
    remote: Routes,
    runtime: tokio::runtime::Runtime,
    _dir: tempfile::TempDir,
}

thread_local! {
    static WORLD: World = World::new();
}

impl World {
    fn new() -> Self {
        let dir = tempfile::tempdir().expect("a directory");
        let results = dir.path().join("results");
        let run = results.join("own");
        std::fs::create_dir_all(run.join("attachments")).expect("a directory");
        let stream =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("../rtf-report/tests/streams/crash.jsonl");
        let stream = std::fs::read(stream).expect("a stream");
        let (mut sealer, mut journal) = (LineSealer::default(), Vec::new());
        for line in stream.split(|byte| *byte == b'\n').filter(|line| !line.is_empty()) {
            let start = journal.len();
            let line = String::from_utf8_lossy(line).replace("\"name\":\"", "\"name\":\"zebra-");
            journal.extend_from_slice(line.as_bytes());
            sealer.seal(&mut journal, start);
        }
        std::fs::write(run.join("events.jsonl"), journal).expect("a journal");
        std::fs::write(run.join("attachments/plot.html"), "<script>1</script>").expect("a file");
        std::fs::write(dir.path().join("secret.txt"), SECRET).expect("a file");
        let runtime = tokio::runtime::Builder::new_current_thread();
        let runtime = { runtime }.enable_all().max_blocking_threads(1).build().expect("a runtime");
        let routes = |is_remote| {
            let server = BoundServer::new(&settings(is_remote)).expect("a server");
            server.without_connections(service(&results)).expect("routes")
        };
        Self { local: routes(false), remote: routes(true), runtime, _dir: dir }
    }
}

fn settings(allow_remote: bool) -> Settings {
    Settings {
        address: "127.0.0.1:0".parse().expect("an address"),
        allow_remote,
        token_file: None,
        tls: None,
        hosts: Vec::new(),
        limits: Limits::default(),
    }
}

fn service(results: &Path) -> Service<'_> {
    Service {
        results,
        history: Arc::new(History(results.join("history.db"))),
        campaigns: Arc::new(NoCampaigns),
        metrics: true,
        role: Capabilities::Runner("own".to_owned(), Arc::new(Forbidden)),
        commands: || {
            let rerun = |_: &_, test, _: Option<&str>| Some(format!("rtf run s.xml::{test}"));
            TestCommands::without_replay(Box::new(rerun))
        },
        wrong_token: Box::new(|_| ()),
    }
}

/// A run that only a request with the token may control.
struct Forbidden;

impl RunControl for Forbidden {
    fn stop_run(&self) {
        panic!("the run was stopped without the token");
    }

    fn stop_test(&self, _: TestId) {
        panic!("a test was stopped without the token");
    }

    fn skip_suite(&self, _: SuiteId) {
        panic!("a suite was skipped without the token");
    }

    fn answer(&self, _: AnswerRequest) {
        panic!("a question was answered without the token");
    }
}

struct NoCampaigns;

impl CampaignSource for NoCampaigns {
    fn report(&self, _: &str) -> Result<Option<CampaignReport>, String> {
        Ok(None)
    }
}

struct History(PathBuf);

impl HistorySource for History {
    fn open(&self) -> Result<Store, StoreError> {
        Store::open_existing(&self.0)
    }

    fn parse_filter(&self, text: &str) -> Result<TestCondition, String> {
        let name = text.to_owned();
        Ok(Box::new(move |test| test.identity.test == name))
    }

    fn parse_since(&self, text: &str) -> Result<jiff::Timestamp, String> {
        text.parse().map_err(|error| format!("{error}"))
    }
}

/// A request.
pub fn check(data: &[u8]) {
    if let Some((first, rest)) = data.split_first() {
        WORLD.with(|world| check_request(world, *first, rest));
    }
}

fn check_request(world: &World, first: u8, rest: &[u8]) {
    let routes = if first & 1 == 0 { &world.local } else { &world.remote };
    let Some(request) = request(rest, routes) else { return };
    let (method, path) = (request.method().clone(), request.uri().path().to_owned());
    let client = SocketAddr::from(([127, 0, 0, 1], 40_000));
    let (response, body) = world.runtime.block_on(async {
        let response = routes.answer(client, request).await;
        read(response).await
    });
    let status = response.status();
    assert!(
        !status.is_server_error() || status == StatusCode::SERVICE_UNAVAILABLE,
        "{method} {path}: {status}"
    );
    for name in ["content-security-policy", "x-content-type-options"] {
        assert!(response.headers().contains_key(name), "{method} {path}: no `{name}`");
    }
    let body = String::from_utf8_lossy(&body);
    assert!(!body.contains(SECRET) && !body.contains(&routes.token), "{method} {path}: {body}");
    let is_data = body.contains("zebra-") || body.contains("<script>1</script>");
    assert!(first & 1 == 0 || !is_data, "{method} {path}: read without the token");
}

/// The first bytes of a response. An event stream has no end.
async fn read(response: Response) -> (Response, Vec<u8>) {
    let (head, body) = response.into_parts();
    let kind = head.headers.get(header::CONTENT_TYPE).and_then(|kind| kind.to_str().ok());
    let mut bytes = Vec::new();
    if !kind.is_some_and(|kind| kind.starts_with("text/event-stream")) {
        let mut stream = body.into_data_stream();
        while let Some(Ok(piece)) = stream.next().await {
            bytes.extend_from_slice(&piece);
        }
    }
    (Response::from_parts(head, Body::empty()), bytes)
}

/// The request that the bytes describe. `HOST` in them is the server's address.
fn request(bytes: &[u8], routes: &Routes) -> Option<Request<Body>> {
    let end = bytes.windows(2).position(|pair| pair == b"\n\n").unwrap_or(bytes.len());
    let head = std::str::from_utf8(&bytes[..end]).ok()?;
    let head = head.replace("HOST", &routes.address.to_string());
    let mut lines = head.lines();
    let (method, target) = lines.next()?.split_once(' ')?;
    let mut request = Request::builder().method(method).uri(target);
    for line in lines {
        let (name, value) = line.split_once(':')?;
        // Wrong tokens make the next request of the client wait.
        if name.trim().eq_ignore_ascii_case("authorization") {
            return None;
        }
        request = request.header(name.trim(), value.trim());
    }
    let body = bytes.get(end + 2..).unwrap_or_default().to_vec();
    // A wrong token in a body makes the client wait, too.
    if target.contains("session") && method == "POST" {
        return None;
    }
    request.body(Body::from(body)).ok()
}
